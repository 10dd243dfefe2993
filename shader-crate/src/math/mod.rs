//! The few functions that `glam` and `core` do not have.

pub mod angles;
pub mod elementary;
pub mod exact;
pub mod fixed;
pub mod packed;
pub mod random;
pub mod wide;

use crate::glam::{Vec3, Vec4};
use angles::sin_cos_within_eighth;
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

/// 2^-24: half an ulp of 1, the largest relative error of one rounded operation.
pub const UNIT_ROUNDOFF: f32 = 5.960_464_5e-8;

/// Two unit vectors that make a right-handed orthonormal frame with the unit vector `n`:
/// `cross(x, y) = n`.
///
/// Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1), 2017.
pub fn tangent_frame(n: Vec3) -> (Vec3, Vec3) {
    let sign = if n.z < 0.0 { -1.0 } else { 1.0 };
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    (
        Vec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x),
        Vec3::new(b, sign + n.y * n.y * a, -n.y),
    )
}

/// The square of the cosine of a radius of 1 - 2^-24, see [`sample_cosine_hemisphere`].
const LEAST_COSINE_SQUARED: f32 = 2.0 * UNIT_ROUNDOFF;

/// A uniform point of the unit disc from a uniform point of the unit square.
///
/// Shirley and Chiu, "A Low Distortion Map Between Disk and Square", JGT 2(3), 1997, which keeps
/// the square's stratification.
pub fn concentric_disc(u: [f32; 2]) -> (f32, f32) {
    let (x, y) = (2.0 * u[0] - 1.0, 2.0 * u[1] - 1.0);
    let horizontal = x.abs() > y.abs();
    let radius = if horizontal { x } else { y };
    let ratio = if radius == 0.0 {
        0.0
    } else if horizontal {
        y / x
    } else {
        x / y
    };
    let (sine, cosine) = sin_cos_within_eighth(core::f32::consts::FRAC_PI_4 * ratio);
    let (near, far) = (radius * cosine, radius * sine);
    if horizontal { (near, far) } else { (far, near) }
}

/// A direction about the unit vector `n`, of density `cos / pi`, from a uniform point of the unit
/// square.
///
/// Malley's method over the [`concentric_disc`]. A coordinate of 24 bits is 0 once in 2^24 times,
/// and stands for all below 2^-24: the direction is then that of its middle, and not in the
/// surface, from where a rounding would take it through.
pub fn sample_cosine_hemisphere(n: Vec3, u: [f32; 2]) -> Vec3 {
    let (dx, dy) = concentric_disc(u);
    let dz = (1.0 - dx * dx - dy * dy).max(LEAST_COSINE_SQUARED).sqrt();
    let (tangent, bitangent) = tangent_frame(n);
    (tangent * dx + bitangent * dy + n * dz).normalize()
}

/// The weight of the technique with density `pdf` against another that could have made the same
/// sample.
///
/// The power heuristic with exponent 2; Veach 1997, equation 9.11. Written over the ratio so that
/// densities beyond 1e19 do not overflow.
pub fn power_heuristic(pdf: f32, other: f32) -> f32 {
    if pdf <= 0.0 {
        return 0.0;
    }
    let ratio = other / pdf;
    1.0 / (1.0 + ratio * ratio)
}

/// Whether `x` is neither infinite nor NaN, by its bits: GPUs may compute as if there were no such
/// numbers.
pub fn is_finite(x: f32) -> bool {
    const EXPONENT: u32 = 0x7f80_0000;
    x.to_bits() & EXPONENT != EXPONENT
}

/// The mean over the components of `v`.
pub fn mean_of_components(v: Vec3) -> f32 {
    v.dot(Vec3::ONE) * (1.0 / 3.0)
}

/// The dot product of `a` and `b`, added up in the order of the components: processors' vector
/// instructions have another.
pub fn dot(a: Vec4, b: Vec4) -> f32 {
    a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w
}

/// Whether all components of `v` are finite.
pub fn is_finite_vector(v: Vec3) -> bool {
    is_finite(v.x) && is_finite(v.y) && is_finite(v.z)
}
