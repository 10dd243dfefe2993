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

impl FilmSize {
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
