//! The smooth boundary between two media.

use super::{BsdfSample, mirror};
use crate::glam::Vec3;
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

/// A boundary.
#[derive(Clone, Copy)]
pub struct Dielectric {
    /// Index of refraction behind the front, relative to the outside.
    pub ior: f32,
    /// What is reflected of Fresnel's share, linear Rec.709 in [0, 1].
    pub reflectance: Vec3,
    /// What passes of Fresnel's share, linear Rec.709 in [0, 1].
    pub transmittance: Vec3,
}

impl Dielectric {
    /// Reflects or refracts the unit vector `incoming`, with Fresnel's probabilities.
    ///
    /// `normal` is the shading normal on the side that the path came from, `from_outside` says
    /// which side that is, `u` picks the lobe. Radiance that crosses is scaled by the squared ratio
    /// of the indices (Veach 1997, section 5.2.2).
    pub fn sample(&self, normal: Vec3, from_outside: bool, incoming: Vec3, u: f32) -> BsdfSample {
        // Index on the side of the light's arrival over that of the path's.
        let eta = if from_outside { self.ior } else { 1.0 / self.ior };
        let cos_i = (-incoming.dot(normal)).clamp(0.0, 1.0);
        let sin2_t = (1.0 - cos_i * cos_i) / (eta * eta);
        let cos_t = (1.0 - sin2_t).max(0.0).sqrt();
        let reflected = if sin2_t >= 1.0 { 1.0 } else { fresnel(cos_i, cos_t, eta) };
        if u < reflected {
            mirror::sample(self.reflectance, normal, incoming)
        } else {
            BsdfSample {
                direction: (incoming / eta + normal * (cos_i / eta - cos_t)).normalize(),
                weight: self.transmittance / (eta * eta),
                pdf: 0.0,
                eta,
            }
        }
    }
}

/// Fresnel's reflectance of unpolarised light, from the cosines on both sides and the ratio of the
/// indices.
pub fn fresnel(cos_i: f32, cos_t: f32, eta: f32) -> f32 {
    let parallel = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    let perpendicular = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    0.5 * (parallel * parallel + perpendicular * perpendicular)
}
