//! The size of a picture.

use super::bounds;

/// Picture size in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FilmSize {
    /// Width, at least 1.
    pub width: u32,
    /// Height, at least 1.
    pub height: u32,
}

impl Default for FilmSize {
    /// What is rendered of files that name no size: 800x600.
    fn default() -> Self {
        Self { width: 800, height: 600 }
    }
}

impl FilmSize {
    /// The size of a picture whose width is so many times its height, above 0: as wide as the
    /// default one.
    pub(super) fn of_aspect(aspect: f64) -> Self {
        let width = Self::default().width;
        let height =
            (f64::from(width) / aspect).round().clamp(1.0, f64::from(bounds::MAX_FILM_SIDE));
        Self { width, height: height as u32 }
    }

    /// A size of `width` by `height` pixels.
    ///
    /// # Errors
    /// A sentence that names the limit, if a side is zero, negative or too large.
    pub fn new(width: i64, height: i64) -> Result<Self, String> {
        let side =
            |name, value| bounds::film_side(value).map_err(|error| format!("the {name} {error}"));
        Ok(Self { width: side("width", width)?, height: side("height", height)? })
    }
}
