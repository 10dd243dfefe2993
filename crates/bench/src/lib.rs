//! Measurements: traversal ([`rays`]), whole paths ([`paths`]), integrators side by side
//! ([`integrators`]), what adaptive sampling or another integrator gains ([`convergence`]) and
//! whether its pictures are right on average ([`bias`]) and know their errors ([`calibration`]). Each
//! checks its own result before it gives a figure.

pub mod bias;
pub mod calibration;
pub mod convergence;
mod files;
pub mod integrators;
pub mod paths;
pub mod rays;
mod tables;

pub use files::Folder;

use raystream::exec::ExecError;
use raystream::image::ImageError;
use raystream::render::RenderError;
use raystream_figures::FigureError;
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// What a report is about.
#[derive(Clone, Debug)]
pub struct About {
    /// What the scene is called in titles, and its folder.
    pub label: String,
    /// Device, size, settings ...: pairs of name and value.
    pub facts: Vec<(String, String)>,
}

impl About {
    /// The heading of the scene's part of a report and, in a list, the facts.
    fn heading(&self) -> String {
        let facts: String =
            self.facts.iter().map(|(name, value)| format!("- {name}: {value}\n")).collect();
        format!("## {}\n\n{facts}", self.label)
    }

    /// The scene's folder, in links.
    fn folder(&self) -> String {
        // Blanks would end a path in Markdown.
        self.label.replace(' ', "%20")
    }
}

/// The tables of a scene in Markdown.
pub struct SceneReport {
    /// What to print.
    pub tables: String,
    /// The same with the plots and pictures, by their paths from the folder above that of the
    /// scene.
    pub section: String,
}

/// What can go wrong in a measurement.
#[derive(Debug, thiserror::Error)]
pub enum BenchError {
    /// The device failed.
    #[error(transparent)]
    Exec(#[from] ExecError),
    /// The render failed.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// The result was wrong, so its speed is worth nothing.
    #[error("the measured result is wrong, no figure given: {0}")]
    Wrong(String),
    /// A picture or another file could not be read or written.
    #[error(transparent)]
    Image(#[from] ImageError),
    /// A figure could not be made.
    #[error(transparent)]
    Figure(#[from] FigureError),
    /// A folder for results could not be made or written to.
    #[error("{}: files cannot be put into this folder: {source}; name another one", path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// A table could not be made of the results.
    #[error("{what} could not be made: {reason}; please report it")]
    Report {
        /// Which.
        what: String,
        /// What went wrong.
        reason: String,
    },
}

/// The values in their order, each once.
pub fn each_once<T: PartialEq>(values: impl IntoIterator<Item = T>) -> Vec<T> {
    let mut once = Vec::new();
    for value in values {
        if !once.contains(&value) {
            once.push(value);
        }
    }
    once
}

/// A device that has been idle runs slowly at first: a GPU at a sixth of its clock, for most of a
/// second.
const WARM_UP: Duration = Duration::from_secs(1);
/// One that was left alone for a moment, by a program that is measuring, needs no more than this.
const KEEP_WARM: Duration = Duration::from_millis(200);

/// Repeats `work`, at least once, for `time`, so that the device has reached its speed.
fn warm_up<E>(time: Duration, mut work: impl FnMut() -> Result<(), E>) -> Result<(), E> {
    let start = Instant::now();
    work()?;
    while start.elapsed() < time {
        work()?;
    }
    Ok(())
}

/// The middle one of `times`, which are not empty.
fn median(mut times: Vec<Duration>) -> Duration {
    times.sort();
    times[times.len() / 2]
}
