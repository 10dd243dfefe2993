//! Pictures on disk: EXR with named layers, PNG, and their comparison.
//!
//! A render is written with [`write_film`], any other picture with [`write_color`]: the extension
//! of the path says how. [`read_color`] reads what any tool wrote; [`compare()`] and
//! [`difference()`] set two pictures side by side. Call [`check_writable`] before a long render, so
//! that a mistyped path costs no hours.
//!
//! Files appear whole or not at all: they are written beside the target and renamed.

mod agreement;
mod color;
mod compare;
mod difference;
mod error;
mod format;
mod layers;
#[cfg(feature = "exr")]
mod openexr;
mod picture;
mod png;
mod read;
mod replace;
mod similarity;
mod tone;

pub use agreement::{Agreement, agreement};
pub use color::ColorImage;
pub use compare::{BlockComparison, Comparison, ComparisonSettings, compare, trimmed_mean};
pub use difference::difference;
pub use error::ImageError;
pub use format::Format;
pub use layers::{Channel, LayeredImage, check_film};
#[cfg(feature = "exr")]
pub use openexr::{read_layers, read_settings, write_layers};
pub use picture::{Picture, Values, decode_picture, read_color, read_picture};
pub use png::{write_png, write_rgb8};
pub(crate) use read::{open_file, read_file};
pub(crate) use replace::{check_replaceable, replace_file_with};
pub use replace::{check_writable, discard_unfinished, replace_file, written_file};
pub use tone::{Display, ToneMap};

use crate::film::Film;
use std::path::Path;

/// Reads an EXR file that is in memory and called `path` in errors, whatever its name ends in; as
/// [`read_picture`].
#[cfg(feature = "exr")]
pub(crate) fn decode_exr(path: &Path, file: &[u8]) -> Result<Picture, ImageError> {
    openexr::decode_color(path, file)
}

/// Writes a render: to `.exr` every layer ([`LayeredImage::from_film`]), to `.png` its colour.
///
/// # Errors
/// As [`write_film_as`].
pub fn write_film(path: impl AsRef<Path>, film: &Film) -> Result<(), ImageError> {
    write_film_as(path.as_ref(), film, &[], &Display::default())
}

/// Writes a render: to `.exr` every layer ([`LayeredImage::from_film`]) and `settings`
/// ([`write_layers`]), to `.png` its colour as `display` says.
///
/// # Errors
/// [`ImageError`] if the extension is neither, the film's buffers do not fit its size, or the file
/// cannot be written. An existing file is then left as it was.
#[cfg_attr(not(feature = "exr"), expect(unused_variables, reason = "a PNG has no header"))]
pub fn write_film_as(
    path: &Path,
    film: &Film,
    settings: &[(String, String)],
    display: &Display,
) -> Result<(), ImageError> {
    match Format::of(path)? {
        #[cfg(feature = "exr")]
        Format::Exr => write_layers(path, &LayeredImage::from_film(path, film)?, settings),
        Format::Png => write_png(path, &ColorImage::from_film(film), display),
    }
}

/// Writes a picture of colours alone: to `.exr` as the channels R, G, B with `settings`, to `.png`
/// as `display` says.
///
/// # Errors
/// As [`write_film_as`].
#[cfg_attr(not(feature = "exr"), expect(unused_variables, reason = "a PNG has no header"))]
pub fn write_color(
    path: &Path,
    image: &ColorImage,
    settings: &[(String, String)],
    display: &Display,
) -> Result<(), ImageError> {
    match Format::of(path)? {
        #[cfg(feature = "exr")]
        Format::Exr => write_layers(path, &LayeredImage::from_color(image), settings),
        Format::Png => write_png(path, image, display),
    }
}
