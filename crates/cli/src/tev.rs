//! `--tev`: the picture of a render under way, in another viewer.

use super::output::say;
use raystream::exec::Executor;
use raystream::film::Film;
use raystream::render::{RenderError, Renderer};
use raystream_figures::Pace;
use raystream_figures::tev::Tev;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Rendering between two pictures, at least.
const SHORTEST: Duration = Duration::from_millis(250);

/// Who sees a render's pictures while it runs.
pub struct Audience {
    tev: Option<Tev>,
    since: Instant,
    pace: Pace,
}

impl Audience {
    /// That of `tev`; nobody without it.
    pub fn new(tev: Option<Tev>) -> Self {
        Self { tev, since: Instant::now(), pace: Pace::new(SHORTEST) }
    }

    /// Shows what there is, if that is due.
    ///
    /// # Errors
    /// If the device fails.
    pub fn may_look<E: Executor>(&mut self, renderer: &Renderer<E>) -> Result<(), RenderError> {
        let Some(tev) = &self.tev else { return Ok(()) };
        let rendered = self.since.elapsed().saturating_sub(self.pace.total());
        if !self.pace.is_due(rendered) {
            return Ok(());
        }
        if let Some(failure) = tev.take_failure() {
            self.lose(&failure);
            return Ok(());
        }
        let start = Instant::now();
        tev.show(Arc::new(renderer.glance()?));
        self.pace.shown(rendered, start.elapsed());
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
