//! The principled material: paint, metal and rough glass in one record.
//!
//! A mixture, by `metallic` and `transmission`, of three: a metal, a diffuse base under a smooth or
//! rough dielectric surface, and the rough boundary of a dielectric. It is what glTF 2.0 calls
//! metallic-roughness with `KHR_materials_ior` and `KHR_materials_transmission`, and a part of
//! OpenPBR.
//!
//! Its lobes are
//!
//! - *surface*: reflection by microfacets ([`Ggx`]) with Schlick's Fresnel term;
//! - *base*: what follows the cosine: the diffuse base, by the share that the surface lets pass on
//!   both ways, and what light has been reflected by several microfacets. Both are those of Kulla
//!   and Conty, "Revisiting Physically Based Shading at Imageworks", 2017: nothing is lost, and
//!   both directions are worth the same;
//! - *boundary*: reflection and refraction by the microfacets of a dielectric (Walter et al. 2007)
//!   with Fresnel's equations. Light that several microfacets would deflect is lost.

use super::BsdfSample;
use super::albedo::AlbedoView;
use super::dielectric::fresnel;
use super::ggx::Ggx;
use crate::glam::{UVec4, Vec2, Vec3, Vec4};
use crate::math::{sample_cosine_hemisphere, tangent_frame};
use crate::memory::device_struct;
use crate::memory::rows::{float, vector};
use crate::scene::texture::{NO_TEXTURE, TextureView};
use core::f32::consts::FRAC_1_PI;
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

/// Least cosine of a direction from which a surface is seen: at the horizon densities have no
/// digits.
const HORIZON: f32 = 1e-4;

device_struct! {
    /// What the principled material has beside [`Material`](super::Material). 48 bytes.
    pub struct Layers {
        /// Share of reflection at normal incidence that a dielectric surface has, as a factor of
        /// what its index of refraction says, linear Rec.709.
        pub specular: Vec3,
        /// Share of metal, in [0, 1].
        pub metallic: f32,
        /// Roughness, in [0, 1]; see [`Ggx::of_roughness`].
        pub roughness: f32,
        /// Share of light that the base lets pass rather than reflects diffusely, in [0, 1].
        pub transmission: f32,
        /// The texture that multiplies the roughness, or
        /// [`NO_TEXTURE`].
        pub roughness_map: u32,
        /// The texture that multiplies the share of metal, or [`NO_TEXTURE`].
        pub metallic_map: u32,
        /// The texture of normals, or [`NO_TEXTURE`].
        pub normal_map: u32,
        /// What that texture's slopes are multiplied by.
        pub normal_scale: f32,
        /// Which of its texture's channels, 0 to 3, the roughness has, and, 8 bits further, the
        /// share of metal.
        pub channels: u32,
        /// The texture that multiplies the emission, or [`NO_TEXTURE`].
        pub emission_map: u32,
    }
}

impl Layers {
    /// Rows of one.
    pub const ROWS: u32 = 3;
    /// Those of other materials.
    pub const NONE: Self = Self {
        specular: Vec3::ONE,
        metallic: 0.0,
        roughness: 0.0,
        transmission: 0.0,
        roughness_map: NO_TEXTURE,
        metallic_map: NO_TEXTURE,
        normal_map: NO_TEXTURE,
        normal_scale: 1.0,
        channels: 0,
        emission_map: NO_TEXTURE,
    };

    /// Unpacks the three rows, which are the struct's memory.
    pub fn from_rows(rows: [UVec4; 3]) -> Self {
        Self {
            specular: vector(rows[0]),
            metallic: float(rows[0]),
            roughness: f32::from_bits(rows[1].x),
            transmission: f32::from_bits(rows[1].y),
            roughness_map: rows[1].z,
            metallic_map: rows[1].w,
            normal_map: rows[2].x,
            normal_scale: f32::from_bits(rows[2].y),
            channels: rows[2].z,
            emission_map: rows[2].w,
        }
    }

    /// The layers at a point, of these texture coordinates.
    pub fn textured(mut self, textures: &TextureView<'_>, uv: Vec2) -> Self {
        if self.roughness_map != NO_TEXTURE {
            let codes = textures.codes(self.roughness_map, uv.x, uv.y);
            self.roughness *= channel(codes, self.channels & 0xff);
        }
        if self.metallic_map != NO_TEXTURE {
            let codes = textures.codes(self.metallic_map, uv.x, uv.y);
            self.metallic *= channel(codes, self.channels >> 8 & 0xff);
        }
        self
    }

    /// What the map of normals says at a point, of these texture coordinates: its normal in tangent
    /// space, of any length.
    pub fn slopes(&self, textures: &TextureView<'_>, uv: Vec2) -> Vec3 {
        let codes = textures.codes(self.normal_map, uv.x, uv.y);
        let normal = Vec3::new(codes.x, codes.y, codes.z) * 2.0 - Vec3::ONE;
        Vec3::new(normal.x * self.normal_scale, normal.y * self.normal_scale, normal.z)
    }
}

/// The material at a point.
#[derive(Clone, Copy)]
pub struct Principled<'a> {
    /// Colour of the base, of the metal and of what passes, linear Rec.709 in [0, 1].
    pub colour: Vec3,
    /// The rest of it.
    pub layers: Layers,
    /// Index of refraction behind the front, relative to the outside.
    pub ior: f32,
    /// Tables of albedos.
    pub albedos: AlbedoView<'a>,
}

/// What microfacets with one Fresnel term reflect.
#[derive(Clone, Copy)]
struct Reflector {
    /// Reflectance at normal incidence.
    f0: Vec3,
    /// Reflectance, by several of them, of light that one has not let go, in the mean.
    several: Vec3,
}

/// How a direction sees the [table of albedos](super::albedo) at a roughness.
#[derive(Clone, Copy)]
struct Albedo {
    /// Factor of the reflectance at normal incidence.
    a: f32,
    /// What is reflected besides.
    b: f32,
    /// Share of light that is left for several reflections.
    missed: f32,
}

impl Albedo {
    fn new(pair: Vec2) -> Self {
        Self { a: pair.x, b: pair.y, missed: (1.0 - pair.x - pair.y).max(0.0) }
    }
}

impl Reflector {
    /// With several reflections by Fdez-Agüera, "A Multiple-Scattering Microfacet Model for
    /// Real-Time Image-based Lighting", JCGT 8(1), 2019: a geometric series of the mean.
    fn new(f0: Vec3, mean: Albedo) -> Self {
        let f_mean = f0 + (Vec3::ONE - f0) * (1.0 / 21.0);
        let several = f_mean * f_mean * (1.0 - mean.missed) / (Vec3::ONE - f_mean * mean.missed);
        Self { f0, several }
    }

    /// Reflectance of one microfacet that is seen under a `cosine` (Schlick 1994).
    fn schlick(&self, cosine: f32) -> Vec3 {
        let rest = 1.0 - cosine;
        let square = rest * rest;
        self.f0 + (Vec3::ONE - self.f0) * (square * square * rest)
    }

    /// What one reflection leaves of a direction's light.
    fn once(&self, albedo: Albedo) -> Vec3 {
        self.f0 * albedo.a + albedo.b
    }

    /// What gets past the microfacets.
    fn passes(&self, albedo: Albedo) -> Vec3 {
        Vec3::ONE - self.once(albedo) - self.several * albedo.missed
    }
}

/// The lobes as a direction `o` sees them.
struct Lobes {
    ggx: Ggx,
    /// Reflection by the surface, metal and dielectric together.
    surface: Reflector,
    /// Reflection by the dielectric surface over the base.
    over_base: Reflector,
    /// Albedo of the diffuse base.
    base: Vec3,
    /// What `o` sees.
    here: Albedo,
    mean: Albedo,
    /// Share of the material that is a boundary.
    boundary: f32,
    /// Index of refraction on the far side over that on `o`'s side.
    eta: f32,
    /// Probabilities of the lobes surface and base; the rest is the boundary's.
    chances: [f32; 2],
}

impl Principled<'_> {
    /// BSDF times cosine over density, and density per solid angle, of a `direction` that light
    /// comes from where the path arrived along `incoming`; `normal` is the shading normal on the
    /// side that it came from, `from_outside` says which side that is.
    #[inline(always)]
    pub fn eval(
        &self,
        normal: Vec3,
        from_outside: bool,
        incoming: Vec3,
        direction: Vec3,
    ) -> BsdfSample {
        let frame = Frame::new(normal);
        let o = frame.seen(incoming);
        let lobes = self.lobes(o, from_outside);
        self.evaluate(&lobes, o, frame.local(direction), direction)
    }

    /// A direction, by uniform numbers in [0, 1) for the direction (`u`) and for the choice of the
    /// `lobe`; the rest is as in [`Self::eval`].
    pub fn sample(
        &self,
        normal: Vec3,
        from_outside: bool,
        incoming: Vec3,
        u: [f32; 2],
        lobe: f32,
    ) -> BsdfSample {
        let frame = Frame::new(normal);
        let o = frame.seen(incoming);
        let lobes = self.lobes(o, from_outside);
        let [surface, base] = lobes.chances;
        let mut crosses = false;
        let i = if lobe < surface {
            (-o).reflect(lobes.ggx.sample_visible(o, u))
        } else if lobe < surface + base {
            sample_cosine_hemisphere(Vec3::Z, u)
        } else {
            let h = lobes.ggx.sample_visible(o, u);
            let rest = (lobe - surface - base) / (1.0 - surface - base).max(f32::MIN_POSITIVE);
            let cosine = o.dot(h).clamp(0.0, 1.0);
            crosses = rest >= dielectric_fresnel(cosine, lobes.eta);
            if crosses { refract(o, h, cosine, lobes.eta) } else { (-o).reflect(h) }
        };
        let i = i.normalize();
        let mut sample = self.evaluate(&lobes, o, i, frame.world(i));
        if crosses == (i.z >= 0.0) {
            // A single microfacet sends no light there.
            sample.weight = Vec3::ZERO;
        }
        // A density of 0 would stand for a delta distribution.
        sample.pdf = sample.pdf.max(f32::MIN_POSITIVE);
        sample
    }

    fn lobes(&self, o: Vec3, from_outside: bool) -> Lobes {
        let layers = &self.layers;
        let boundary = (1.0 - layers.metallic) * layers.transmission;
        let opaque = 1.0 - boundary;
        let metal = layers.metallic / opaque.max(f32::MIN_POSITIVE);
        let straight = (self.ior - 1.0) / (self.ior + 1.0);
        let here = Albedo::new(self.albedos.directional(layers.roughness, o.z));
        let mean = Albedo::new(self.albedos.mean(layers.roughness));
        let over_base =
            Reflector::new((layers.specular * (straight * straight)).min(Vec3::ONE), mean);
        let of_metal = Reflector::new(self.colour, mean);
        let surface = Reflector {
            f0: over_base.f0.lerp(of_metal.f0, metal),
            several: over_base.several.lerp(of_metal.several, metal),
        };
        let base = self.colour * (1.0 - metal);
        let once = surface.once(here).max_element() * opaque;
        let cosine = surface.several * here.missed + base * over_base.passes(here);
        let cosine = cosine.max_element() * opaque;
        let all = once + cosine + boundary;
        Lobes {
            ggx: Ggx::of_roughness(layers.roughness),
            surface,
            over_base,
            base,
            here,
            mean,
            boundary,
            eta: if from_outside { self.ior } else { 1.0 / self.ior },
            chances: [once / all, cosine / all],
        }
    }

    /// What is to be said of light from `i`, whose direction in the world is `direction`.
    fn evaluate(&self, lobes: &Lobes, o: Vec3, i: Vec3, direction: Vec3) -> BsdfSample {
        let [surface, base] = lobes.chances;
        let boundary_chance = (1.0 - surface - base).max(0.0);
        let opaque = 1.0 - lobes.boundary;
        let mut value = Vec3::ZERO;
        let mut pdf = 0.0;
        let mut eta = 1.0;
        if i.z > 0.0 {
            let h = (o + i).normalize();
            let cosine = o.dot(h).clamp(0.0, 1.0);
            let lobe = lobes.ggx.distribution(h) / (4.0 * o.z);
            let both = lobes.ggx.masking_reflected(o, i);
            let half_pdf = lobes.ggx.masking(o) * lobe;
            value += lobes.surface.schlick(cosine) * (opaque * both * lobe);
            pdf += surface * half_pdf;
            value += self.cosine_lobe(lobes, i) * (opaque * i.z * FRAC_1_PI);
            pdf += base * i.z * FRAC_1_PI;
            if lobes.boundary > 0.0 {
                let reflected = dielectric_fresnel(cosine, lobes.eta);
                value += Vec3::splat(lobes.boundary * reflected * both * lobe);
                pdf += boundary_chance * reflected * half_pdf;
            }
        } else if i.z < 0.0 && lobes.boundary > 0.0 {
            eta = lobes.eta;
            let h = lobes.refracting(o, i);
            let (near, far) = (o.dot(h), i.dot(h));
            if near > 0.0 && far < 0.0 {
                let passes = 1.0 - dielectric_fresnel(near, eta);
                let spread = near + eta * far;
                let lobe =
                    lobes.ggx.distribution(h) * near * -far * (eta * eta) / (spread * spread * o.z);
                let both = lobes.ggx.masking_transmitted(o, i);
                value += self.colour * (lobes.boundary * passes * both * lobe / (eta * eta));
                pdf += boundary_chance * passes * lobes.ggx.masking(o) * lobe;
            }
        }
        let weight = if pdf > 0.0 { value / pdf } else { Vec3::ZERO };
        BsdfSample { direction, weight, pdf, eta }
    }

    /// What follows the cosine, over that and by pi: light that several microfacets have reflected,
    /// and the diffuse base under the surface.
    fn cosine_lobe(&self, lobes: &Lobes, i: Vec3) -> Vec3 {
        let (here, mean) = (lobes.here, lobes.mean);
        let there = Albedo::new(self.albedos.directional(self.layers.roughness, i.z.min(1.0)));
        let missed = here.missed * there.missed / mean.missed.max(f32::MIN_POSITIVE);
        let passes = lobes.over_base.passes(here) * lobes.over_base.passes(there);
        let passes = passes / lobes.over_base.passes(mean).max(Vec3::splat(HORIZON));
        lobes.surface.several * missed + lobes.base * passes
    }
}

impl Lobes {
    /// The normal, on `o`'s side, of microfacets that refract from `o` to `i`.
    fn refracting(&self, o: Vec3, i: Vec3) -> Vec3 {
        let h = (o + i * self.eta).normalize();
        if h.z < 0.0 { -h } else { h }
    }
}

/// Where light goes that a microfacet of normal `h`, which `o` sees under this `cosine`, refracts.
fn refract(o: Vec3, h: Vec3, cosine: f32, eta: f32) -> Vec3 {
    let far = (1.0 - (1.0 - cosine * cosine) / (eta * eta)).max(0.0).sqrt();
    -o / eta + h * (cosine / eta - far)
}

/// Fresnel's reflectance under a `cosine` on the near side, where the far side has `eta` times the
/// index of refraction.
fn dielectric_fresnel(cosine: f32, eta: f32) -> f32 {
    let sin2 = (1.0 - cosine * cosine) / (eta * eta);
    if sin2 >= 1.0 { 1.0 } else { fresnel(cosine, (1.0 - sin2).sqrt(), eta) }
}

/// The channel of this number.
fn channel(codes: Vec4, number: u32) -> f32 {
    if number == 0 {
        codes.x
    } else if number == 1 {
        codes.y
    } else if number == 2 {
        codes.z
    } else {
        codes.w
    }
}

/// The frame of a surface.
struct Frame {
    x: Vec3,
    y: Vec3,
    z: Vec3,
}

impl Frame {
    fn new(normal: Vec3) -> Self {
        let (x, y) = tangent_frame(normal);
        Self { x, y, z: normal }
    }

    fn local(&self, v: Vec3) -> Vec3 {
        Vec3::new(self.x.dot(v), self.y.dot(v), self.z.dot(v))
    }

    fn world(&self, v: Vec3) -> Vec3 {
        (self.x * v.x + self.y * v.y + self.z * v.z).normalize()
    }

    /// Where a path came from, above the horizon.
    fn seen(&self, incoming: Vec3) -> Vec3 {
        let o = self.local(-incoming);
        Vec3::new(o.x, o.y, o.z.max(HORIZON)).normalize()
    }
}
