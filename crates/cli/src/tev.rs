//! `--tev`: the picture of a render under way, in another viewer.

use super::output::say;
use raystream::exec::Executor;
use raystream::film::Film;
use raystream::render::{RenderError, Renderer};
use raystream_figures::tev::Tev;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// A picture is sent this often at most.
const SHORTEST_INTERVAL: Duration = Duration::from_millis(250);
/// Pictures take one part of so many of the render's time, at most.
const SHARE: u32 = 25;

/// Who sees a render's pictures while it runs.
pub struct Audience {
    tev: Option<Tev>,
    due: Instant,
}

impl Audience {
    /// That of `tev`; nobody without it.
    pub fn new(tev: Option<Tev>) -> Self {
        Self { tev, due: Instant::now() }
    }

    /// Shows what there is, if that is due.
    ///
    /// # Errors
    /// If the device fails.
    pub fn may_look<E: Executor>(&mut self, renderer: &Renderer<E>) -> Result<(), RenderError> {
        let Some(tev) = &self.tev else { return Ok(()) };
        let start = Instant::now();
        if start < self.due {
            return Ok(());
        }
        if let Some(failure) = tev.take_failure() {
            self.lose(&failure);
            return Ok(());
        }
        tev.show(Arc::new(renderer.glance()?));
        self.due = Instant::now() + SHORTEST_INTERVAL.max(start.elapsed() * (SHARE - 1));
        Ok(())
    }

    /// Shows the picture as it is in the end, and waits until it has been sent.
    pub fn see_the_end(&mut self, film: &Film) {
        let Some(tev) = self.tev.take() else { return };
        tev.show(Arc::new(film.clone()));
        if let Some(failure) = tev.finish() {
            self.lose(&failure);
        }
    }

    /// The render goes on without.
    fn lose(&mut self, failure: &str) {
        self.tev = None;
        say(&format!("warning: {failure}; nothing more is sent there"));
    }
}
