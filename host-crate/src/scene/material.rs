//! What surfaces are made of.

use super::metal::Conductor;
use super::texture::TextureId;
use glam::Vec3;
use raystream_shaders::math::exact::ln;

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
    /// What metal it is, if that is known better than by its colour, with reflection by Fresnel's
    /// equations: then `metallic` is 1, and the colour is what it reflects straight on.
    pub conductor: Option<Conductor>,
    /// Roughness, in [0, 1]: the root of the microfacets' slope. What is below 0.032 counts as
    /// that.
    pub roughness: f32,
    /// Whether it is rougher along a direction than across.
    pub anisotropy: Anisotropy,
    /// Index of refraction of what is no metal, in [0.01, 100]: how much a painted surface
    /// reflects, and how glass refracts. What is within 0.001 of 1 counts as 1.001: the microfacets
    /// of a boundary that bends nothing cannot be told from its directions.
    pub ior: f32,
    /// What reflection by the index of refraction is multiplied by at normal incidence, linear
    /// Rec.709, each component in [0, 1e4]; white for a surface as physics has it. Glass
    /// (`transmission`) is not tinted so.
    pub specular: Vec3,
    /// Share of what is no metal that lets light pass as rough glass does, in [0, 1].
    pub transmission: f32,
    /// Whether what passes does not enter a body, but leaves through a second surface right behind
    /// the first: panes, soap bubbles, leaves. It is not bent then.
    pub thin_walled: bool,
    /// What the body behind the front takes of light on its way; `None` for what is clear. It has
    /// no effect where there is no [body](Material::body).
    pub attenuation: Option<Attenuation>,
    /// Where bodies overlap, that of the highest priority is there, in [-1000, 1000], and the
    /// index of refraction is absolute. `None`: it is there in whatever it is entered from, and the
    /// index is relative to that, unless that has a priority. It needs a [body](Material::body).
    pub priority: Option<i32>,
    /// Share of the surface that has a clear coat of index of refraction 1.5, in [0, 1].
    pub coat: f32,
    /// Roughness of the coat, in [0, 1].
    pub coat_roughness: f32,
    /// Colour of fibres that stand off the surface below the coat, as on velvet, linear Rec.709,
    /// each component in [0, 1]; black for none.
    pub sheen: Vec3,
    /// Roughness of the sheen, in [0, 1]. What is below 0.2 counts as that.
    pub sheen_roughness: f32,
    /// Where there is a surface at all. What emits is opaque.
    pub opacity: Opacity,
    /// Radiance of the front, the same in all directions; each component in [0, 1e12].
    pub emission: Vec3,
    /// What varies over the surface.
    pub maps: Maps,
}

/// How a surface is rougher along a direction than across, as brushed metal is. It takes texture
/// coordinates, which say what is along; without them it has no effect, and none on light that
/// passes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Anisotropy {
    /// How much, in [0, 1]; 0 for not at all. The slope across is the square of the roughness, that
    /// along it is nearer to 1 by the square of this (glTF's `KHR_materials_anisotropy`).
    pub strength: f32,
    /// The direction that it is rougher along, in degrees from where `u` grows towards where `v`
    /// grows, in [-1e5, 1e5].
    pub rotation: f32,
}

/// What light loses in a body, by Beer's law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Attenuation {
    /// What is left of white light after the distance, linear Rec.709, each component in [0, 1];
    /// less than 1e-6 counts as that.
    pub colour: Vec3,
    /// The distance, in world units, from 1e-12 to 1e12.
    pub distance: f32,
}

impl Attenuation {
    /// What is lost by world unit, linear Rec.709.
    pub fn absorption(&self) -> Vec3 {
        let left = self.colour.max(Vec3::splat(1e-6));
        // That of systems' libraries differs between them in its last bit.
        left.map(|part| -ln(part)) / self.distance
    }
}

/// Where a surface is, and where it has holes. The alpha of the texture of the base's colour, if
/// there is one, multiplies that which stands here.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Opacity {
    /// Everywhere, whatever a texture says.
    #[default]
    Opaque,
    /// Where `alpha` is at least `cutoff`, both in [0, 1].
    Mask {
        /// The share.
        alpha: f32,
        /// The least share of what is no hole.
        cutoff: f32,
    },
    /// In the share `alpha`, in [0, 1], of what is smaller than anything that is seen.
    Blend {
        /// The share.
        alpha: f32,
    },
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
    /// Of heights, in place of normals.
    pub bump: Option<BumpMap>,
    /// Of the emission, as sRGB.
    pub emission: Option<TextureId>,
    /// Of the coat.
    pub coat: Option<Channel>,
    /// Of the coat's roughness.
    pub coat_roughness: Option<Channel>,
    /// Of the coat's normals. Those of what is below (`normal`, `bump`) do not bend the coat.
    pub coat_normal: Option<NormalMap>,
    /// Of the sheen's colour, as sRGB.
    pub sheen: Option<TextureId>,
    /// Of the sheen's roughness.
    pub sheen_roughness: Option<Channel>,
    /// Of the share of light that passes.
    pub transmission: Option<Channel>,
    /// Of `specular`, a share.
    pub specular: Option<Channel>,
    /// Of `specular`, a colour, as sRGB.
    pub specular_colour: Option<TextureId>,
    /// Of the anisotropy: red and green are the direction of the grain in the tangent space of
    /// texture coordinates, codes 0 to 255 standing for -1 to 1, which its rotation turns; blue
    /// multiplies its strength.
    pub anisotropy: Option<TextureId>,
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

/// A texture of heights, by which a surface is shaded: the mean of red, green and blue, linear,
/// where codes stand for 0 to 1. It becomes a map of normals of the same texels, by the differences
/// of those on both sides. Its texture repeats or clamps.
///
/// How steep it is follows from how large the texture lies on the surfaces of the material, in the
/// mean over their area: where it lies larger it is as steep, and its heights are larger, too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BumpMap {
    /// The texture.
    pub texture: TextureId,
    /// How high above 0 the surface is where the texture is 1, in world units (of a shape that has
    /// instances, in its own), in [-1e4, 1e4].
    pub height: f32,
}

impl Maps {
    /// All textures.
    pub fn textures(&self) -> impl Iterator<Item = TextureId> + use<> {
        let shares = self.shares().map(|map| map.map(|map| map.texture));
        let normals = [self.normal, self.coat_normal].map(|map| map.map(|map| map.texture));
        let bump = self.bump.map(|map| map.texture);
        let colours = [self.base_colour, self.emission, self.sheen, self.specular_colour];
        let others = [bump, self.anisotropy];
        colours.into_iter().chain(shares).chain(normals).chain(others).flatten()
    }

    /// Those that say one number each.
    pub(super) fn shares(&self) -> [Option<Channel>; 7] {
        [
            self.roughness,
            self.metallic,
            self.coat,
            self.coat_roughness,
            self.sheen_roughness,
            self.transmission,
            self.specular,
        ]
    }

    /// Whether kernels need the ability
    /// [`LAYER_MAPS`](raystream_shaders::scene::abilities::LAYER_MAPS) for them.
    pub(crate) fn has_layers(&self) -> bool {
        let usual = Self {
            base_colour: self.base_colour,
            roughness: self.roughness,
            metallic: self.metallic,
            normal: self.normal,
            bump: self.bump,
            emission: self.emission,
            ..Self::default()
        };
        *self != usual
    }

    /// The texture in whose tangent space the normals and the grain of a surface are; none for that
    /// of its first texture coordinates.
    pub(crate) fn tangent_space(&self) -> Option<TextureId> {
        let normals = self.normal.map(|map| map.texture);
        let bumps = self.bump.map(|map| map.texture);
        let coat = self.coat_normal.map(|map| map.texture);
        normals.or(bumps).or(coat).or(self.anisotropy)
    }
}

impl Principled {
    /// Whether anything lies over it: a coat or sheen.
    pub fn has_cover(&self) -> bool {
        self.coat > 0.0 || self.sheen != Vec3::ZERO
    }

    /// Whether it has a coat whose normal may be another than that of what is below.
    pub(crate) fn has_coat_normal(&self) -> bool {
        let Maps { normal, bump, coat_normal, .. } = self.maps;
        self.coat > 0.0 && (normal.or(coat_normal).is_some() || bump.is_some())
    }

    /// Whether its surface bounds a body: light passes, enters, and finds no holes.
    fn has_body(&self) -> bool {
        let is_whole = match self.opacity {
            Opacity::Opaque => true,
            Opacity::Mask { alpha, cutoff } => alpha >= cutoff && self.maps.base_colour.is_none(),
            Opacity::Blend { alpha } => alpha == 1.0 && self.maps.base_colour.is_none(),
        };
        self.transmission > 0.0 && !self.thin_walled && is_whole
    }

    /// Paint of this `colour`, linear Rec.709, each component in [0, 1], and `roughness` in [0, 1].
    pub fn paint(colour: Vec3, roughness: f32) -> Self {
        Self {
            base_colour: colour,
            metallic: 0.0,
            conductor: None,
            roughness,
            anisotropy: Anisotropy::default(),
            ior: 1.5,
            specular: Vec3::ONE,
            transmission: 0.0,
            thin_walled: false,
            attenuation: None,
            priority: None,
            coat: 0.0,
            coat_roughness: 0.0,
            sheen: Vec3::ZERO,
            sheen_roughness: 0.5,
            opacity: Opacity::Opaque,
            emission: Vec3::ZERO,
            maps: Maps::default(),
        }
    }

    /// Metal that reflects this `colour` at normal incidence, linear Rec.709, each component in
    /// [0, 1], of a `roughness` in [0, 1].
    pub fn metal(colour: Vec3, roughness: f32) -> Self {
        Self { metallic: 1.0, ..Self::paint(colour, roughness) }
    }

    /// Metal of this index of refraction, of a `roughness` in [0, 1].
    pub fn conductor(conductor: Conductor, roughness: f32) -> Self {
        let colour = conductor.normal_reflectance();
        Self { conductor: Some(conductor), ..Self::metal(colour, roughness) }
    }

    /// Clear glass of a `roughness` in [0, 1] and an index of refraction in [0.01, 100].
    pub fn glass(ior: f32, roughness: f32) -> Self {
        Self { transmission: 1.0, ior, ..Self::paint(Vec3::ONE, roughness) }
    }
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
