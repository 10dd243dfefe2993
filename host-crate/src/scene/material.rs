//! What surfaces are made of.

mod maps;
mod principled;

pub use maps::{BumpMap, Channel, Maps, NormalMap};
pub use principled::{Anisotropy, Attenuation, Opacity, Principled};

use super::texture::TextureId;
use glam::Vec3;

/// Names a material of a scene: its index in [`Scene::materials`](super::Scene::materials).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct MaterialId(pub u32);

/// What a surface is made of. Colours are linear Rec.709.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "a scene has few of them, which are copied freely")]
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
        /// What the medium takes of light on its way; `None` for what is clear.
        attenuation: Option<Attenuation>,
        /// See [`Principled::priority`].
        priority: Option<i32>,
    },
    /// A lamp: emits from the front, and reflects by Lambert's law on both sides.
    Emissive {
        /// Radiance of the front, the same in all directions; each component in [0, 1e12].
        radiance: Vec3,
        /// The share of light that is reflected, each component in [0, 1].
        reflectance: Vec3,
    },
    /// Paint, metal or rough glass, and mixtures of them; see [`Principled`].
    Principled(Principled),
}

/// What is behind the fronts of a closed surface that light enters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// Index of refraction.
    pub ior: f32,
    /// What it takes of light by world unit, linear Rec.709.
    pub absorption: Vec3,
    /// See [`Principled::priority`].
    pub priority: Option<i32>,
    /// Whether its boundary may be rough.
    pub is_rough: bool,
}

impl Body {
    /// What bodies are sorted by: those without a priority first.
    pub(crate) fn key(&self) -> (Option<i32>, [u32; 4], bool) {
        let Vec3 { x, y, z } = self.absorption;
        (self.priority, [self.ior, x, y, z].map(f32::to_bits), self.is_rough)
    }
}

/// An index of refraction as kernels have it of boundaries that may be rough.
pub(crate) fn distinct_ior(ior: f32) -> f32 {
    const LEAST: f32 = 1e-3;
    if (ior - 1.0).abs() < LEAST { 1.0 + LEAST } else { ior }
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
        let (attenuation, priority) = (None, None);
        Self::Dielectric {
            ior,
            transmittance: Vec3::ONE,
            reflectance: Vec3::ONE,
            attenuation,
            priority,
        }
    }

    /// A lamp of this radiance, linear Rec.709, that reflects nothing.
    pub fn emissive(radiance: Vec3) -> Self {
        Self::Emissive { radiance, reflectance: Vec3::ZERO }
    }

    /// The radiance of the front, linear Rec.709; zero for what does not emit.
    pub fn radiance(&self) -> Vec3 {
        match *self {
            Self::Emissive { radiance, .. } => radiance,
            Self::Principled(Principled { emission, .. }) => emission,
            Self::Diffuse { .. } | Self::Mirror { .. } | Self::Dielectric { .. } => Vec3::ZERO,
        }
    }

    /// The principled material that it is; none for others.
    pub fn principled(&self) -> Option<&Principled> {
        match self {
            Self::Principled(principled) => Some(principled),
            _ => None,
        }
    }

    /// The body that it bounds: glass and water, smooth or rough, without holes.
    pub fn body(&self) -> Option<Body> {
        let (ior, attenuation, priority, is_rough) = match *self {
            Self::Dielectric { ior, attenuation, priority, .. } => {
                (ior, attenuation, priority, false)
            }
            Self::Principled(ref p) if p.has_body() => (p.ior, p.attenuation, p.priority, true),
            _ => return None,
        };
        let absorption = attenuation.map_or(Vec3::ZERO, |attenuation| attenuation.absorption());
        Some(Body { ior, absorption, priority, is_rough })
    }

    /// Whether it may have holes, by the alpha of its texture too.
    pub fn has_holes(&self) -> bool {
        self.principled().is_some_and(|principled| principled.opacity != Opacity::Opaque)
    }

    /// Whether [colours of vertices](super::Mesh::colours) multiply its own: that of paint, plastic,
    /// glass of any roughness, of metal that is known by its colour, and of what a lamp reflects.
    pub fn takes_colours(&self) -> bool {
        match self {
            Self::Diffuse { .. } | Self::Emissive { .. } => true,
            Self::Principled(principled) => principled.conductor.is_none(),
            Self::Mirror { .. } | Self::Dielectric { .. } => false,
        }
    }

    /// Whether it is rougher along a direction than across.
    pub fn has_grain(&self) -> bool {
        self.principled().is_some_and(|principled| principled.anisotropy.strength > 0.0)
    }

    /// Whether [tangents](super::Mesh::tangents) count: for a map of normals, or for a grain.
    pub fn takes_tangents(&self) -> bool {
        let has_normals = |p: &Principled| p.maps.normal.or(p.maps.coat_normal).is_some();
        self.has_grain() || self.principled().is_some_and(has_normals)
    }

    /// Whether it has a bump map.
    pub(crate) fn has_bumps(&self) -> bool {
        self.principled().is_some_and(|principled| principled.maps.bump.is_some())
    }

    /// The same material with another colour of paint or metal; others have none to change.
    pub fn with_reflectance(self, reflectance: Reflectance) -> Self {
        match self {
            Self::Diffuse { .. } => Self::Diffuse { reflectance },
            Self::Principled(principled) => {
                let (base_colour, texture) = match reflectance {
                    Reflectance::Colour(colour) => (colour, None),
                    Reflectance::Texture(texture) => (Vec3::ONE, Some(texture)),
                };
                let maps = Maps { base_colour: texture, ..principled.maps };
                Self::Principled(Principled { base_colour, maps, ..principled })
            }
            Self::Mirror { .. } | Self::Dielectric { .. } | Self::Emissive { .. } => self,
        }
    }

    /// Its textures.
    pub fn textures(&self) -> impl Iterator<Item = TextureId> + use<> {
        let (own, maps) = match *self {
            Self::Diffuse { reflectance: Reflectance::Texture(texture) } => {
                (Some(texture), Maps::default())
            }
            Self::Principled(principled) => (None, principled.maps),
            _ => (None, Maps::default()),
        };
        own.into_iter().chain(maps.textures())
    }
}
