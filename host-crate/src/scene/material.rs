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
    /// Paint, metal or rough glass, and mixtures of them; see [`Principled`].
    Principled(Principled),
}

/// What most surfaces are made of: glTF's metallic-roughness material with an index of refraction
/// and transmission. Both sides are alike, but for light that passes: the medium is behind the
/// front.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Principled {
    /// Colour of paint, of metal and of light that passes, linear Rec.709, each component in [0,
    /// 1].
    pub base_colour: Vec3,
    /// Share of metal, in [0, 1].
    pub metallic: f32,
    /// Roughness, in [0, 1]: the root of the microfacets' slope. What is below 0.032 counts as
    /// that.
    pub roughness: f32,
    /// Index of refraction of what is no metal, in [0.01, 100]: how much a painted surface
    /// reflects, and how glass refracts.
    pub ior: f32,
    /// What reflection by the index of refraction is multiplied by at normal incidence, linear
    /// Rec.709, each component in [0, 1e4]; white for a surface as physics has it. Glass
    /// (`transmission`) is not tinted so.
    pub specular: Vec3,
    /// Share of what is no metal that lets light pass as rough glass does, in [0, 1].
    pub transmission: f32,
    /// Radiance of the front, the same in all directions; each component in [0, 1e12].
    pub emission: Vec3,
    /// What varies over the surface.
    pub maps: Maps,
}

/// The textures of a principled material. What a texture says is multiplied by the number that the
/// material has without it. All meshes of a material with any texture have texture coordinates.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Maps {
    /// Of the base's colour, as sRGB.
    pub base_colour: Option<TextureId>,
    /// Of the roughness.
    pub roughness: Option<Channel>,
    /// Of the share of metal.
    pub metallic: Option<Channel>,
    /// Of shading normals.
    pub normal: Option<NormalMap>,
    /// Of the emission, as sRGB.
    pub emission: Option<TextureId>,
}

/// One channel of a texture, whose codes 0 to 255 stand for 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Channel {
    /// The texture.
    pub texture: TextureId,
    /// Red, green, blue or alpha: 0 to 3.
    pub channel: u32,
}

/// A texture of normals in the tangent space of texture coordinates: red along `u`, green along
/// `v`, blue along the surface's normal; codes 0 to 255 stand for -1 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalMap {
    /// The texture.
    pub texture: TextureId,
    /// What red and green are multiplied by, in [-1e4, 1e4].
    pub scale: f32,
}

impl Maps {
    /// All textures.
    pub fn textures(&self) -> impl Iterator<Item = TextureId> + use<> {
        let channels = [self.roughness, self.metallic].map(|map| map.map(|map| map.texture));
        let [roughness, metallic] = channels;
        let normal = self.normal.map(|map| map.texture);
        let colours = [self.base_colour, self.emission];
        colours.into_iter().chain([roughness, metallic, normal]).flatten()
    }
}

impl Principled {
    /// Paint of this `colour`, linear Rec.709, each component in [0, 1], and `roughness` in [0, 1].
    pub fn paint(colour: Vec3, roughness: f32) -> Self {
        Self {
            base_colour: colour,
            metallic: 0.0,
            roughness,
            ior: 1.5,
            specular: Vec3::ONE,
            transmission: 0.0,
            emission: Vec3::ZERO,
            maps: Maps::default(),
        }
    }

    /// Metal that reflects this `colour` at normal incidence, linear Rec.709, each component in
    /// [0, 1], of a `roughness` in [0, 1].
    pub fn metal(colour: Vec3, roughness: f32) -> Self {
        Self { metallic: 1.0, ..Self::paint(colour, roughness) }
    }

    /// Clear glass of a `roughness` in [0, 1] and an index of refraction in [0.01, 100].
    pub fn glass(ior: f32, roughness: f32) -> Self {
        Self { transmission: 1.0, ior, ..Self::paint(Vec3::ONE, roughness) }
    }
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

    /// The radiance of the front, linear Rec.709; zero for what does not emit.
    pub fn radiance(&self) -> Vec3 {
        match *self {
            Self::Emissive { radiance, .. } => radiance,
            Self::Principled(Principled { emission, .. }) => emission,
            Self::Diffuse { .. } | Self::Mirror { .. } | Self::Dielectric { .. } => Vec3::ZERO,
        }
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
