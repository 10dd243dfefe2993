//! A picture of the window itself, for documents and for tests.

use eframe::egui::{ColorImage, Context, ViewportCommand};
use raystream::image::write_rgb8;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// A picture of the window that is taken once, after which the window closes.
pub struct Screenshot {
    path: PathBuf,
    after: Duration,
    since: Option<Instant>,
    is_asked_for: bool,
    outcome: Outcome,
}

/// What came of a picture of the window: None until it is there.
pub type Outcome = Arc<Mutex<Option<Result<(), String>>>>;

impl Screenshot {
    /// One to be written to `path` as a PNG, so long after the first picture of the scene, and
    /// where to read what came of it.
    pub fn new(path: PathBuf, after: Duration) -> (Self, Outcome) {
        let outcome = Outcome::default();
        let kept = Arc::clone(&outcome);
        (Self { path, after, since: None, is_asked_for: false, outcome }, kept)
    }

    /// Takes it if it is time to; `has_picture` says whether there is a picture of the scene.
    pub fn take_when_due(&mut self, ctx: &Context, has_picture: bool) {
        if self.is_asked_for || !has_picture {
            return;
        }
        let elapsed = self.since.get_or_insert_with(Instant::now).elapsed();
        if elapsed < self.after {
            ctx.request_repaint_after(self.after - elapsed);
            return;
        }
        self.is_asked_for = true;
        let (path, outcome, on) = (self.path.clone(), Arc::clone(&self.outcome), ctx.clone());
        ctx.request_screenshot(move |image| {
            let written = write(&path, &image);
            *outcome.lock().unwrap_or_else(PoisonError::into_inner) = Some(written);
            on.send_viewport_cmd(ViewportCommand::Close);
            on.request_repaint();
        });
    }
}

fn write(path: &Path, image: &ColorImage) -> Result<(), String> {
    let bytes: Vec<u8> = image.pixels.iter().flat_map(|c| [c.r(), c.g(), c.b()]).collect();
    let [width, height] = image.size.map(|side| side as u32);
    write_rgb8(path, width, height, &bytes).map_err(|error| error.to_string())
}
