//! Materials, and the choice of a direction by them.

use crate::glam::Vec3;
use crate::math::sample_cosine_hemisphere;
use crate::memory::device_struct;
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

/// [`Material::kind`]: Lambert's law, both sides; may emit on the front.
pub const DIFFUSE: u32 = 0;
/// [`Material::kind`]: ideal mirror, both sides, without a Fresnel term.
pub const MIRROR: u32 = 1;
/// [`Material::kind`]: smooth boundary between vacuum (front) and a medium of index `ior` (back).
pub const DIELECTRIC: u32 = 2;

device_struct! {
    /// One material. 48 bytes.
    pub struct Material {
        /// Reflectance, linear Rec.709 in [0, 1]; a texture replaces it.
        pub reflectance: Vec3,
        /// [`DIFFUSE`], [`MIRROR`] or [`DIELECTRIC`].
        pub kind: u32,
        /// Radiance that the front emits, linear Rec.709; zero for most.
        pub emission: Vec3,
        /// Index of the reflectance's texture, or [`crate::scene::texture::NO_TEXTURE`].
        pub texture: u32,
        /// What a dielectric lets pass, linear Rec.709 in [0, 1], beside Fresnel's share.
        pub transmittance: Vec3,
        /// A dielectric's index of refraction, relative to the outside.
        pub ior: f32,
    }
}

impl Material {
    /// Whether the front emits.
    pub fn emits(&self) -> bool {
        self.emission.max_element() > 0.0
    }
}

/// A direction chosen by a BSDF.
#[derive(Clone, Copy)]
pub struct BsdfSample {
    /// Where the path goes on; unit length.
    pub direction: Vec3,
    /// BSDF times cosine over density, by component: what the throughput is multiplied by.
    pub weight: Vec3,
    /// Density of the direction per solid angle; 0 stands for a delta distribution.
    pub pdf: f32,
}

/// Lambert's density of `direction` per solid angle about `normal`, and at the same time BSDF times
/// cosine of a reflectance of 1.
pub fn diffuse_pdf(normal: Vec3, direction: Vec3) -> f32 {
    normal.dot(direction).max(0.0) * core::f32::consts::FRAC_1_PI
}

/// Samples Lambert's BSDF about the shading `normal`, which is on the side that the path came from.
pub fn sample_diffuse(reflectance: Vec3, normal: Vec3, u: [f32; 2]) -> BsdfSample {
    let direction = sample_cosine_hemisphere(normal, u);
    // At the horizon the cosine rounds to 0, which would stand for a delta distribution.
    BsdfSample {
        direction,
        weight: reflectance,
        pdf: diffuse_pdf(normal, direction).max(f32::MIN_POSITIVE),
    }
}

/// Reflects the unit vector `incoming` at the shading `normal`.
pub fn sample_mirror(reflectance: Vec3, normal: Vec3, incoming: Vec3) -> BsdfSample {
    BsdfSample { direction: incoming.reflect(normal).normalize(), weight: reflectance, pdf: 0.0 }
}

/// Reflects or refracts the unit vector `incoming` at a boundary, with Fresnel's probabilities.
///
/// `normal` is the shading normal on the side that the path came from, `from_outside` says which
/// side that is, `u` picks the lobe. Radiance that crosses is scaled by the squared ratio of the
/// indices (Veach 1997, section 5.2.2).
pub fn sample_dielectric(
    material: &Material,
    normal: Vec3,
    from_outside: bool,
    incoming: Vec3,
    u: f32,
) -> BsdfSample {
    // Index on the side of the light's arrival over that of the path's.
    let eta = if from_outside { material.ior } else { 1.0 / material.ior };
    let cos_i = (-incoming.dot(normal)).clamp(0.0, 1.0);
    let sin2_t = (1.0 - cos_i * cos_i) / (eta * eta);
    let cos_t = (1.0 - sin2_t).max(0.0).sqrt();
    let reflected = if sin2_t >= 1.0 { 1.0 } else { fresnel(cos_i, cos_t, eta) };
    if u < reflected {
        sample_mirror(material.reflectance, normal, incoming)
    } else {
        BsdfSample {
            direction: (incoming / eta + normal * (cos_i / eta - cos_t)).normalize(),
            weight: material.transmittance / (eta * eta),
            pdf: 0.0,
        }
    }
}

/// Fresnel's reflectance of unpolarised light, from the cosines on both sides and the ratio of the
/// indices.
fn fresnel(cos_i: f32, cos_t: f32, eta: f32) -> f32 {
    let parallel = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    let perpendicular = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    0.5 * (parallel * parallel + perpendicular * perpendicular)
}
