//! Quotients and roots that are rounded correctly by devices whose `fma` rounds once: a third of the
//! steps that integers take.
//!
//! Markstein, "Computation of Elementary Functions on the IBM RISC System/6000 Processor", IBM
//! Journal of Research and Development 34(1), 1990: what an estimate leaves is exact in one `fma`,
//! and another one adds what it comes to, rounded once.

use super::arithmetic;
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

/// Exponents of operands, as they are stored, whose quotients and remainders all are ordinary
/// numbers: from this one on.
const FIRST: u32 = 64;
/// So many of them.
const COUNT: u32 = 126;

/// [`arithmetic::divide`] where `fma` rounds once.
#[cfg_attr(target_arch = "spirv", inline(never))]
pub fn divide_fused(a: f32, b: f32) -> f32 {
    if is_moderate(a) && is_moderate(b) {
        quotient(a, b, 1.0 / b)
    } else {
        arithmetic::divide(a, b)
    }
}

/// [`arithmetic::square_root`] where `fma` rounds once.
#[cfg_attr(target_arch = "spirv", inline(never))]
pub fn square_root_fused(a: f32) -> f32 {
    if is_moderate(a) && a > 0.0 { root(a, a.sqrt()) } else { arithmetic::square_root(a) }
}

fn is_moderate(x: f32) -> bool {
    (x.to_bits() >> 23 & 0xff).wrapping_sub(FIRST) < COUNT
}

/// `a / b` from an estimate of `1 / b`.
fn quotient(a: f32, b: f32, reciprocal: f32) -> f32 {
    let reciprocal = (-b).mul_add(reciprocal, 1.0).mul_add(reciprocal, reciprocal);
    let near = a * reciprocal;
    let near = (-b).mul_add(near, a).mul_add(reciprocal, near);
    (-b).mul_add(near, a).mul_add(reciprocal, near)
}

/// The root of `a` from an estimate.
fn root(a: f32, estimate: f32) -> f32 {
    let near = (-estimate).mul_add(estimate, a).mul_add(0.5 / estimate, estimate);
    let remainder = (-near).mul_add(near, a);
    // The middle between it and the number above is half a unit u away: its square is more by the
    // root times u, but for a quarter of u^2, of which the remainder is a multiple. So below, where
    // the unit of a power of two is half as large.
    let unit = |bits: u32| f32::from_bits((bits & 0x7f80_0000).wrapping_sub(23 << 23));
    let (above, below) = (near * unit(near.to_bits()), near * unit(near.to_bits() - 1));
    let step = i32::from(remainder > above) - i32::from(remainder <= -below);
    f32::from_bits(near.to_bits().wrapping_add(step as u32))
}

#[cfg(test)]
mod tests {
    use super::super::bits::{beside, is_same};
    use super::*;
    use crate::math::random::hash;

    /// From 1 to 4.
    fn moderate(bits: u32) -> f32 {
        f32::from_bits(0x3f80_0000 + (bits & 0x00ff_ffff))
    }

    #[test]
    fn quotients_are_right_from_any_estimate_that_vulkan_allows() {
        for k in 0..200_000 {
            let [a, b] = [hash(k), hash(!k)].map(moderate);
            for off in -3..=3 {
                assert_eq!(quotient(a, b, beside(1.0 / b, off)), a / b, "{a:e} / {b:e}, {off}");
            }
        }
        // Divisors whose reciprocals are hardest to round.
        for k in 0..200_000 {
            let [a, b] = [hash(k), 0x00ff_ffff - k % 64].map(moderate);
            assert_eq!(quotient(a, b, 1.0 / b), a / b, "{a:e} / {b:e}");
        }
    }

    #[test]
    fn roots_are_right_from_any_estimate_that_vulkan_allows() {
        for k in 0..1 << 24 {
            let a = moderate(k);
            let off = (hash(k) % 11) as i32 - 5;
            assert_eq!(root(a, beside(a.sqrt(), off)), a.sqrt(), "root of {a:e}, {off} units off");
        }
    }

    #[test]
    fn operands_of_all_sizes_are_the_processors() {
        for k in 0..2_000_000 {
            let [a, b] = [hash(k), hash(!k)].map(f32::from_bits);
            let (found, expected) = (divide_fused(a, b), a / b);
            assert!(is_same(found, expected), "{a:e} / {b:e}: {found:e}");
            let (found, expected) = (square_root_fused(a), a.sqrt());
            assert!(is_same(found, expected), "root of {a:e}: {found:e}");
        }
    }
}
