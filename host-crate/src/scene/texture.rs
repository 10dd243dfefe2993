//! Pictures on surfaces.

/// Names a texture of a scene: its index in [`Scene::textures`](super::Scene::textures).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct TextureId(pub u32);

/// A picture of reflectances, which repeats in both directions.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Texture {
    /// Width in texels, from 1 to 16384.
    pub width: u32,
    /// Height in texels, from 1 to 16384.
    pub height: u32,
    /// Red, green, blue (sRGB) and a fourth value that has no effect, for each texel, row by row
    /// from the top: `width * height` of them.
    pub texels: Vec<[u8; 4]>,
}
