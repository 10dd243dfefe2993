//! Directions of `N` paths, and weights of techniques: [`raystream_shaders::math`] side by side.

use super::numbers::{Floats, floats};
use super::vectors::Vectors;
use raystream_shaders::math::UNIT_ROUNDOFF;
use std::f32::consts::FRAC_PI_4;

/// The square of the cosine of a radius of 1 - 2^-24.
const LEAST_COSINE_SQUARED: f32 = 2.0 * UNIT_ROUNDOFF;

/// [`raystream_shaders::math::sample_cosine_hemisphere`].
#[inline(always)]
pub fn sample_cosine_hemisphere<const N: usize>(
    normal: Vectors<N>,
    u: [Floats<N>; 2],
) -> Vectors<N> {
    let [x, y] = concentric_disc(u);
    let one = Floats::splat(1.0);
    let z = (one - x * x - y * y).max(Floats::splat(LEAST_COSINE_SQUARED)).sqrt();
    let (tangent, bitangent) = tangent_frame(normal);
    (tangent * x + bitangent * y + normal * z).normalize()
}

#[inline(always)]
fn concentric_disc<const N: usize>([u, v]: [Floats<N>; 2]) -> [Floats<N>; 2] {
    let two = Floats::splat(2.0);
    let (x, y) = (two * u - 1.0, two * v - 1.0);
    let is_horizontal = x.abs().above(y.abs());
    let (radius, other) = (is_horizontal.choose(x, y), is_horizontal.choose(y, x));
    let ratio = radius.is(0.0).choose(Floats::splat(0.0), other / radius);
    let (sine, cosine) = sin_cos_within_eighth(Floats::splat(FRAC_PI_4) * ratio);
    let (near, far) = (radius * cosine, radius * sine);
    [is_horizontal.choose(near, far), is_horizontal.choose(far, near)]
}

#[inline(always)]
fn sin_cos_within_eighth<const N: usize>(angle: Floats<N>) -> (Floats<N>, Floats<N>) {
    use raystream_shaders::math::angles::sin_cos_within_eighth as one;
    (floats(|lane| one(angle.0[lane]).0), floats(|lane| one(angle.0[lane]).1))
}

#[inline(always)]
fn tangent_frame<const N: usize>(n: Vectors<N>) -> (Vectors<N>, Vectors<N>) {
    let sign = floats(|lane| if n.z.0[lane] < 0.0 { -1.0 } else { 1.0 });
    let a = Floats::splat(-1.0) / (sign + n.z);
    let b = n.x * n.y * a;
    let tangent =
        Vectors { x: Floats::splat(1.0) + sign * n.x * n.x * a, y: sign * b, z: -sign * n.x };
    let bitangent = Vectors { x: b, y: sign + n.y * n.y * a, z: -n.y };
    (tangent, bitangent)
}

/// [`raystream_shaders::math::power_heuristic`].
#[inline(always)]
pub fn power_heuristic<const N: usize>(pdf: Floats<N>, other: Floats<N>) -> Floats<N> {
    let ratio = other / pdf;
    let weight = Floats::splat(1.0) / (Floats::splat(1.0) + ratio * ratio);
    floats(|lane| if pdf.0[lane] <= 0.0 { 0.0 } else { weight.0[lane] })
}

/// Lambert's density of `direction` about `normal`.
#[inline(always)]
pub fn diffuse_pdf<const N: usize>(normal: Vectors<N>, direction: Vectors<N>) -> Floats<N> {
    normal.dot(direction).max(Floats::splat(0.0)) * std::f32::consts::FRAC_1_PI
}
