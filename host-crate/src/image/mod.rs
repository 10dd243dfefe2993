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
#[cfg(feature = "exr")]
mod exr_read;
#[cfg(feature = "exr")]
mod exr_select;
#[cfg(feature = "exr")]
mod exr_write;
mod format;
#[cfg(feature = "exr")]
mod guard;
mod layers;
mod png;
mod read;
mod replace;
mod tone;

pub use agreement::{Agreement, agreement};
pub use color::ColorImage;
pub use compare::{BlockComparison, Comparison, ComparisonSettings, compare, trimmed_mean};
pub use difference::difference;
pub use error::ImageError;
#[cfg(feature = "exr")]
pub use exr_read::{read_layers, read_settings};
#[cfg(feature = "exr")]
pub use exr_write::write_layers;
pub use format::Format;
pub use layers::{Channel, LayeredImage, check_film};
pub use png::{write_png, write_rgb8};
pub use replace::{check_writable, discard_unfinished, replace_file};
pub use tone::{Display, ToneMap};

use crate::film::Film;
use std::path::Path;

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

/// Reads the colours of a picture of any tool, linear as they stand in an `.exr`, decoded from sRGB
/// of a `.png`.
///
/// Of an EXR file it takes the channels R, G, B, or else those of a layer (`layer.R` ...),
/// preferring one that is named as the picture usually is (`color`, `beauty`, `combined` ...);
/// half, float or integer, scan lines or tiles. The picture is the data window. Transparency is
/// ignored.
///
/// # Errors
/// [`ImageError`] if the file cannot be read, is broken, or holds no such channels.
pub fn read_color(path: &Path) -> Result<ColorImage, ImageError> {
    match Format::of(path)? {
        #[cfg(feature = "exr")]
        Format::Exr => exr_read::read_color(path),
        Format::Png => png::read_color(path),
    }
}
