//! How the techniques that could have made the same path are weighed: the power heuristic, by
//! recursion.
//!
//! Let the vertices of a path be `x_0` on a light, up to `x_K` at the camera, `f_i` the density per
//! area with which a path from the light finds `x_i` after `x_(i-1)`, and `b_i` that with which a
//! path from the camera finds it after `x_(i+1)`. The technique with `s` vertices of a light path
//! has the density `p_s = f_0 ... f_(s-1) b_s ... b_K`. With `n_s` samples of each, the power
//! heuristic with exponent 2 (Veach 1997, section 9.2.2) gives it the weight
//!
//! ```text
//! w_s = 1 / (1 + sum over i < s and i > s of (n_i p_i / (n_s p_s))^2)
//! ```
//!
//! The sum over `i < s` is `(b_(s-1) L / n_s)^2`, where `L` knows nothing beyond `x_(s-1)` but the
//! side from which `x_s` is seen:
//!
//! ```text
//! L^2 = (n_(s-1) / f_(s-1))^2 + (r E)^2
//! E   = c / (q c' ) * L of the vertex before
//! ```
//!
//! with `q` the density per solid angle with which the vertex before chose the direction to
//! `x_(s-1)`, `r` that with which `x_(s-1)` would choose the direction back, `c` and `c'` the
//! cosines of that segment at its two ends; the squared distance cancels. The first term is the
//! technique that connects the two, so it is left out if one of them is specular; there `r / q`
//! becomes the ratio of the solid angles of a refraction. The sum over `i > s` is the same from the
//! other side. These are the quantities `dVCM` and `dVC` of Georgiev, "Implementing Vertex
//! Connection and Merging", 2012, kept as norms, not as squares: these would overflow in scenes of
//! large coordinates.
//!
//! Roulette is not in the densities, since a path from the other side could not know it: weights
//! need only be the same function of the path for all techniques.
//!
//! Light tracing is `s = K`, the camera's vertex alone from its side. Its `b_K` is that of the
//! pinhole, which all techniques share, so it cancels; `b_(K-1)` follows from the density of the
//! camera's ray within the pixel (see [`Camera::pdf`](crate::scene::camera::Camera::pdf)). It is
//! left out for `K = 1`: a lamp seen directly is what eye paths find without noise. A point on a
//! lens is chosen alike by all techniques and cancels as well. Parallel rays have a density per
//! area from the start, in which the squared distance is 1.
//!
//! A vertex `x_0` on the environment is a direction, and densities there are per solid angle. Light
//! from there reaches `x_1` through a disc of area `A` across its direction, so `f_1` is `c_1 / A`,
//! and `b_0` is the density of the direction as such: in the formulas above the squared distance is
//! 1, `c_0` is 1, and the density with which light would choose the way to `x_1` is `1 / A`. Light
//! from one direction is the same, and neither that nor a point of light has a technique `s = 0`:
//! `f_0`, a probability, cancels.

use crate::glam::Vec3;
use crate::math::power_heuristic;
use crate::scene::abilities::Abilities;
use crate::scene::bsdf::BsdfSample;
use crate::scene::surface::Surface;
use core::f32::consts::{FRAC_1_PI, PI};
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

/// How many samples of each technique an eye path has, in the weights. Any numbers make weights
/// that sum to 1, as long as they are the same for all; 0 leaves a technique out.
#[derive(Clone, Copy)]
pub struct TechniqueSamples {
    /// Of running into a light: 1.
    pub emission: f32,
    /// Of next-event estimation at each vertex: 1.
    pub light: f32,
    /// Of connecting each vertex with the vertices of one number of light paths: `M` draws among
    /// the vertices of `N` light paths that have `C` on average are `M / C` for each path.
    pub connection: f32,
    /// Of light tracing: light paths for each sample of a pixel. How many samples a pixel gets in a
    /// round is up to an allocator, so it is a constant of the render, about what a round has.
    pub camera: f32,
}

impl TechniqueSamples {
    /// Of the technique with `vertices` vertices from the light's side, where the camera's has some
    /// beside the camera.
    pub fn of(&self, vertices: u32) -> f32 {
        if vertices == 0 {
            self.emission
        } else if vertices == 1 {
            self.light
        } else {
            self.connection
        }
    }

    /// Of the technique without the last vertex of a path of `segments` from the camera, if that is
    /// not on a light.
    pub fn without_last_of(&self, segments: u32) -> f32 {
        if segments == 1 { self.camera } else { self.connection }
    }
}

/// Cosines count as at least this: beyond, the roundings of normals and directions are larger than
/// they are.
const SMALLEST_COSINE: f32 = 1e-6;

/// The cosine between a unit normal of either sign and a unit direction, above 0.
pub fn cosine(normal: Vec3, direction: Vec3) -> f32 {
    normal.dot(direction).abs().max(SMALLEST_COSINE)
}

/// Lambert's density of a direction with this cosine, per solid angle.
pub fn lambert(cosine: f32) -> f32 {
    cosine * FRAC_1_PI
}

/// `sqrt(a^2 + b^2)` without overflow on the way, for `a` and `b` from 0 on.
pub fn norm(a: f32, b: f32) -> f32 {
    let (small, large) = if a < b { (a, b) } else { (b, a) };
    if large > 0.0 {
        let ratio = small / large;
        large * (1.0 + ratio * ratio).sqrt()
    } else {
        0.0
    }
}

/// A part of a path, from the light or from the camera to its last vertex, as far as weights go.
#[derive(Clone, Copy)]
pub struct Subpath {
    /// 1 over the density of the last vertex per area (`1 / f`), or 0 where the vertex before is
    /// specular or there is no such technique.
    pub adjacent: f32,
    /// What all techniques with fewer vertices come to, before it is multiplied by the density of
    /// the direction back: `E`.
    pub earlier: f32,
}

impl Subpath {
    /// The camera alone, where a direction has been chosen with `pdf` per solid angle.
    pub fn from_camera(pdf: f32) -> Self {
        Self { adjacent: 1.0 / pdf, earlier: 0.0 }
    }

    /// A point on a light, chosen with `pdf` per area.
    pub fn from_light(pdf: f32) -> Self {
        Self { adjacent: 1.0 / pdf, earlier: 0.0 }
    }

    /// The environment, where a direction has been chosen with `pdf` per solid angle and the place
    /// of a ray on its disc, of area `disc_area`; `samples` are those of
    /// [`TechniqueSamples::emission`]. The segment to the next vertex counts as of length 1.
    pub fn from_environment(pdf: f32, disc_area: f32, samples: f32) -> Self {
        Self { adjacent: disc_area, earlier: disc_area * (samples / pdf) }
    }

    /// A light that no path from the camera can run into, after a ray has been chosen whose density
    /// is 1 over `extent`: per solid angle, or from infinity per area, as over a distance of 1.
    pub fn from_delta_light(extent: f32) -> Self {
        Self { adjacent: extent, earlier: 0.0 }
    }

    /// After a direction under this `cosine` has been chosen on the light with Lambert's density;
    /// `samples` are those of [`TechniqueSamples::emission`].
    pub fn emit(self, cosine: f32, samples: f32) -> Self {
        // As `leave` has it for that density, of which the cosine's part of 1/pi cancels.
        Self { adjacent: PI / cosine, earlier: PI * self.norm(samples, 0.0) }
    }

    /// After the segment to the next vertex, `distance` long, that arrives with this `cosine` to
    /// the triangle's normal.
    pub fn arrive(self, distance: f32, cosine: f32) -> Self {
        Self {
            adjacent: self.adjacent * distance / cosine * distance,
            earlier: self.earlier / cosine,
        }
    }

    /// The norm of all techniques with fewer vertices: the last vertex is multiplied by the density
    /// that the other side's path has for it. `samples` are those of the technique without the last
    /// vertex, `back` the density of the direction back to the vertex before.
    pub fn norm(&self, samples: f32, back: f32) -> f32 {
        norm(samples * self.adjacent, back * self.earlier)
    }

    /// After the direction `sample` has been chosen at `surface`, where the path arrived along
    /// `incoming`; `samples` as in [`Self::norm`].
    #[inline(always)]
    pub fn scatter(
        self,
        surface: &Surface<'_, impl Abilities>,
        incoming: Vec3,
        sample: &BsdfSample,
        samples: f32,
    ) -> Self {
        let leaving = cosine(surface.point.normal, sample.direction);
        if sample.pdf > 0.0 {
            let back = surface.bsdf.pdf_back(incoming, sample.direction);
            return self.leave(leaving, sample.pdf, self.norm(samples, back));
        }
        // The chances of the lobe are the same from both sides, and what is left of the ratio of
        // two delta distributions is that of the solid angles: 1 for a reflection, and by Snell's
        // law n1^2 cos1 / (n2^2 cos2) for a refraction.
        let mut solid_angles = 1.0;
        if sample.is_transmitted(surface.bsdf.normal) {
            let from = cosine(surface.bsdf.normal, incoming);
            let to = cosine(surface.bsdf.normal, sample.direction);
            solid_angles = from / (sample.eta * sample.eta * to);
        }
        Self { adjacent: 0.0, earlier: solid_angles * leaving * self.earlier }
    }

    /// After a direction of density `pdf` has been chosen at a vertex of this `norm`.
    fn leave(self, leaving: f32, pdf: f32, norm: f32) -> Self {
        Self { adjacent: 1.0 / pdf, earlier: leaving / pdf * norm }
    }
}

/// The weight of emission that an eye path of `segments` ran into, whose end is `eye`: on a light
/// that is chosen with `light_pdf` per area and emits back along the path under this `cosine`.
pub fn emission_weight(
    samples: &TechniqueSamples,
    eye: &Subpath,
    segments: u32,
    light_pdf: f32,
    cosine: f32,
) -> f32 {
    // Nothing connects the light itself with the camera.
    let light = if segments == 1 { 0.0 } else { samples.light };
    power_heuristic(samples.emission, light_pdf * eye.norm(light, lambert(cosine)))
}

/// The weight of light of the environment that an eye path of `segments` ran into, whose last
/// direction has `eye` and would be chosen with `light_pdf` per solid angle; `disc_area` is that of
/// the scene seen from there.
pub fn environment_weight(
    samples: &TechniqueSamples,
    eye: &Subpath,
    segments: u32,
    light_pdf: f32,
    disc_area: f32,
) -> f32 {
    // Nothing connects the environment itself with the camera.
    let light = if segments == 1 { 0.0 } else { samples.light };
    power_heuristic(samples.emission, light_pdf * eye.norm(light, 1.0 / disc_area))
}

/// The segment between the ends of two subpaths that are put together.
#[derive(Clone, Copy)]
pub struct Join {
    /// Density per area with which the path from the camera would find the end of the light's.
    pub to_light: f32,
    /// Density per area with which the path from the light would find the end of the camera's.
    pub to_eye: f32,
}

impl Join {
    /// From a surface to infinity in a direction with this cosine to its triangle's normal, which
    /// the path from the camera would choose with the density `eye_pdf` per solid angle;
    /// `disc_area` is that of the scene seen from there.
    pub fn to_infinity(eye_cosine: f32, eye_pdf: f32, disc_area: f32) -> Self {
        Self { to_light: eye_pdf, to_eye: eye_cosine / disc_area }
    }

    /// The same to a light that no path from the camera can run into.
    pub fn to_delta_light(self) -> Self {
        Self { to_light: 0.0, ..self }
    }

    /// Between two surfaces at this squared distance, with the cosines to their triangles' normals
    /// and the densities of the direction to the other per solid angle.
    pub fn new(
        distance2: f32,
        eye_cosine: f32,
        eye_pdf: f32,
        light_cosine: f32,
        light_pdf: f32,
    ) -> Self {
        Self {
            to_light: eye_pdf * light_cosine / distance2,
            to_eye: light_pdf * eye_cosine / distance2,
        }
    }
}

/// The weight of next-event estimation at a vertex whose [norm](Subpath::norm) is `eye`, of a point
/// that is chosen with `light_pdf` per area.
pub fn light_weight(samples: &TechniqueSamples, join: &Join, eye: f32, light_pdf: f32) -> f32 {
    let emission = join.to_light * (samples.emission / light_pdf);
    power_heuristic(samples.light, norm(emission, join.to_eye * eye))
}

/// The weight of the connection of two vertices with the [norms](Subpath::norm) `eye` and `light`.
pub fn connection_weight(samples: &TechniqueSamples, join: &Join, eye: f32, light: f32) -> f32 {
    power_heuristic(samples.connection, norm(join.to_light * light, join.to_eye * eye))
}

/// The weight of light tracing by a vertex with the [norm](Subpath::norm) `light`, which the
/// camera's ray would find with `to_light` per area.
pub fn camera_weight(samples: &TechniqueSamples, to_light: f32, light: f32) -> f32 {
    power_heuristic(samples.camera, to_light * light)
}
