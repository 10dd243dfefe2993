//! The picture formats, told by extension.

use super::ImageError;
use std::path::Path;

/// A picture format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// OpenEXR: linear, every layer.
    #[cfg(feature = "exr")]
    Exr,
    /// PNG: 8 bits a channel, sRGB.
    Png,
}

impl Format {
    /// The format that the extension of `path` names, in upper or lower case.
    ///
    /// # Errors
    /// [`ImageError::UnknownExtension`] if it names none.
    pub fn of(path: &Path) -> Result<Format, ImageError> {
        match path.extension().map(std::ffi::OsStr::to_ascii_lowercase) {
            #[cfg(feature = "exr")]
            Some(e) if e == "exr" => Ok(Format::Exr),
            Some(e) if e == "png" => Ok(Format::Png),
            _ => Err(ImageError::UnknownExtension { path: path.to_owned() }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extension_decides_whatever_its_case() {
        #[cfg(feature = "exr")]
        assert_eq!(Format::of(Path::new("a/b.exr")).unwrap(), Format::Exr);
        assert_eq!(Format::of(Path::new("a/b.c.PnG")).unwrap(), Format::Png);
        for path in ["", "exr", ".exr", "a.jpg", "a.exr/b", "/"] {
            assert!(Format::of(Path::new(path)).is_err(), "{path}");
        }
    }
}
