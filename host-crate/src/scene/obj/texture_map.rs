//! Where a texture lies on a surface.

use crate::scene::texture::{CoordinateSet, Placement};
use glam::{DMat2, DVec2};

/// What is done to texture coordinates before a texture is looked up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::scene) struct TextureMap {
    /// They are multiplied by this,
    pub scale: DVec2,
    /// then turned so far, in radians, from the first axis to the second,
    pub rotation: f64,
    /// and then this is added.
    pub offset: DVec2,
}

/// How texture coordinates lie on a surface, and which of them are wanted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(in crate::scene) struct Laid {
    /// What is done to the first ones.
    pub map: TextureMap,
    /// Whether a texture takes the second ones, which lie as the file says.
    pub takes_second: bool,
}

impl Default for TextureMap {
    fn default() -> Self {
        Self { scale: DVec2::ONE, rotation: 0.0, offset: DVec2::ZERO }
    }
}

impl TextureMap {
    /// The texture coordinates at which the texture is looked up.
    pub(super) fn of(&self, coordinates: DVec2) -> DVec2 {
        let scaled = coordinates * self.scale;
        if self.rotation == 0.0 {
            return scaled + self.offset;
        }
        DVec2::from_angle(self.rotation).rotate(scaled) + self.offset
    }

    /// The same, for a texture of this `set` of coordinates to do that itself.
    pub(in crate::scene) fn placement(&self, set: CoordinateSet) -> Placement {
        let matrix = DMat2::from_angle(self.rotation) * DMat2::from_diagonal(self.scale);
        Placement { set, matrix: matrix.as_mat2(), offset: self.offset.as_vec2() }
    }
}
