//! What surfaces are made of.

use super::texture::TextureId;
use glam::Vec3;

/// Names a material of a scene: its index in [`Scene::materials`](super::Scene::materials).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct MaterialId(pub u32);

/// What a surface is made of. Colours are linear Rec.709.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Material {
    /// Lambert's law, on both sides.
    Diffuse {
        /// The share of light that is reflected.
        reflectance: Reflectance,
    },
    /// An ideal mirror, on both sides, without a Fresnel term.
    Mirror {
        /// The share of light that is reflected, each component in [0, 1].
        reflectance: Vec3,
    },
    /// The smooth boundary between vacuum (front) and a medium such as glass (back). Fresnel's
    /// equations share light out between reflection and refraction.
    Dielectric {
        /// The medium's index of refraction, in [0.01, 100]; 1.5 for glass.
        ior: f32,
        /// What passes of the refracted light, each component in [0, 1].
        transmittance: Vec3,
        /// What remains of the reflected light, each component in [0, 1].
        reflectance: Vec3,
    },
    /// A lamp: emits from the front, and reflects by Lambert's law on both sides.
    Emissive {
        /// Radiance of the front, the same in all directions; each component in [0, 1e12].
        radiance: Vec3,
        /// The share of light that is reflected, each component in [0, 1].
        reflectance: Vec3,
    },
}

/// A reflectance: one colour, or a texture's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reflectance {
    /// Linear Rec.709, each component in [0, 1].
    Colour(Vec3),
    /// A texture of the scene; all meshes of the material have texture coordinates.
    Texture(TextureId),
}

impl Material {
    /// Lambert's law with one `reflectance`, linear Rec.709, each component in [0, 1].
    pub fn diffuse(reflectance: Vec3) -> Self {
        Self::Diffuse { reflectance: Reflectance::Colour(reflectance) }
    }

    /// Lambert's law with the reflectance of a texture.
    pub fn textured(texture: TextureId) -> Self {
        Self::Diffuse { reflectance: Reflectance::Texture(texture) }
    }

    /// An ideal mirror that reflects this share of light, linear Rec.709, each component in [0, 1].
    pub fn mirror(reflectance: Vec3) -> Self {
        Self::Mirror { reflectance }
    }

    /// Clear glass of this index of refraction, in [0.01, 100].
    pub fn glass(ior: f32) -> Self {
        Self::Dielectric { ior, transmittance: Vec3::ONE, reflectance: Vec3::ONE }
    }

    /// A lamp of this radiance, linear Rec.709, that reflects nothing.
    pub fn emissive(radiance: Vec3) -> Self {
        Self::Emissive { radiance, reflectance: Vec3::ZERO }
    }

    /// The radiance of the front, linear Rec.709; zero for all but lamps.
    pub fn radiance(&self) -> Vec3 {
        match *self {
            Self::Emissive { radiance, .. } => radiance,
            Self::Diffuse { .. } | Self::Mirror { .. } | Self::Dielectric { .. } => Vec3::ZERO,
        }
    }

    /// Its texture, if it has one.
    pub fn texture(&self) -> Option<TextureId> {
        match *self {
            Self::Diffuse { reflectance: Reflectance::Texture(texture) } => Some(texture),
            _ => None,
        }
    }
}
