//! A picture of colours in memory.

use crate::film::Film;
use glam::Vec3;

/// A picture, linear Rec.709.
#[derive(Clone, Debug, PartialEq)]
pub struct ColorImage {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// `width * height` colours, row by row from the top.
    pub pixels: Vec<Vec3>,
}

impl ColorImage {
    /// The picture of a film: the filtered one, if there is one, else its radiance.
    pub fn from_film(film: &Film) -> Self {
        Self { width: film.width, height: film.height, pixels: film.best() }
    }
}
