//! Lambert's law.

use super::BsdfSample;
use crate::glam::Vec3;
use crate::math::sample_cosine_hemisphere;
use core::f32::consts::FRAC_1_PI;

/// The density of `direction` per solid angle about `normal`, and at the same time BSDF times
/// cosine of a reflectance of 1.
pub fn pdf(normal: Vec3, direction: Vec3) -> f32 {
    normal.dot(direction).max(0.0) * FRAC_1_PI
}

/// A direction about the shading `normal`, which is on the side that the path came from.
pub fn sample(reflectance: Vec3, normal: Vec3, u: [f32; 2]) -> BsdfSample {
    let direction = sample_cosine_hemisphere(normal, u);
    // At the horizon the cosine rounds to 0, which would stand for a delta distribution.
    let pdf = pdf(normal, direction).max(f32::MIN_POSITIVE);
    BsdfSample { direction, weight: reflectance, pdf, eta: 1.0 }
}
