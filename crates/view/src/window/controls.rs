//! The panel at the side: what is shown, what is rendered, and what is known of it.

use super::{keys, plot, style};
use crate::choices::{Choices, Stops};
use crate::layers::Layer;
use crate::view::View;
use crate::viewer::{Saved, Viewer};
use eframe::egui::{
    self, Button, ComboBox, DragValue, Grid, Response, RichText, ScrollArea, Slider, TextEdit, Ui,
};
use raystream::exec::devices::{Devices, OpenOptions};
use raystream::image::ToneMap;
use raystream::render::{AllocatorKind, Estimator, FilterKind, IntegratorKind};
use std::time::Duration;

/// What the panel remembers.
#[derive(Default)]
pub struct Controls {
    /// The names of the devices, once somebody has asked for them: to look takes a moment.
    devices: Option<Vec<String>>,
}

impl Controls {
    /// Draws the panel and takes what is chosen there.
    pub fn show(&mut self, ui: &mut Ui, viewer: &mut Viewer) {
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            ui.add_space(6.0);
            section(ui, "Picture", |ui| picture(ui, viewer));
            section(ui, "Render", |ui| self.render(ui, viewer));
            let is_open = viewer.order.stops != Stops::default();
            let header = egui::CollapsingHeader::new(RichText::new("Stop at").strong());
            header.default_open(is_open).show(ui, |ui| stops(ui, viewer));
            section(ui, "Error over time", |ui| plot::show(ui, viewer));
            section(ui, "Pixel", |ui| pixel(ui, viewer));
            section(ui, "Save", |ui| save(ui, viewer));
            closed_section(ui, "Scene", |ui| scene(ui, viewer));
            closed_section(ui, "Keys", help);
        });
    }

    fn render(&mut self, ui: &mut Ui, viewer: &mut Viewer) {
        ui.horizontal(|ui| {
            let mut compares = viewer.compares();
            if ui.toggle_value(&mut compares, "side by side").clicked() {
                viewer.compare(compares);
            }
            if viewer.compares() {
                for (side, name) in ["left", "right"].into_iter().enumerate() {
                    let text = RichText::new(name).color(style::SIDES[side]);
                    ui.selectable_value(&mut viewer.chosen_side, side, text);
                }
            }
        });
        Grid::new("render").num_columns(2).spacing([10.0, 6.0]).show(ui, |ui| {
            if let Some(choices) = viewer.choices() {
                choose(ui, choices);
            }
            let label = ui.label("device");
            self.device(ui, &mut viewer.order.device).labelled_by(label.id);
            ui.end_row();
        });
        let paused = viewer.order.paused;
        if ui.button(if paused { "go on" } else { "pause" }).clicked() {
            viewer.order.paused = !paused;
        }
    }

    fn device(&mut self, ui: &mut Ui, device: &mut String) -> Response {
        let text = device.clone();
        let shown =
            ComboBox::from_id_salt("device").selected_text(text).width(150.0).show_ui(ui, |ui| {
                let names = self.devices.get_or_insert_with(|| {
                    let found = Devices::enumerate(OpenOptions::default()).list();
                    let usable = found.into_iter().filter(|device| device.unsuitable.is_none());
                    ["auto".to_owned()].into_iter().chain(usable.map(|d| d.name)).collect()
                });
                for name in names {
                    ui.selectable_value(device, name.clone(), name.as_str());
                }
            });
        shown.response
    }
}

fn section(ui: &mut Ui, title: &str, contents: impl FnOnce(&mut Ui)) {
    let header = egui::CollapsingHeader::new(RichText::new(title).strong()).default_open(true);
    header.show(ui, contents);
}

fn closed_section(ui: &mut Ui, title: &str, contents: impl FnOnce(&mut Ui)) {
    egui::CollapsingHeader::new(RichText::new(title).strong()).show(ui, contents);
}

fn picture(ui: &mut Ui, viewer: &mut Viewer) {
    ui.horizontal_wrapped(|ui| {
        for layer in Layer::ALL {
            if ui.selectable_label(viewer.layer() == layer, layer.name()).clicked() {
                viewer.show(layer);
            }
        }
    });
    let mut display = viewer.display();
    ui.horizontal(|ui| {
        let label = ui.label("exposure");
        let slider = Slider::new(&mut display.exposure, -8.0..=8.0).suffix(" stops").step_by(0.1);
        if ui.add(slider).labelled_by(label.id).double_clicked() {
            display.exposure = 0.0;
        }
    });
    ui.horizontal(|ui| {
        ui.label("tone map");
        for tone_map in ToneMap::ALL.iter().copied() {
            ui.selectable_value(&mut display.tone_map, tone_map, tone_map.name());
        }
    });
    viewer.set_display(display);
    ui.horizontal(|ui| {
        if ui.button("fit").clicked() {
            viewer.view = View::default();
        }
        if ui.button("1:1").clicked() {
            viewer.view = View::whole();
        }
        if ui.button("reset camera").clicked() {
            viewer.reset_camera();
        }
    });
}

/// A row of a grid: a name and a choice among values that have names.
fn choice<T: Copy + PartialEq>(
    ui: &mut Ui,
    label: &str,
    value: &mut T,
    all: impl Iterator<Item = T>,
    name: impl Fn(T) -> &'static str,
) {
    let named = ui.label(label);
    let text = name(*value);
    let shown = ComboBox::from_id_salt(label).selected_text(text).width(150.0).show_ui(ui, |ui| {
        for one in all {
            ui.selectable_value(value, one, name(one));
        }
    });
    shown.response.labelled_by(named.id);
    ui.end_row();
}

fn choose(ui: &mut Ui, choices: &mut Choices) {
    let all = AllocatorKind::ALL.iter().copied();
    choice(ui, "allocator", &mut choices.allocator, all, AllocatorKind::name);
    let all = Estimator::ALL.iter().copied();
    choice(ui, "estimator", &mut choices.estimator, all, Estimator::name);
    ui.label("errors");
    ui.horizontal(|ui| {
        ui.selectable_value(&mut choices.relative, false, "absolute");
        ui.selectable_value(&mut choices.relative, true, "relative");
    });
    ui.end_row();
    let all = IntegratorKind::ALL.iter().copied();
    choice(ui, "integrator", &mut choices.integrator, all, IntegratorKind::name);
    let all = [None].into_iter().chain(FilterKind::ALL.iter().copied().map(Some));
    choice(ui, "denoise by", &mut choices.filter, all, |filter| {
        filter.map_or("nothing", FilterKind::name)
    });
    let label = ui.label("seed");
    ui.add(DragValue::new(&mut choices.seed)).labelled_by(label.id);
    ui.end_row();
}

fn stops(ui: &mut Ui, viewer: &mut Viewer) {
    let stops = &mut viewer.order.stops;
    Grid::new("stops").num_columns(2).spacing([10.0, 6.0]).show(ui, |ui| {
        optional(ui, "samples", &mut stops.samples, 256, |ui, samples| {
            ui.add(DragValue::new(samples).range(1..=1 << 24).suffix(" spp"))
        });
        let mut seconds = stops.time.map(|time| time.as_secs_f64());
        optional(ui, "time", &mut seconds, 60.0, |ui, seconds| {
            ui.add(DragValue::new(seconds).range(0.1..=1e6).suffix(" s"))
        });
        stops.time = seconds.map(Duration::from_secs_f64);
        let mut percent = stops.noise.map(|noise| 100.0 * noise);
        optional(ui, "error", &mut percent, 2.0, |ui, percent| {
            ui.add(DragValue::new(percent).range(0.01..=100.0).speed(0.05).suffix(" %"))
        });
        stops.noise = percent.map(|percent| percent / 100.0);
    });
}

/// A row of a grid: a value that may be there.
fn optional<T: Copy>(
    ui: &mut Ui,
    name: &str,
    value: &mut Option<T>,
    default: T,
    edit: impl FnOnce(&mut Ui, &mut T) -> Response,
) {
    let mut is_there = value.is_some();
    let label = ui.checkbox(&mut is_there, name);
    *value = is_there.then(|| value.unwrap_or(default));
    if let Some(value) = value {
        edit(ui, value).labelled_by(label.id);
    }
    ui.end_row();
}

fn pixel(ui: &mut Ui, viewer: &mut Viewer) {
    let rows = viewer.inspected();
    if rows.is_empty() {
        ui.weak("point at the picture; click to keep a pixel");
        return;
    }
    self::rows(ui, "pixel", rows);
    if viewer.pinned.is_some() {
        path(ui, viewer);
        if ui.small_button("let go").clicked() {
            viewer.pinned = None;
        }
    }
}

/// The path of a sample of the pixel that is kept.
fn path(ui: &mut Ui, viewer: &mut Viewer) {
    let samples = viewer.samples_of_pinned();
    ui.horizontal(|ui| {
        let label = ui.checkbox(&mut viewer.path.is_wanted, "path of sample");
        let mut sample = viewer.path.sample.min(samples.max(1));
        let value = DragValue::new(&mut sample).range(1..=samples.max(1));
        if ui.add_enabled(samples > 1, value).labelled_by(label.id).changed() {
            viewer.path.sample = sample;
        }
        ui.label(format!("of {samples}"));
    });
    rows(ui, "path", viewer.inspected_path());
}

/// Names and values.
fn rows(ui: &mut Ui, id: &str, rows: Vec<(&'static str, String)>) {
    Grid::new(id).num_columns(2).spacing([10.0, 3.0]).show(ui, |ui| {
        for (name, value) in rows {
            ui.weak(name);
            ui.monospace(value);
            ui.end_row();
        }
    });
}

fn save(ui: &mut Ui, viewer: &mut Viewer) {
    let width = (ui.available_width() - 84.0).max(60.0);
    ui.horizontal(|ui| {
        let path = ui.add(TextEdit::singleline(&mut viewer.picture_path).desired_width(width));
        let hint = "all layers as .exr, the picture as .png (P)";
        let button = ui.button("picture").on_hover_text(hint);
        path.labelled_by(button.id);
        if button.clicked() {
            viewer.save_picture();
        }
    });
    ui.horizontal(|ui| {
        let path = ui.add(TextEdit::singleline(&mut viewer.camera_path).desired_width(width));
        let button = ui.add_enabled(viewer.facts().is_some(), Button::new("camera"));
        path.labelled_by(button.id);
        if button.on_hover_text("a copy of the scene's file with this camera").clicked() {
            viewer.save_camera();
        }
    });
    match &viewer.saved {
        Some(Saved::Done(text)) => drop(ui.colored_label(style::GOOD, text)),
        Some(Saved::Failed(text)) => drop(ui.colored_label(style::WRONG, text)),
        None if viewer.is_saving() => drop(ui.weak("waiting for a picture with all layers")),
        None => {}
    }
}

fn scene(ui: &mut Ui, viewer: &mut Viewer) {
    if ui.button("load again").clicked() {
        viewer.reload();
    }
    let Some(facts) = viewer.facts() else { return };
    ui.label(format!("{}, {} triangles", facts.name, facts.triangles));
    for warning in &facts.warnings {
        ui.colored_label(style::SIDES[0], warning);
    }
    let Some(navigator) = viewer.navigator() else { return };
    let camera = navigator.camera();
    let place = |v: glam::Vec3| v.to_array().map(crate::inspect::short).join("  ");
    Grid::new("camera").num_columns(2).spacing([10.0, 3.0]).show(ui, |ui| {
        for (name, value) in [("camera at", camera.origin), ("looks at", camera.target)] {
            ui.weak(name);
            ui.monospace(place(value));
            ui.end_row();
        }
    });
}

fn help(ui: &mut Ui) {
    Grid::new("keys").num_columns(2).spacing([10.0, 3.0]).show(ui, |ui| {
        for (key, what) in keys::HELP {
            ui.monospace(*key);
            ui.label(*what);
            ui.end_row();
        }
    });
}
