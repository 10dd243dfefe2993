//! Sheen: fibres that stand off a surface, such as those of velvet or dust.
//!
//! Estevez and Kulla, "Production Friendly Microfacet Sheen BRDF", 2017, with the visibility term
//! of Neubelt and Pettineo, "Crafting a Next-Gen Material Pipeline for The Order: 1886", 2013: what
//! glTF's `KHR_materials_sheen` has. It reflects by the share of a [table](super::albedo), of which
//! the first of each pair counts; at grazing angles the formulas reflect more than all light, and
//! are scaled to all.
//!
//! All vectors are unit vectors in the frame of the surface, whose normal is +z.

use crate::glam::Vec3;
use crate::math::angles::sin_cos_of_turns;
use crate::math::elementary::pow;
use core::f32::consts::{FRAC_1_PI, TAU};
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

/// What counts as the smoothest: below it the lobe is a line at the horizon.
const SMOOTHEST: f32 = 0.2;

/// Where the table has what a `roughness` in [0, 1] reflects, from 0 to 1: its first row is that of
/// the smoothest.
pub fn place(roughness: f32) -> f32 {
    (roughness.max(SMOOTHEST) - SMOOTHEST) * (1.0 / (1.0 - SMOOTHEST))
}

/// The roughness at such a place.
pub fn roughness_at(place: f32) -> f32 {
    SMOOTHEST + place * (1.0 - SMOOTHEST)
}

/// The density with which its directions are sampled, all alike.
pub const PDF: f32 = 1.0 / TAU;

/// BSDF times cosine of white sheen of a `roughness` in [0, 1], before it is scaled; `o` and `i`
/// lie above the surface.
pub fn value(roughness: f32, o: Vec3, i: Vec3) -> f32 {
    let roughness = roughness.max(SMOOTHEST);
    let sharpness = 1.0 / (roughness * roughness);
    let h = (o + i).normalize();
    let sin2 = (h.x * h.x + h.y * h.y).max(f32::MIN_POSITIVE);
    let distribution = (2.0 + sharpness) * pow(sin2, 0.5 * sharpness) * (0.5 * FRAC_1_PI);
    distribution * i.z / (4.0 * (o.z + i.z - o.z * i.z))
}

/// A direction, from a uniform point of the unit square.
pub fn sample(u: [f32; 2]) -> Vec3 {
    let radius = (1.0 - u[1] * u[1]).max(0.0).sqrt();
    let (sine, cosine) = sin_cos_of_turns(u[0]);
    Vec3::new(radius * cosine, radius * sine, u[1])
}
