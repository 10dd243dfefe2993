//! What a file says that a material is, before its textures are read.

use super::material::{BumpMap, Channel, Material, NormalMap, Principled, Reflectance};
use super::obj::texture_map::TextureMap;
use super::texture::{Texture, TextureFilter, TextureId};
use glam::Vec3;
use std::path::PathBuf;

/// What a file says that a material is.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum MaterialRule {
    /// Not there: its triangles are left out.
    Null,
    /// With pictures.
    Textured(TexturedRule),
    /// All that it is.
    Plain(Material),
}

/// What a file says of a material with textures.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct TexturedRule {
    /// What the material is without them.
    pub material: Material,
    /// The textures.
    pub textures: Vec<TextureFile>,
    /// Where they lie on the surface.
    pub map: TextureMap,
    /// What takes the place of those that cannot be read. By a scene file that is an error.
    pub otherwise: Option<Otherwise>,
}

/// A texture that a file names.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct TextureFile {
    /// What it says.
    pub slot: Slot,
    /// The line of an MTL that names it; 0 in a scene file.
    pub line: usize,
    /// The picture.
    pub path: PathBuf,
    /// What is seen between texels.
    pub filter: TextureFilter,
}

/// What a texture says of a material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Slot {
    /// The colour, in place of that of the material.
    Colour,
    /// The roughness, in one of its channels.
    Roughness(u32),
    /// The share of metal, in one of its channels.
    Metallic(u32),
    /// Shading normals, whose slopes are multiplied by this.
    Normal(f32),
    /// Heights, and how high 1 is.
    Bump(f32),
    /// What the emission is multiplied by.
    Emission,
}

/// What an MTL says besides textures.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Otherwise {
    /// The MTL.
    pub mtl: PathBuf,
    /// The colour of the material, linear Rec.709.
    pub reflectance: Vec3,
    /// Its emission, linear Rec.709.
    pub emission: Vec3,
}

impl Slot {
    /// The material with this texture.
    pub(super) fn with(self, material: Material, texture: TextureId) -> Material {
        let Material::Principled(mut principled) = material else {
            return material.with_reflectance(Reflectance::Texture(texture));
        };
        match self {
            Self::Colour => return material.with_reflectance(Reflectance::Texture(texture)),
            Self::Roughness(channel) => {
                principled.maps.roughness = Some(Channel { texture, channel });
            }
            Self::Metallic(channel) => {
                principled.maps.metallic = Some(Channel { texture, channel });
            }
            Self::Normal(scale) => principled.maps.normal = Some(NormalMap { texture, scale }),
            Self::Bump(height) => principled.maps.bump = Some(BumpMap { texture, height }),
            Self::Emission => principled.maps.emission = Some(texture),
        }
        Material::Principled(principled)
    }

    /// The material with the mean of this texture, for want of texture coordinates.
    pub(super) fn with_mean(self, material: Material, texture: &Texture) -> Material {
        let colour = || Reflectance::Colour(texture.mean());
        let Material::Principled(principled) = material else {
            return material.with_reflectance(colour());
        };
        Material::Principled(match self {
            Self::Colour => return material.with_reflectance(colour()),
            Self::Roughness(channel) => {
                let roughness = principled.roughness * texture.mean_code(channel as usize);
                Principled { roughness, ..principled }
            }
            Self::Metallic(channel) => {
                let metallic = principled.metallic * texture.mean_code(channel as usize);
                Principled { metallic, ..principled }
            }
            Self::Normal(_) | Self::Bump(_) => principled,
            Self::Emission => {
                let emission = principled.emission * texture.mean_emission();
                Principled { emission, ..principled }
            }
        })
    }

    /// The material as it is where the texture of an MTL cannot be read.
    pub(super) fn without(self, material: Material, otherwise: &Otherwise) -> Material {
        match (self, material) {
            (Self::Emission, Material::Principled(principled)) => {
                Material::Principled(Principled { emission: otherwise.emission, ..principled })
            }
            (Self::Colour, _) => {
                material.with_reflectance(Reflectance::Colour(otherwise.reflectance))
            }
            _ => material,
        }
    }
}
