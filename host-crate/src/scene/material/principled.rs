//! What most surfaces are made of.

use super::maps::Maps;
use crate::scene::metal::Conductor;
use glam::Vec3;
use raystream_shaders::math::exact::ln;

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
    /// Share of light that the surface reflects at grazing angles where it is no metal, in [0, 1]:
    /// 1 for a surface as physics has it. It has no effect on glass either.
    pub f90: f32,
    /// Share of what is no metal that lets light pass as rough glass does, in [0, 1].
    pub transmission: f32,
    /// Whether what passes does not enter a body, but leaves through a second surface right behind
    /// the first: panes, soap bubbles, leaves. It is not bent then.
    pub thin_walled: bool,
    /// What the body behind the front takes of light on its way; `None` for what is clear. It has
    /// no effect where there is no [body](super::Material::body).
    pub attenuation: Option<Attenuation>,
    /// Where bodies overlap, that of the highest priority is there, in [-1000, 1000], and the
    /// index of refraction is absolute. `None`: it is there in whatever it is entered from, and the
    /// index is relative to that, unless that has a priority. It needs a
    /// [body](super::Material::body).
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

impl Principled {
    /// Whether anything lies over it: a coat or sheen.
    pub fn has_cover(&self) -> bool {
        self.coat > 0.0 || self.sheen != Vec3::ZERO
    }

    /// Whether it has a coat whose normal may be another than that of what is below.
    pub(crate) fn has_coat_normal(&self) -> bool {
        self.coat > 0.0 && self.has_normal_map()
    }

    /// Whether it may reflect less than all light at grazing angles.
    pub(crate) fn has_f90(&self) -> bool {
        self.f90 != 1.0 || self.maps.specular.is_some()
    }

    /// Whether maps bend its normals.
    pub(crate) fn has_normal_map(&self) -> bool {
        let Maps { normal, bump, coat_normal, .. } = self.maps;
        normal.or(coat_normal).is_some() || bump.is_some()
    }

    /// Whether its surface bounds a body: light passes, enters, and finds no holes.
    pub(super) fn has_body(&self) -> bool {
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
            f90: 1.0,
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
