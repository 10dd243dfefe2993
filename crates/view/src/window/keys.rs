//! What keys do.

use crate::layers::Layer;
use crate::navigator::Navigator;
use crate::view::View;
use crate::viewer::Viewer;
use eframe::egui::{InputState, Key, Ui};
use glam::DVec3;
use std::time::Instant;

/// The keys, and what they do, for whoever asks.
pub const HELP: &[(&str, &str)] = &[
    ("drag", "orbit"),
    ("right drag", "move across"),
    ("Shift + drag", "look around"),
    ("wheel", "come nearer"),
    ("Ctrl + wheel", "enlarge the picture"),
    ("middle drag", "move the picture"),
    ("click", "keep a pixel in the inspector"),
    ("double click", "focus and turn around there"),
    ("W A S D Q E", "fly; faster with Shift"),
    ("1 ... 7", "layers"),
    ("+ -", "exposure"),
    ("Space", "pause"),
    ("C", "two side by side"),
    ("F, Z", "fit the picture, 1:1"),
    ("R", "the scene's camera"),
    ("L", "load the scene again"),
    ("P", "save the picture"),
    ("Esc", "let the pixel go"),
];

const LAYER_KEYS: [Key; 7] =
    [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5, Key::Num6, Key::Num7];

/// Does what the keys ask for that are pressed, unless somebody is writing.
pub fn take(ui: &Ui, viewer: &mut Viewer, now: Instant) {
    if ui.ctx().egui_wants_keyboard_input() {
        return;
    }
    ui.input(|input| {
        for (key, layer) in LAYER_KEYS.into_iter().zip(Layer::ALL) {
            if input.key_pressed(key) {
                viewer.show(layer);
            }
        }
        press(input, viewer);
    });
    fly(ui, viewer, now);
}

fn press(input: &InputState, viewer: &mut Viewer) {
    let is_pressed = |key| input.key_pressed(key) && !input.modifiers.command;
    if is_pressed(Key::Space) {
        viewer.order.paused = !viewer.order.paused;
    }
    if is_pressed(Key::C) {
        viewer.compare(!viewer.compares());
    }
    if is_pressed(Key::F) {
        viewer.view = View::default();
    }
    if is_pressed(Key::Z) {
        viewer.view = View::whole();
    }
    if is_pressed(Key::R) {
        viewer.reset_camera();
    }
    if is_pressed(Key::L) {
        viewer.reload();
    }
    if is_pressed(Key::P) {
        viewer.save_picture();
    }
    if is_pressed(Key::Escape) {
        viewer.pinned = None;
    }
    let stops = f32::from(u8::from(is_pressed(Key::Plus) || is_pressed(Key::Equals)))
        - f32::from(u8::from(is_pressed(Key::Minus)));
    if stops != 0.0 {
        let mut display = viewer.display();
        display.exposure = (display.exposure + 0.5 * stops).clamp(-20.0, 20.0);
        viewer.set_display(display);
    }
}

/// Flies while keys are held.
fn fly(ui: &Ui, viewer: &mut Viewer, now: Instant) {
    let (step, seconds) = ui.input(|input| {
        let along = |plus: Key, minus: Key| {
            f64::from(u8::from(input.key_down(plus))) - f64::from(u8::from(input.key_down(minus)))
        };
        let step = DVec3::new(along(Key::D, Key::A), along(Key::E, Key::Q), along(Key::W, Key::S));
        let factor = if input.modifiers.shift { 4.0 } else { 1.0 };
        (step * factor, f64::from(input.stable_dt.min(0.1)))
    });
    if step != DVec3::ZERO {
        let speed = viewer.navigator().map_or(0.0, Navigator::speed);
        viewer.navigate(now, |navigator| navigator.fly(step * speed * seconds));
        ui.ctx().request_repaint();
    }
}
