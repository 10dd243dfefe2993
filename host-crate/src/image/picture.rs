//! Pictures of any tool, read.

use super::read::read_file;
use super::{ColorImage, Format, ImageError, png};
use std::path::Path;

/// A picture of some tool, and what its file says of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// The colours.
    pub colors: ColorImage,
    /// What their numbers are.
    pub values: Values,
    /// What a reader of the numbers should know, each as the rest of a sentence that the file
    /// begins: that colours were converted, or that pixels are missing.
    pub remarks: Vec<String>,
}

/// What the numbers of a picture are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Values {
    /// Radiances, of any size.
    Radiance,
    /// What a display shows, from 0 to 1: of radiances it cuts off or compresses the bright ones.
    Display,
}

/// Reads the colours of a picture of any tool as linear Rec. 709: an `.exr` converted from the
/// primaries that it has, a `.png` decoded from sRGB.
///
/// Of an EXR file it takes the channels R, G, B, or else luminance Y with the chroma channels RY
/// and BY, or alone; or those of a layer (`layer.R` ...), preferring one that is named as the
/// picture usually is (`color`, `beauty`, `combined` ...); half, float or integer, scan lines or
/// tiles. The picture is the display window: pixels outside it are left out, those that the file
/// has not are 0. Transparency is ignored.
///
/// # Errors
/// [`ImageError`] if the file cannot be read, is broken, or holds no such channels.
pub fn read_picture(path: &Path) -> Result<Picture, ImageError> {
    // Before a file is read whose format is none.
    Format::of(path)?;
    decode_picture(path, &read_file(path)?)
}

/// As [`read_picture`], of a file that is in memory: the extension of `path` is its format, and
/// errors name it so.
///
/// # Errors
/// As [`read_picture`].
pub fn decode_picture(path: &Path, file: &[u8]) -> Result<Picture, ImageError> {
    match Format::of(path)? {
        #[cfg(feature = "exr")]
        Format::Exr => super::openexr::decode_color(path, file),
        Format::Png => png::decode_color(path, file),
    }
}

/// As [`read_picture`], the colours alone.
///
/// # Errors
/// As [`read_picture`].
pub fn read_color(path: &Path) -> Result<ColorImage, ImageError> {
    Ok(read_picture(path)?.colors)
}
