//! The window: it draws what a [`Viewer`] has, and tells it what hands do.

mod canvas;
mod controls;
mod keys;
mod legend;
mod path;
mod plot;
mod screenshot;
mod style;

use crate::inspect;
use crate::news::Activity;
use crate::thread::RenderThread;
use crate::viewer::Viewer;
use eframe::egui;
pub use screenshot::Screenshot;
use std::time::Instant;

/// The window.
pub struct Window {
    viewer: Viewer,
    textures: [Option<egui::TextureHandle>; 2],
    controls: controls::Controls,
    drag: canvas::Drag,
    screenshot: Option<Screenshot>,
    is_styled: bool,
    /// Ends with the window.
    thread: Option<RenderThread>,
}

impl Window {
    /// A window of what `viewer` has; with `screenshot`, it takes one and closes.
    pub fn new(viewer: Viewer, screenshot: Option<Screenshot>) -> Self {
        Self {
            viewer,
            textures: [None, None],
            controls: controls::Controls::default(),
            drag: canvas::Drag::default(),
            screenshot,
            is_styled: false,
            thread: None,
        }
    }

    /// The same; the thread ends when the window closes.
    pub fn with_thread(self, thread: RenderThread) -> Self {
        Self { thread: Some(thread), ..self }
    }

    /// What it shows.
    pub fn viewer(&self) -> &Viewer {
        &self.viewer
    }

    /// What it shows, to be changed.
    pub fn viewer_mut(&mut self) -> &mut Viewer {
        &mut self.viewer
    }

    /// Draws all of it into `ui`, which is as large as the window, and takes what hands have done.
    pub fn draw(&mut self, ui: &mut egui::Ui) {
        if !std::mem::replace(&mut self.is_styled, true) {
            style::apply(ui.ctx());
        }
        let now = Instant::now();
        keys::take(ui, &mut self.viewer, now);
        egui::Panel::bottom("status").show(ui, |ui| self.status(ui));
        egui::Panel::right("controls")
            .default_size(300.0)
            .size_range(260.0..=480.0)
            .show(ui, |ui| self.controls.show(ui, &mut self.viewer));
        let frame = egui::Frame::NONE.fill(style::BACKGROUND);
        egui::CentralPanel::default().frame(frame).show(ui, |ui| {
            canvas::show(ui, &mut self.viewer, &self.textures, &mut self.drag, now);
        });
        let again = self.viewer.update(now);
        self.upload(ui.ctx());
        if let Some(time) = again {
            ui.ctx().request_repaint_after(time);
        }
        if let Some(screenshot) = &mut self.screenshot {
            screenshot.take_when_due(ui.ctx(), self.viewer.side(0).frame.is_some());
        }
    }

    /// Brings new pictures to the device that draws the window.
    fn upload(&mut self, ctx: &egui::Context) {
        for side in 0..2 {
            let Some(painted) = self.viewer.take_painted(side) else { continue };
            let size = painted.size.map(|side| side as usize);
            let image = egui::ColorImage::from_rgb(size, painted.pixels.as_flattened());
            let options = egui::TextureOptions {
                minification: egui::TextureFilter::Linear,
                ..egui::TextureOptions::NEAREST
            };
            match &mut self.textures[side] {
                Some(texture) => texture.set(image, options),
                None => {
                    self.textures[side] =
                        Some(ctx.load_texture(format!("side {side}"), image, options));
                }
            }
            ctx.request_repaint();
        }
    }

    /// The line at the bottom: what is going on, and how far it is.
    fn status(&self, ui: &mut egui::Ui) {
        ui.horizontal(|ui| {
            ui.set_min_height(22.0);
            let viewer = &self.viewer;
            let text = inspect::activity(viewer.activity(), viewer.stop());
            match viewer.activity() {
                Activity::Failed(_) => {
                    ui.colored_label(style::WRONG, text);
                    return;
                }
                Activity::Loading | Activity::Opening => drop(ui.spinner()),
                _ => {}
            }
            ui.strong(text);
            ui.separator();
            for side in 0..viewer.shown_sides() {
                let Some(status) = viewer.status(side) else { continue };
                if viewer.compares() {
                    let size = egui::Vec2::splat(9.0);
                    let (dot, _) = ui.allocate_exact_size(size, egui::Sense::hover());
                    ui.painter().circle_filled(dot.center(), 4.0, style::SIDES[side]);
                }
                ui.label(inspect::progress(status)).on_hover_text(inspect::showing(status));
                ui.separator();
            }
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                ui.add(egui::Label::new(viewer.device().unwrap_or_default()).truncate());
            });
        });
    }
}

impl eframe::App for Window {
    fn ui(&mut self, ui: &mut egui::Ui, _: &mut eframe::Frame) {
        self.draw(ui);
    }

    fn on_exit(&mut self) {
        self.thread = None;
    }
}
