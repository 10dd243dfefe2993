//! What a file says that a material is, before its texture is read.

use super::material::Material;
use std::path::PathBuf;

/// What a file says that a material is.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum MaterialRule {
    /// Not there: its triangles are left out.
    Null,
    /// Diffuse, with the picture in this file as its reflectance.
    Textured(PathBuf),
    /// All that it is.
    Plain(Material),
}
