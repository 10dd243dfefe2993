//! What can go wrong with a figure.

use raystream::image::ImageError;
use std::path::PathBuf;

/// Why a figure could not be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FigureError {
    /// The picture could not be written.
    #[error(transparent)]
    Image(#[from] ImageError),
    /// Colours cannot span a range.
    #[error(
        "{}: the colours cannot go from {low} to {high}; give two finite numbers, the smaller \
         first",
        path.display()
    )]
    ColorRange {
        /// The picture.
        path: PathBuf,
        /// The number at the low end.
        low: f32,
        /// The number at the high end.
        high: f32,
    },
    /// A plot could not be drawn.
    #[error("the plot '{title}' could not be made: {reason}; please report it")]
    Plot {
        /// Its title.
        title: String,
        /// What went wrong.
        reason: String,
    },
}
