//! The picture, and what hands do with it.

use super::{legend, path, style};
use crate::view::Rectangle;
use crate::viewer::Viewer;
use eframe::egui::{
    self, Align2, Color32, CursorIcon, FontId, PointerButton, Pos2, Rect, Response, Sense, Stroke,
    StrokeKind, TextureHandle, Ui, pos2, vec2,
};
use std::time::Instant;

/// What a drag that has begun is about.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Drag {
    /// The camera.
    #[default]
    Camera,
    /// The line between two pictures.
    Divider,
}

/// Points on each side of the line between two pictures where it is caught.
const REACH: f32 = 6.0;
/// Radians that the camera turns for a point of a drag.
const TURN: f64 = 0.008;
/// How much nearer the camera comes for a point of the wheel.
const NEARER: f64 = 0.004;

/// Draws the picture into all of `ui`, and takes what hands do with it.
pub fn show(
    ui: &mut Ui,
    viewer: &mut Viewer,
    textures: &[Option<TextureHandle>; 2],
    drag: &mut Drag,
    now: Instant,
) {
    let rect = ui.available_rect_before_wrap();
    let response = ui.allocate_rect(rect, Sense::click_and_drag());
    let Some(size) = viewer.facts().map(|facts| [facts.size.width, facts.size.height]) else {
        let text = "loading the scene \u{2026}";
        let font = FontId::proportional(16.0);
        ui.painter().text(rect.center(), Align2::CENTER_CENTER, text, font, Color32::GRAY);
        return;
    };
    let room: Rectangle = [rect.left(), rect.top(), rect.right(), rect.bottom()];
    hands(ui, &response, viewer, Place { room, size }, drag, now);
    draw(ui, viewer, textures, Place { room, size });
    legend::show(ui, viewer, rect);
}

/// The room that there is, and the size of the picture.
#[derive(Clone, Copy)]
struct Place {
    room: Rectangle,
    size: [u32; 2],
}

impl Place {
    fn rect(self, viewer: &Viewer) -> Rect {
        let [left, top, right, bottom] = viewer.view.rectangle(self.room, self.size);
        Rect::from_min_max(pos2(left, top), pos2(right, bottom))
    }

    /// Where the line between two pictures is.
    fn divider(self, viewer: &Viewer) -> f32 {
        let rect = self.rect(viewer);
        rect.left() + viewer.divider * rect.width()
    }

    fn place(self, viewer: &Viewer, at: Pos2) -> [f32; 2] {
        viewer.view.place(self.room, self.size, [at.x, at.y])
    }

    fn pixel(self, viewer: &Viewer, at: Pos2) -> Option<[u32; 2]> {
        viewer.view.pixel(self.room, self.size, [at.x, at.y])
    }
}

fn draw(ui: &Ui, viewer: &Viewer, textures: &[Option<TextureHandle>; 2], place: Place) {
    let painter = ui.painter();
    let rect = place.rect(viewer);
    let parts = if viewer.compares() {
        vec![(0, 0.0..=viewer.divider), (1, viewer.divider..=1.0)]
    } else {
        vec![(0, 0.0..=1.0)]
    };
    for (side, part) in parts {
        let Some(texture) = &textures[side] else { continue };
        let (start, end) = (*part.start(), *part.end());
        let x = |part: f32| rect.left() + part * rect.width();
        let on_screen = Rect::from_x_y_ranges(x(start)..=x(end), rect.y_range());
        let of_texture = Rect::from_min_max(pos2(start, 0.0), pos2(end, 1.0));
        painter.image(texture.id(), on_screen, of_texture, Color32::WHITE);
    }
    if viewer.compares() {
        draw_divider(ui, viewer, place);
    }
    if let Some(drawing) = viewer.path.drawing() {
        path::draw(painter, drawing, |at| {
            let [x, y] = viewer.view.point(place.room, place.size, at);
            pos2(x, y)
        });
    }
    if let Some(pixel) = viewer.pinned {
        mark(ui, viewer, place, pixel, Color32::WHITE);
    }
    let zoom = viewer.view.zoom(place.room, place.size);
    if let Some(pixel) = viewer.pointed.filter(|_| zoom >= 4.0) {
        mark(ui, viewer, place, pixel, Color32::from_white_alpha(120));
    }
}

/// The line between two pictures, and what is on its sides.
fn draw_divider(ui: &Ui, viewer: &Viewer, place: Place) {
    let (rect, x) = (place.rect(viewer), place.divider(viewer));
    let painter = ui.painter();
    painter.vline(x, rect.y_range(), Stroke::new(3.0, Color32::from_black_alpha(140)));
    painter.vline(x, rect.y_range(), Stroke::new(1.0, Color32::WHITE));
    let [first, second] = [0, 1].map(|side| viewer.order.sides.get(side).copied());
    let y = rect.top().max(place.room[1]) + 10.0;
    for (choices, other, side) in [(first, second, 0), (second, first, 1)] {
        let Some(choices) = choices else { continue };
        let (align, at) = if side == 0 {
            (Align2::RIGHT_TOP, pos2(x - 12.0, y))
        } else {
            (Align2::LEFT_TOP, pos2(x + 12.0, y))
        };
        let font = FontId::proportional(13.0);
        let color = style::SIDES[side];
        let galley = painter.layout_no_wrap(choices.label(other.as_ref()), font, color);
        let text = align.anchor_size(at, galley.size());
        painter.rect_filled(text.expand2(vec2(7.0, 4.0)), 4.0, style::VEIL);
        painter.galley(text.min, galley, color);
    }
}

/// A frame around a pixel.
fn mark(ui: &Ui, viewer: &Viewer, place: Place, pixel: [u32; 2], color: Color32) {
    let corner = |add: f32| {
        let at = pixel.map(|side| side as f32 + add);
        let [x, y] = viewer.view.point(place.room, place.size, at);
        pos2(x, y)
    };
    let rect = Rect::from_two_pos(corner(0.0), corner(1.0)).expand(1.5);
    let dark = Stroke::new(3.0, Color32::from_black_alpha(160));
    ui.painter().rect_stroke(rect, 1.0, dark, StrokeKind::Outside);
    ui.painter().rect_stroke(rect, 1.0, Stroke::new(1.0, color), StrokeKind::Outside);
}

fn hands(
    ui: &Ui,
    response: &Response,
    viewer: &mut Viewer,
    place: Place,
    drag: &mut Drag,
    now: Instant,
) {
    let pointer = response.hover_pos();
    viewer.pointed = pointer.and_then(|at| place.pixel(viewer, at));
    if let Some(at) = pointer {
        wheel(ui, viewer, place, at, now);
        let is_at_divider = viewer.compares() && (at.x - place.divider(viewer)).abs() < REACH;
        if is_at_divider || response.dragged() && *drag == Drag::Divider {
            ui.ctx().set_cursor_icon(CursorIcon::ResizeHorizontal);
        }
        if response.drag_started() {
            *drag = if is_at_divider { Drag::Divider } else { Drag::Camera };
        }
    }
    if let Some(at) = response.interact_pointer_pos() {
        if response.double_clicked() {
            viewer.focus(place.place(viewer, at));
        } else if response.clicked() {
            viewer.pinned = place.pixel(viewer, at);
        }
        if *drag == Drag::Divider && response.dragged() {
            let rect = place.rect(viewer);
            viewer.divider = ((at.x - rect.left()) / rect.width()).clamp(0.0, 1.0);
            return;
        }
    }
    move_camera(ui, response, viewer, place, now);
}

/// Drags of the camera, and of the picture.
fn move_camera(ui: &Ui, response: &Response, viewer: &mut Viewer, place: Place, now: Instant) {
    let by = response.drag_delta();
    if by == egui::Vec2::ZERO {
        return;
    }
    let (x, y) = (f64::from(by.x), f64::from(by.y));
    let modifiers = ui.input(|input| input.modifiers);
    if response.dragged_by(PointerButton::Middle) || modifiers.command {
        viewer.view.pan(place.room, place.size, [by.x, by.y]);
    } else if response.dragged_by(PointerButton::Secondary) {
        let height = f64::from(place.rect(viewer).height().max(1.0));
        viewer.navigate(now, |navigator| navigator.pan(x / height, y / height));
    } else if modifiers.shift {
        viewer.navigate(now, |navigator| navigator.look(x * TURN, -y * TURN));
    } else {
        viewer.navigate(now, |navigator| navigator.orbit(x * TURN, y * TURN));
    }
}

/// The wheel, with and without Ctrl.
fn wheel(ui: &Ui, viewer: &mut Viewer, place: Place, at: Pos2, now: Instant) {
    let (turned, zoom) =
        ui.input(|input| (f64::from(input.smooth_scroll_delta.y), input.zoom_delta()));
    if zoom != 1.0 {
        viewer.view.zoom_at(place.room, place.size, [at.x, at.y], zoom);
    } else if turned != 0.0 {
        viewer.navigate(now, |navigator| navigator.zoom((NEARER * turned).exp()));
    }
}
