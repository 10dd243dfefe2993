//! Measurements: traversal ([`rays`]) and whole paths ([`paths`]). Each checks its own result before it gives a figure.

pub mod paths;
pub mod rays;

use crate::exec::ExecError;
use std::time::Duration;

/// What can go wrong in a measurement.
#[derive(Debug, thiserror::Error)]
pub enum BenchError {
    /// The device failed.
    #[error(transparent)]
    Exec(#[from] ExecError),
    /// The render failed.
    #[error(transparent)]
    Render(#[from] crate::render::RenderError),
    /// The result was wrong, so its speed is worth nothing.
    #[error("the measured result is wrong, no figure given: {0}")]
    Wrong(String),
}

/// The middle one of `times`, which are not empty.
fn median(mut times: Vec<Duration>) -> Duration {
    times.sort();
    times[times.len() / 2]
}
