//! Where a texture lies on a surface.

use glam::DVec2;

/// What is done to texture coordinates before a texture is looked up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::scene) struct TextureMap {
    /// They are multiplied by this,
    pub scale: DVec2,
    /// and then this is added.
    pub offset: DVec2,
}

impl Default for TextureMap {
    fn default() -> Self {
        Self { scale: DVec2::ONE, offset: DVec2::ZERO }
    }
}

impl TextureMap {
    /// The texture coordinates at which the texture is looked up.
    pub(super) fn of(&self, coordinates: DVec2) -> DVec2 {
        coordinates * self.scale + self.offset
    }
}
