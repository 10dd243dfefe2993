//! What a file says that a material is, before its textures are read.

use super::material::{
    BumpMap, Channel, Maps, Material, NormalMap, Opacity, Principled, Reflectance,
};
use super::obj::texture_map::TextureMap;
use super::texture::{CoordinateSet, Texture, TextureFilter, TextureId};
use glam::Vec3;
use std::path::PathBuf;

/// The channel of opacity.
const ALPHA: u32 = 3;
/// That of how strong a grain is.
const STRENGTH: u32 = 2;

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
    /// Where it lies on the surface.
    pub map: TextureMap,
    /// The texture coordinates that it takes.
    pub set: CoordinateSet,
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
    /// What the colour of a principled material is multiplied by.
    BaseColour,
    /// The share of a coat, in one of its channels.
    Coat(u32),
    /// Its roughness, in one of its channels.
    CoatRoughness(u32),
    /// Its normals, whose slopes are multiplied by this.
    CoatNormal(f32),
    /// The colour of sheen.
    Sheen,
    /// Its roughness, in one of its channels.
    SheenRoughness(u32),
    /// The share of light that passes, in one of its channels.
    Transmission(u32),
    /// The share of light that is reflected straight on, in one of its channels.
    Specular(u32),
    /// The colour of that light.
    SpecularColour,
    /// Where a grain runs, and how strong it is.
    Grain,
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
            slot => slot.put(texture, &mut principled.maps),
        }
        Material::Principled(principled)
    }

    /// Puts the texture where it belongs among those of a principled material.
    pub(super) fn put(self, texture: TextureId, maps: &mut Maps) {
        let share = |channel: u32| Some(Channel { texture, channel });
        match self {
            Self::Colour | Self::BaseColour => maps.base_colour = Some(texture),
            Self::Roughness(channel) => maps.roughness = share(channel),
            Self::Metallic(channel) => maps.metallic = share(channel),
            Self::Normal(scale) => maps.normal = Some(NormalMap { texture, scale }),
            Self::Bump(height) => maps.bump = Some(BumpMap { texture, height }),
            Self::Emission => maps.emission = Some(texture),
            Self::Coat(channel) => maps.coat = share(channel),
            Self::CoatRoughness(channel) => maps.coat_roughness = share(channel),
            Self::CoatNormal(scale) => maps.coat_normal = Some(NormalMap { texture, scale }),
            Self::Sheen => maps.sheen = Some(texture),
            Self::SheenRoughness(channel) => maps.sheen_roughness = share(channel),
            Self::Transmission(channel) => maps.transmission = share(channel),
            Self::Specular(channel) => maps.specular = share(channel),
            Self::SpecularColour => maps.specular_colour = Some(texture),
            Self::Grain => maps.anisotropy = Some(texture),
        }
    }

    /// The material with the mean of this texture, for want of texture coordinates.
    pub(super) fn with_mean(self, material: Material, texture: &Texture) -> Material {
        let colour = || Reflectance::Colour(texture.mean());
        let Material::Principled(mut principled) = material else {
            return material.with_reflectance(colour());
        };
        if self == Self::Colour {
            return material.with_reflectance(colour());
        }
        self.multiply_by_mean(texture, &mut principled);
        Material::Principled(principled)
    }

    /// Multiplies what the texture says of a principled material by the mean of that.
    pub(super) fn multiply_by_mean(self, texture: &Texture, principled: &mut Principled) {
        let mean = |channel: u32| texture.mean_code(channel as usize);
        match self {
            Self::Colour | Self::BaseColour => {
                principled.base_colour *= texture.mean();
                if let Opacity::Mask { alpha, .. } | Opacity::Blend { alpha } =
                    &mut principled.opacity
                {
                    *alpha *= mean(ALPHA);
                }
            }
            Self::Roughness(channel) => principled.roughness *= mean(channel),
            Self::Metallic(channel) => principled.metallic *= mean(channel),
            Self::Normal(_) | Self::Bump(_) | Self::CoatNormal(_) => {}
            Self::Emission => principled.emission *= texture.mean_emission(),
            Self::Coat(channel) => principled.coat *= mean(channel),
            Self::CoatRoughness(channel) => principled.coat_roughness *= mean(channel),
            Self::Sheen => principled.sheen *= texture.mean(),
            Self::SheenRoughness(channel) => principled.sheen_roughness *= mean(channel),
            Self::Transmission(channel) => principled.transmission *= mean(channel),
            Self::Specular(channel) => {
                principled.specular *= mean(channel);
                principled.f90 *= mean(channel);
            }
            Self::SpecularColour => principled.specular *= texture.mean(),
            Self::Grain => principled.anisotropy.strength *= mean(STRENGTH),
        }
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
