//! The principled material: paint, metal and rough glass in one record.
//!
//! A mixture, by `metallic` and `transmission`, of three: a metal, a diffuse base under a smooth or
//! rough dielectric surface, and the rough boundary of a dielectric; all under a
//! [cover](super::cover). It is what glTF 2.0 calls metallic-roughness with `KHR_materials_ior`,
//! `KHR_materials_transmission`, `KHR_materials_clearcoat` and `KHR_materials_sheen`, and a part of
//! OpenPBR.
//!
//! Its lobes are
//!
//! - *surface*: reflection by microfacets ([`Ggx`], or [`Anisotropic`] ones) with Schlick's Fresnel
//!   term, or that of a [conductor](super::conductor);
//! - *base*: what follows the cosine: the diffuse base, by the share that the surface lets pass on
//!   both ways, and what light has been reflected by several microfacets. Both are those of Kulla
//!   and Conty, "Revisiting Physically Based Shading at Imageworks", 2017: nothing is lost, and
//!   both directions are worth the same. It has the normal that maps say, whoever looks;
//! - *boundary*: reflection and refraction by a microfacet of a [boundary](super::boundary);
//! - *below*: what several microfacets of the boundary let pass, which follows the cosine on the
//!   far side.

use super::BsdfSample;
use super::albedo::AlbedoView;
use super::anisotropic::{Anisotropic, AnisotropicAlbedos};
use super::boundary::Boundary;
use super::conductor::Conductor;
use super::cover::Cover;
use super::ggx::Ggx;
use super::layers::Layers;
use super::reflector::{Albedo, Reflector};
use crate::glam::Vec3;
use crate::math::{sample_cosine_hemisphere, tangent_frame};
use crate::scene::abilities::{
    ANISOTROPY, Abilities, COAT_NORMALS, CONDUCTORS, COVER, F90, NORMAL_MAPS,
};
use core::f32::consts::FRAC_1_PI;

/// Least cosine of a direction from which a surface is seen: at the horizon densities have no
/// digits.
const HORIZON: f32 = 1e-4;

/// Cosine from which on the normal of a coat is that of what is below: of two that are alike it is
/// 1, but for roundings.
const UNBENT: f32 = 1.0 - 1e-6;

/// Unit normals of the lobes, on the side that the path came from.
#[derive(Clone, Copy)]
pub struct Facing {
    /// Of those that [mirror](crate::scene::normals::Normals::mirroring), and of all that follows.
    pub normal: Vec3,
    /// See [`Normals::geometric`](crate::scene::normals::Normals::geometric).
    pub geometric: Vec3,
    /// Of the coat.
    pub coat: Vec3,
    /// Of the base.
    pub base: Vec3,
}

/// The material at a point.
#[derive(Clone, Copy)]
pub struct Principled<'a, F> {
    /// Colour of the base, of the metal and of what passes, linear Rec.709 in [0, 1].
    pub colour: Vec3,
    /// The rest of it.
    pub layers: Layers,
    /// Which way it faces.
    pub facing: Facing,
    /// The direction along which the surface is rougher, see [`Layers::grain`].
    pub grain: Vec3,
    /// Index of refraction behind the front, relative to the outside.
    pub ior: f32,
    /// Tables of albedos.
    pub albedos: AlbedoView<'a>,
    /// What the scene uses.
    pub abilities: F,
}

/// The lobes as a direction `o` sees them.
struct Lobes {
    ggx: Ggx,
    /// What takes the place of these where there is a grain.
    stretched: Anisotropic,
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
    transmission: f32,
    boundary: Boundary,
    /// Probabilities of the lobes surface, base and below; the rest is the boundary's.
    chances: [f32; 3],
    /// What lies over all of these.
    cover: Cover,
}

impl<F: Abilities> Principled<'_, F> {
    /// BSDF times cosine over density, and density per solid angle, of a `direction` that light
    /// comes from where the path arrived along `incoming`; `from_outside` says which side it came
    /// from.
    #[inline(always)]
    pub fn eval(&self, from_outside: bool, incoming: Vec3, direction: Vec3) -> BsdfSample {
        let frame = self.frame(self.facing.normal);
        let o = frame.seen(incoming);
        let lobes = self.lobes(&frame, o, from_outside);
        self.evaluate(&lobes, o, frame.local(direction), direction)
    }

    /// A direction, by uniform numbers in [0, 1) for the direction (`u`) and for the choice of the
    /// `lobe`; the rest is as in [`Self::eval`].
    pub fn sample(&self, from_outside: bool, incoming: Vec3, u: [f32; 2], lobe: f32) -> BsdfSample {
        let frame = self.frame(self.facing.normal);
        let o = frame.seen(incoming);
        let lobes = self.lobes(&frame, o, from_outside);
        let is_covers = self.abilities.has(COVER) && lobes.cover.takes(lobe);
        let (i, crosses) = if is_covers {
            (lobes.cover.sample(self.abilities, o, u, lobe), false)
        } else {
            let lobe = if self.abilities.has(COVER) { lobes.cover.rest(lobe) } else { lobe };
            self.sample_lobe(&lobes, &frame, o, u, lobe)
        };
        let i = i.normalize();
        let mut sample = self.evaluate(&lobes, o, i, frame.world(i));
        let mut is_lost = crosses == (i.z >= 0.0);
        if self.abilities.has(COAT_NORMALS) && is_covers {
            is_lost = sample.direction.dot(self.facing.geometric) <= 0.0;
        }
        if is_lost {
            // A single microfacet sends no light there.
            sample.weight = Vec3::ZERO;
        }
        // A density of 0 would stand for a delta distribution.
        sample.pdf = sample.pdf.max(f32::MIN_POSITIVE);
        sample
    }

    fn lobes(&self, frame: &Frame, o: Vec3, from_outside: bool) -> Lobes {
        let layers = &self.layers;
        let transmission = (1.0 - layers.metallic) * layers.transmission;
        let opaque = 1.0 - transmission;
        let metal = layers.metallic / opaque.max(f32::MIN_POSITIVE);
        let straight = (self.ior - 1.0) / (self.ior + 1.0);
        let here = self.albedo(o);
        let mean = self.mean_albedo();
        let f0 = (layers.specular * (straight * straight)).min(Vec3::ONE);
        let mut f90 = 1.0;
        if self.abilities.has(F90) {
            f90 = layers.f90();
        }
        let over_base = Reflector::new(f0, f90, mean);
        let of_metal = if self.is_conductor() {
            Reflector::of_mean(self.colour, self.conductor().mean, mean)
        } else {
            Reflector::new(self.colour, 1.0, mean)
        };
        let surface = Reflector {
            f0: over_base.f0.lerp(of_metal.f0, metal),
            f90: f90 + (1.0 - f90) * metal,
            several: over_base.several.lerp(of_metal.several, metal),
        };
        let base = self.colour * (1.0 - metal);
        let mut boundary = Boundary::NONE;
        if transmission > 0.0 {
            let (thin, albedos) = (layers.is_thin(), self.boundary_albedos());
            boundary = Boundary::new(o, layers.roughness, self.ior, thin, from_outside, albedos);
        }
        let once = surface.once(here).max_element() * opaque;
        let cosine = surface.several * here.missed + base * over_base.passes(here);
        let several = boundary.missed * transmission;
        let cosine = cosine.max_element() * opaque + several * (1.0 - boundary.crossing());
        let below = several * boundary.crossing();
        let all = once + cosine + transmission - several + below;
        // What is seen from within a body has its cover behind it.
        let mut cover = Cover::NONE;
        if self.abilities.has(COVER) && (from_outside || transmission == 0.0) {
            let mut coat = Vec3::Z;
            if self.abilities.has(COAT_NORMALS) && self.facing.coat.dot(frame.z) < UNBENT {
                coat = frame.local(self.facing.coat);
            }
            cover = Cover::new(layers, coat, o, self.albedos, all, self.abilities);
        }
        Lobes {
            ggx: Ggx::of_roughness(layers.roughness),
            stretched: Anisotropic::new(layers.roughness, layers.strength()),
            surface,
            over_base,
            base,
            here,
            mean,
            transmission,
            boundary,
            chances: [once / all, cosine / all, below / all],
            cover,
        }
    }

    /// Whether the surface is rougher along a direction than across.
    #[inline(always)]
    fn has_grain(&self) -> bool {
        self.abilities.has(ANISOTROPY) && self.grain.length_squared() > 0.0
    }

    /// The frame of the surface: along its grain, if there is one.
    #[inline(always)]
    fn frame(&self, normal: Vec3) -> Frame {
        if self.has_grain() {
            let y = normal.cross(self.grain).normalize();
            return Frame { x: y.cross(normal), y, z: normal };
        }
        Frame::new(normal)
    }

    fn anisotropic_albedos(&self) -> AnisotropicAlbedos<'_> {
        AnisotropicAlbedos { rows: self.albedos.rows, first: self.albedos.anisotropic }
    }

    /// What one microfacet of the surface sends on as `w` sees it.
    #[inline(always)]
    fn albedo(&self, w: Vec3) -> Albedo {
        let Layers { roughness, .. } = self.layers;
        if self.has_grain() {
            let strength = self.layers.strength();
            return Albedo::new(self.anisotropic_albedos().directional(roughness, strength, w));
        }
        Albedo::new(self.albedos.directional(roughness, w.z.min(1.0)))
    }

    /// The mean of that.
    #[inline(always)]
    fn mean_albedo(&self) -> Albedo {
        let Layers { roughness, .. } = self.layers;
        if self.has_grain() {
            return Albedo::new(self.anisotropic_albedos().mean(roughness, self.layers.strength()));
        }
        Albedo::new(self.albedos.mean(roughness))
    }

    /// A direction by one of the lobes below the cover, and whether it crosses the surface.
    #[inline(always)]
    fn sample_lobe(
        &self,
        lobes: &Lobes,
        frame: &Frame,
        o: Vec3,
        u: [f32; 2],
        lobe: f32,
    ) -> (Vec3, bool) {
        let [surface, base, _] = lobes.chances;
        if self.is_base_apart() && lobe >= surface && lobe < surface + base {
            return (frame.local(sample_cosine_hemisphere(self.facing.base, u)), false);
        }
        if self.has_grain() && lobe < lobes.chances[0] {
            return ((-o).reflect(lobes.stretched.sample_visible(o, u)), false);
        }
        lobes.sample(o, u, lobe)
    }

    /// Whether the base faces another way than what mirrors: elsewhere its frame is theirs, to the
    /// last bit.
    #[inline(always)]
    fn is_base_apart(&self) -> bool {
        let apart = self.facing.base - self.facing.normal;
        self.abilities.has(NORMAL_MAPS) && apart.length_squared() > 0.0
    }

    /// Whether it is a metal whose index of refraction is known, and nothing else.
    #[inline(always)]
    fn is_conductor(&self) -> bool {
        self.abilities.has(CONDUCTORS) && self.layers.conductor != 0
    }

    fn conductor(&self) -> Conductor {
        Conductor::load(self.albedos.rows, self.albedos.first + self.layers.conductor)
    }

    /// Where the albedos of the boundary lie; those of a surface, if that is thin.
    fn boundary_albedos(&self) -> AlbedoView<'_> {
        AlbedoView { first: self.albedos.first + self.layers.boundary_albedos, ..self.albedos }
    }

    /// A direction above the surface in the frame of the base: `i`, or what maps make of `direction`
    /// in the world, which the base sees from above or from the side.
    #[inline(always)]
    fn seen_by_base(&self, i: Vec3, direction: Vec3) -> Vec3 {
        let mut seen = i;
        if self.is_base_apart() {
            seen = self.frame(self.facing.base).local(direction);
            seen.z = seen.z.max(0.0);
        }
        seen
    }

    /// What is to be said of light from `i`, whose direction in the world is `direction`.
    fn evaluate(&self, lobes: &Lobes, o: Vec3, i: Vec3, direction: Vec3) -> BsdfSample {
        let [surface, base, below] = lobes.chances;
        let boundary_chance = (1.0 - surface - base - below).max(0.0);
        let opaque = 1.0 - lobes.transmission;
        let mut value = Vec3::ZERO;
        let mut pdf = 0.0;
        let mut eta = 1.0;
        let mut keeps_side = true;
        let mut reaches_cover = i.z > 0.0;
        if self.abilities.has(NORMAL_MAPS) {
            let is_above = direction.dot(self.facing.geometric) > 0.0;
            keeps_side = is_above == (i.z > 0.0);
            // A coat that faces elsewhere sees what lies behind what is below it.
            reaches_cover = is_above && (reaches_cover || self.abilities.has(COAT_NORMALS));
        }
        if i.z > 0.0 && keeps_side {
            let h = (o + i).normalize();
            let cosine = o.dot(h).clamp(0.0, 1.0);
            let mut lobe = lobes.ggx.distribution(h) / (4.0 * o.z);
            let mut both = lobes.ggx.masking_reflected(o, i);
            let mut seen = lobes.ggx.masking(o);
            if self.has_grain() {
                lobe = lobes.stretched.distribution(h) / (4.0 * o.z);
                both = lobes.stretched.masking_reflected(o, i);
                seen = lobes.stretched.masking(o);
            }
            let mut reflected = lobes.surface.schlick(cosine);
            if self.is_conductor() {
                reflected = self.conductor().reflectance(cosine);
            }
            value += reflected * (opaque * both * lobe);
            pdf += surface * seen * lobe;
            let of_base = self.seen_by_base(i, direction);
            value += self.cosine_lobe(lobes, of_base) * (opaque * of_base.z * FRAC_1_PI);
            pdf += base * of_base.z * FRAC_1_PI;
        }
        if lobes.transmission > 0.0 && i.z != 0.0 && keeps_side {
            let scattered = lobes.boundary.scattered(o, i, self.boundary_albedos());
            let mut tint = Vec3::ONE;
            if i.z < 0.0 {
                eta = lobes.boundary.eta();
                tint = self.colour;
                pdf += below * -i.z * FRAC_1_PI;
            }
            value += tint * (lobes.transmission * (scattered.once + scattered.several));
            pdf += boundary_chance * scattered.once_pdf;
        }
        if self.abilities.has(COVER) {
            let [coat, sheen] = lobes.cover.chances;
            value *= lobes.cover.passes;
            pdf *= (1.0 - coat - sheen).max(0.0);
            if reaches_cover {
                let (reflected, density) = lobes.cover.reflects(self.abilities, o, i);
                value += reflected;
                pdf += density;
            }
        }
        let weight = if pdf > 0.0 { value / pdf } else { Vec3::ZERO };
        BsdfSample { direction, weight, pdf, eta }
    }

    /// What follows the cosine, over that and by pi: light that several microfacets have reflected,
    /// and the diffuse base under the surface.
    fn cosine_lobe(&self, lobes: &Lobes, i: Vec3) -> Vec3 {
        let (here, mean) = (lobes.here, lobes.mean);
        let there = self.albedo(i);
        let missed = here.missed * there.missed / mean.missed.max(f32::MIN_POSITIVE);
        let passes = lobes.over_base.passes(here) * lobes.over_base.passes(there);
        let passes = passes / lobes.over_base.passes(mean).max(Vec3::splat(HORIZON));
        lobes.surface.several * missed + lobes.base * passes
    }
}

impl Lobes {
    /// A direction, and whether it crosses the surface.
    fn sample(&self, o: Vec3, u: [f32; 2], lobe: f32) -> (Vec3, bool) {
        let [surface, base, below] = self.chances;
        let single = surface + base + below;
        if lobe < surface {
            ((-o).reflect(self.ggx.sample_visible(o, u)), false)
        } else if lobe < surface + base {
            (sample_cosine_hemisphere(Vec3::Z, u), false)
        } else if lobe < single {
            (sample_cosine_hemisphere(-Vec3::Z, u), true)
        } else {
            let choice = (lobe - single) / (1.0 - single).max(f32::MIN_POSITIVE);
            self.boundary.sample(o, u, choice)
        }
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
