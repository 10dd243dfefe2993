//! What the colours of the picture mean, in its lower left corner.

use super::style;
use crate::viewer::Viewer;
use eframe::egui::{
    Align2, Color32, FontId, Mesh, Painter, Pos2, Rect, Shape, Stroke, Ui, pos2, vec2,
};
use raystream_figures::ColorScale;

const WIDTH: f32 = 300.0;
const MARGIN: f32 = 10.0;
const BAR: f32 = 12.0;
/// Pieces that the bar is made of; between their ends colours are mixed.
const PIECES: u16 = 32;

/// Draws the legend into the lower left corner of `room`.
pub fn show(ui: &Ui, viewer: &Viewer, room: Rect) {
    let Some(frame) = &viewer.side(0).frame else { return };
    let layer = viewer.layer();
    let mut title = layer.title(&frame.film).to_owned();
    if layer.is_radiance() {
        let stops = viewer.display().exposure;
        if stops == 0.0 {
            return;
        }
        title = format!("{title}, {stops:+.1} stops");
    }
    let painter = ui.painter_at(room);
    let font = FontId::proportional(12.0);
    let text = painter.layout(title, font, Color32::from_gray(230), WIDTH - 2.0 * MARGIN);
    let scale = viewer.scale().filter(|scale| scale.range().is_some());
    let bar = if scale.is_some() { BAR + 24.0 } else { 0.0 };
    let size = vec2(WIDTH, text.size().y + bar + 2.0 * MARGIN);
    let rect = Rect::from_min_size(room.left_bottom() + vec2(12.0, -12.0 - size.y), size);
    painter.rect_filled(rect, 6.0, style::VEIL);
    let top = rect.top() + MARGIN;
    let below = top + text.size().y + 6.0;
    painter.galley(pos2(rect.left() + MARGIN, top), text, Color32::WHITE);
    if let Some(scale) = scale {
        let range = rect.left() + 2.0 * MARGIN..=rect.right() - 2.0 * MARGIN;
        draw_bar(&painter, scale, Rect::from_x_y_ranges(range, below..=below + BAR));
    }
}

/// The colours, with numbers below.
fn draw_bar(painter: &Painter, scale: &ColorScale, bar: Rect) {
    let at =
        |position: f64, y: f32| -> Pos2 { pos2(bar.left() + position as f32 * bar.width(), y) };
    let mut mesh = Mesh::default();
    for piece in 0..=PIECES {
        let position = f64::from(piece) / f64::from(PIECES);
        let [r, g, b] = scale.color_along(position);
        let color = Color32::from_rgb(r, g, b);
        mesh.colored_vertex(at(position, bar.top()), color);
        mesh.colored_vertex(at(position, bar.bottom()), color);
        if piece > 0 {
            let last = 2 * u32::from(piece);
            mesh.add_triangle(last - 2, last - 1, last);
            mesh.add_triangle(last - 1, last, last + 1);
        }
    }
    painter.add(Shape::mesh(mesh));
    let (gray, font) = (Color32::from_gray(200), FontId::proportional(11.0));
    for (position, text) in scale.ticks(5) {
        let top = at(position, bar.bottom());
        painter.line_segment([top, top + vec2(0.0, 3.0)], Stroke::new(1.0, gray));
        painter.text(top + vec2(0.0, 4.0), Align2::CENTER_TOP, text, font.clone(), gray);
    }
}
