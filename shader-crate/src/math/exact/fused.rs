//! Quotients and roots that are rounded correctly by devices whose `fma` rounds once: a third of the
//! steps that integers take.
//!
//! Markstein, "Computation of Elementary Functions on the IBM RISC System/6000 Processor", IBM
//! Journal of Research and Development 34(1), 1990: what an estimate leaves is exact in one `fma`,
//! and another one adds what it comes to, rounded once.

use super::arithmetic::{
    FRACTION, FRACTION_BITS, MantissaQuotient, SIGN, divide_any, mantissa, root_any, unit,
};
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

/// Exponents of operands, as they are stored, whose quotients and remainders all are ordinary
/// numbers: from this one on.
const FIRST: u32 = 64;
/// So many of them.
const COUNT: u32 = 126;

/// [`divide`](super::divide) where `fma` rounds once.
#[cfg_attr(target_arch = "spirv", inline(never))]
pub fn divide_fused(a: f32, b: f32) -> f32 {
    if is_moderate(a) & is_moderate(b) {
        quotient(a, b, reciprocal(b))
    } else {
        f32::from_bits(divide_any(a.to_bits(), b.to_bits(), mantissas_quotient))
    }
}

/// [`square_root`](super::square_root) where `fma` rounds once.
#[cfg_attr(target_arch = "spirv", inline(never))]
pub fn square_root_fused(a: f32) -> f32 {
    if is_moderate(a) & (a > 0.0) {
        root(a, inverse_root(a))
    } else {
        f32::from_bits(root_any(a.to_bits(), mantissas_root))
    }
}

fn is_moderate(x: f32) -> bool {
    (x.to_bits() >> 23 & 0xff).wrapping_sub(FIRST) < COUNT
}

/// `a / b` from an estimate of `1 / b`.
///
/// It is right if the reciprocal is the nearest number. Two steps find that from any estimate, but
/// for the largest mantissa: its reciprocal is so little above the middle of a power of two and the
/// next number that they find the former.
fn quotient(a: f32, b: f32, estimate: f32) -> f32 {
    let near = (-b).mul_add(estimate, 1.0).mul_add(estimate, estimate);
    let near = (-b).mul_add(near, 1.0).mul_add(near, near);
    let is_largest = ((b.to_bits() & FRACTION) + 1) >> FRACTION_BITS;
    let reciprocal = f32::from_bits(near.to_bits() | is_largest);
    let near = a * reciprocal;
    let near = (-b).mul_add(near, a).mul_add(reciprocal, near);
    (-b).mul_add(near, a).mul_add(reciprocal, near)
}

/// The root of `a` from an estimate of what 1 is over it.
fn root(a: f32, inverse: f32) -> f32 {
    let (near, half) = (a * inverse, 0.5 * inverse);
    let off = (-half).mul_add(near, 0.5);
    let (near, half) = (near.mul_add(off, near), half.mul_add(off, half));
    (-near).mul_add(near, a).mul_add(half, near)
}

/// An estimate of `1 / b`: a device's own quotient takes an H100 longer.
fn reciprocal(b: f32) -> f32 {
    let root = inverse_root(b.abs());
    f32::from_bits((root * root).to_bits() | (b.to_bits() & SIGN))
}

/// The device's own `1 / sqrt(a)`.
fn inverse_root(a: f32) -> f32 {
    #[cfg(target_arch = "spirv")]
    {
        let mut inverse = 0.0;
        // SAFETY: it computes one number from another one.
        unsafe {
            core::arch::asm!(
                "%functions = OpExtInstImport \"GLSL.std.450\"",
                "%a = OpLoad _ {a}",
                // InverseSqrt.
                "%inverse = OpExtInst typeof*{a} %functions 32 %a",
                "OpStore {inverse} %inverse",
                a = in(reg) &a,
                inverse = in(reg) &mut inverse,
            );
        }
        inverse
    }
    #[cfg(not(target_arch = "spirv"))]
    {
        1.0 / a.sqrt()
    }
}

/// The quotient of two mantissas as [`divide_any`] takes it.
fn mantissas_quotient(a: u32, b: u32) -> MantissaQuotient {
    let (dividend, divisor) = (unit(a), unit(b));
    let near = quotient(dividend, divisor, reciprocal(divisor));
    let remainder = (-divisor).mul_add(near, dividend);
    MantissaQuotient {
        rounded: mantissa(near.to_bits()),
        // Its sign is all that is wanted.
        remainder: i32::from(remainder > 0.0) - i32::from(remainder < 0.0),
        is_doubled: a < b,
    }
}

/// The root of a mantissa that is doubled so often, as [`root_any`] takes it.
fn mantissas_root(bits: u32, doublings: u32) -> u32 {
    let a = unit(bits) * (1 + doublings) as f32;
    mantissa(root(a, inverse_root(a)).to_bits())
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
            for off in -6..=6 {
                assert_eq!(quotient(a, b, beside(1.0 / b, off)), a / b, "{a:e} / {b:e}, {off}");
            }
        }
        // Divisors whose reciprocals are hardest to round.
        for k in 0..100_000 {
            for below in 0..64 {
                let [a, b] = [hash(k), 0x00ff_ffff - below].map(moderate);
                let off = (hash(!k) % 13) as i32 - 6;
                let found = quotient(a, b, beside(1.0 / b, off));
                assert_eq!(found, a / b, "{a:e} / {b:e}, {off}");
            }
        }
    }

    #[test]
    fn reciprocals_of_all_mantissas_are_right_from_any_estimate() {
        for k in 0..1 << 23 {
            let b = moderate(k);
            for off in -6..=6 {
                let found = quotient(1.0, b, beside(1.0 / b, off));
                assert_eq!(found, 1.0 / b, "1 / {b:e}, {off}");
            }
        }
    }

    #[test]
    fn roots_are_right_from_any_estimate_that_vulkan_allows() {
        for k in 0..1 << 24 {
            let a = moderate(k);
            let off = (hash(k) % 9) as i32 - 4;
            assert_eq!(
                root(a, beside(inverse_root(a), off)),
                a.sqrt(),
                "root of {a:e}, {off} units off"
            );
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
