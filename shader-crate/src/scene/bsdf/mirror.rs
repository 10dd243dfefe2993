//! The ideal mirror.

use super::BsdfSample;
use crate::glam::Vec3;

/// Reflects the unit vector `incoming` at the shading `normal`.
pub fn sample(reflectance: Vec3, normal: Vec3, incoming: Vec3) -> BsdfSample {
    let direction = incoming.reflect(normal).normalize();
    BsdfSample { direction, weight: reflectance, pdf: 0.0, eta: 1.0 }
}
