//! What a file says that a material is, before its texture is read.

use super::material::Material;
use super::obj::texture_map::TextureMap;
use glam::Vec3;
use std::path::PathBuf;

/// What a file says that a material is.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum MaterialRule {
    /// Not there: its triangles are left out.
    Null,
    /// With a picture as its colour.
    Textured(TexturedRule),
    /// All that it is.
    Plain(Material),
}

/// What a file says of a texture.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct TexturedRule {
    /// What the material is but for its colour.
    pub material: Material,
    /// The picture file.
    pub path: PathBuf,
    /// Where it lies on the surface.
    pub map: TextureMap,
    /// What takes its place if it cannot be read. By a scene file that is an error.
    pub otherwise: Option<Otherwise>,
}

/// What an MTL says besides a texture.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Otherwise {
    /// The MTL.
    pub mtl: PathBuf,
    /// The line that names the texture.
    pub line: usize,
    /// The colour of the material, linear Rec.709.
    pub reflectance: Vec3,
}
