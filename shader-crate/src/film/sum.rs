//! Sums of many numbers that keep their precision: Kahan's compensated summation, "Further Remarks
//! on Reducing Truncation Errors", CACM 8(1), 1965.
//!
//! A plain sum of `n` numbers has up to `n` roundings of itself: after ten million equal samples a
//! mean is off by percents, and the same way every time. A second word keeps what each addition
//! has rounded off, and gives it to the next. What is left are two roundings of the sum and
//! `n` squared ones: below 2^-22 of it after 2^24 numbers of one sign.
//!
//! # What a compiler may not know
//!
//! By the rules of real numbers what was rounded off is zero, and compilers of shaders may
//! calculate by these rules: `(sum + y) - sum` is `y`. So each result is hidden from them by a word
//! that is zero, and that they do not know to be: it comes out of memory with the number. Then
//! no two operations are left that could be made one or change places, on any device.

use crate::glam::Vec3;

/// Bits of the exponent of an f32, all of which are ones in infinities and NaN.
const EXPONENT: u32 = 0x7f80_0000;

/// Adds `value` to a sum, by component: `high` is the sum, `low` what it lacks. `zero` is zero, out
/// of memory. What is not finite makes `high` what a plain addition would make it.
#[inline(always)]
pub fn add(high: &mut Vec3, low: &mut Vec3, value: Vec3, zero: u32) {
    let value = hidden(*low + value, zero);
    let sum = hidden(*high + value, zero);
    let added = hidden(sum - *high, zero);
    *high = sum;
    *low = finite(value - added, sum);
}

/// `value`, unknown to a compiler.
#[inline(always)]
fn hidden(value: Vec3, zero: u32) -> Vec3 {
    let hide = |x: f32| f32::from_bits(x.to_bits() ^ zero);
    Vec3::new(hide(value.x), hide(value.y), hide(value.z))
}

/// The components of `low` whose sum is finite; zero for the others.
#[inline(always)]
fn finite(low: Vec3, sum: Vec3) -> Vec3 {
    let keep = |low: f32, sum: f32| if sum.to_bits() & EXPONENT == EXPONENT { 0.0 } else { low };
    Vec3::new(keep(low.x, sum.x), keep(low.y, sum.y), keep(low.z, sum.z))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::random::{hash, unit_float};

    #[test]
    fn sums_of_numbers_of_any_size_keep_their_precision() {
        for seed in 0..20 {
            // Mostly dim, at times brighter than all before together.
            let number = |k: u32| {
                let bits = hash(k ^ hash(seed));
                unit_float(bits) * f32::exp2(if bits & 0xfff == 0 { 20.0 } else { -(seed as f32) })
            };
            let (mut high, mut low, mut exact) = (Vec3::ZERO, Vec3::ZERO, 0.0_f64);
            for k in 0..1 << 18 {
                let value = number(k);
                add(&mut high, &mut low, Vec3::new(value, -value, 0.0), 0);
                exact += f64::from(value);
            }
            let error = (f64::from(high.x) - exact).abs() / exact;
            assert!(error < 3.0 * 2_f64.powi(-24), "{seed}: off by {error:e}");
            assert_eq!((high.y, high.z), (-high.x, 0.0));
        }
    }

    #[test]
    fn what_is_not_finite_stays() {
        let sum = |values: [f32; 3]| {
            let (mut high, mut low) = (Vec3::ZERO, Vec3::ZERO);
            for value in values {
                add(&mut high, &mut low, Vec3::splat(value), 0);
            }
            high.x
        };
        assert_eq!(sum([f32::INFINITY, 1.0, 2.0]), f32::INFINITY);
        assert_eq!(sum([f32::MAX, f32::MAX, 1.0]), f32::INFINITY);
        assert_eq!(sum([f32::NEG_INFINITY, 1.0, 2.0]), f32::NEG_INFINITY);
        assert!(sum([f32::NAN, 1.0, 2.0]).is_nan());
        assert!(sum([f32::INFINITY, f32::NEG_INFINITY, 2.0]).is_nan());
    }
}
