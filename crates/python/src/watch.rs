//! Ctrl-C: who looks for it while a render is under way.

use pyo3::prelude::*;
use raystream::exec::Executor;
use raystream::render::{Progress, Watch};
use std::time::{Duration, Instant};

/// How often signals are looked for.
const INTERVAL: Duration = Duration::from_millis(50);

/// Looks for signals after each batch.
pub struct Signals {
    last: Instant,
    error: Option<PyErr>,
    /// Whether the render is to be gone on with, so that nothing may be lost.
    goes_on: bool,
}

impl Signals {
    /// For a render that is dropped if a signal comes.
    pub fn of_one() -> Self {
        Self { last: Instant::now(), error: None, goes_on: false }
    }

    /// For a round of a render that may go on after a signal.
    pub fn of_round() -> Self {
        Self { goes_on: true, ..Self::of_one() }
    }

    /// What the signal's handler raised, if there was one.
    pub fn raised(self) -> PyResult<()> {
        self.error.map_or(Ok(()), Err)
    }
}

impl<E: Executor> Watch<E> for Signals {
    fn is_interrupted(&self) -> bool {
        self.error.is_some()
    }

    fn is_cancelled(&self) -> bool {
        self.error.is_some() && !self.goes_on
    }

    fn keeps_checkpoints(&self) -> bool {
        self.goes_on
    }

    fn batch_ended(&mut self, _: &Progress) {
        if self.error.is_none() && self.last.elapsed() >= INTERVAL {
            self.error = Python::attach(|py| py.check_signals().err());
            self.last = Instant::now();
        }
    }
}
