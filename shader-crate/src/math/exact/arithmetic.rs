//! Quotients and roots that are rounded correctly, whatever the device's own are: the device's are
//! taken for estimates, what they leave is found in integers, and the nearest neighbour is chosen.

#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

/// Bits of a number after the leading one of its mantissa.
const FRACTION_BITS: u32 = 23;
/// Those bits.
const FRACTION: u32 = (1 << FRACTION_BITS) - 1;
/// The leading one, which is not stored.
const LEADING: u32 = 1 << FRACTION_BITS;
/// The sign.
const SIGN: u32 = 1 << 31;
/// The exponent of 1, as it is stored.
const BIAS: i32 = 127;
/// The exponent of infinities and of what is no number, as it is stored.
const SPECIAL: i32 = 255;
/// Infinity.
pub(super) const INFINITE: u32 = (SPECIAL as u32) << FRACTION_BITS;
/// No number.
const NO_NUMBER: u32 = INFINITE | 1 << (FRACTION_BITS - 1);

/// The quotient `a / b`, correctly rounded: that of IEEE 754, subnormal numbers too.
///
/// The device's reciprocal of a mantissa may be off by as much as 4 units in its last place.
#[cfg_attr(target_arch = "spirv", inline(never))]
pub fn divide(a: f32, b: f32) -> f32 {
    let (a, b) = (a.to_bits(), b.to_bits());
    let (exponent_a, exponent_b) = (exponent(a), exponent(b));
    let difference = exponent_a - exponent_b;
    // Ordinary operands, and a quotient that is ordinary whichever way it is rounded.
    let is_ordinary = is_exponent(exponent_a)
        && is_exponent(exponent_b)
        && is_exponent(difference + BIAS - 1)
        && is_exponent(difference + BIAS + 1);
    f32::from_bits(if is_ordinary {
        let quotient = mantissas_quotient(mantissa(a), mantissa(b));
        // One less, since the mantissa's leading one counts as one more.
        let exponent = difference + BIAS - 1 - i32::from(quotient.is_doubled);
        (a ^ b) & SIGN | (((exponent as u32) << FRACTION_BITS) + quotient.rounded)
    } else {
        divide_any(a, b)
    })
}

/// The square root of `a`, correctly rounded: that of IEEE 754.
///
/// The device's root of the mantissa may be off by as much as 8 units in its last place.
#[cfg_attr(target_arch = "spirv", inline(never))]
pub fn square_root(a: f32) -> f32 {
    let a = a.to_bits();
    let stored = exponent(a);
    f32::from_bits(if is_exponent(stored) && a & SIGN == 0 {
        root(mantissa(a), stored)
    } else if a << 1 == 0 || a == INFINITE {
        a
    } else if a & SIGN == 0 && stored == 0 {
        let (mantissa, exponent) = normalised(a & FRACTION);
        root(mantissa, exponent)
    } else {
        NO_NUMBER
    })
}

/// A stored exponent.
fn exponent(bits: u32) -> i32 {
    (bits >> FRACTION_BITS & SPECIAL as u32) as i32
}

/// Whether it is that of an ordinary number: neither zero, subnormal, infinite or no number.
fn is_exponent(stored: i32) -> bool {
    ((stored - 1) as u32) < SPECIAL as u32 - 1
}

/// The mantissa of an ordinary number, of 24 bits.
fn mantissa(bits: u32) -> u32 {
    bits & FRACTION | LEADING
}

/// A mantissa as a number in [1, 2).
fn unit(mantissa: u32) -> f32 {
    f32::from_bits(mantissa & FRACTION | ONE)
}

/// The mantissa of 24 bits of a subnormal number that is not zero, and the exponent that would be
/// stored with it, of at most 0.
fn normalised(fraction: u32) -> (u32, i32) {
    let shift = fraction.leading_zeros() - (31 - FRACTION_BITS);
    (fraction << shift, 1 - shift as i32)
}

/// The quotient of two mantissas, doubled where it is below 1.
struct MantissaQuotient {
    /// It times 2^23, to the nearest integer: from 2^23 up to 2^24.
    rounded: u32,
    /// What that lacks, times the divisor: at most half of the divisor.
    remainder: i32,
    /// Whether it is doubled.
    is_doubled: bool,
}

/// See [`MantissaQuotient`].
fn mantissas_quotient(a: u32, b: u32) -> MantissaQuotient {
    refine_quotient(a, b, 1.0 / unit(b))
}

/// The same from an estimate of `2^23 / b`.
fn refine_quotient(a: u32, b: u32, reciprocal: f32) -> MantissaQuotient {
    let is_doubled = a < b;
    let estimate = (unit(a) * reciprocal).to_bits();
    // Bits of a number from 1 to 2 are its place among these, so 2^23 is that of 1; if doubled, it
    // is that of 1/2.
    let (shift, first) = if is_doubled { (FRACTION_BITS + 1, HALF) } else { (FRACTION_BITS, ONE) };
    let near = estimate.wrapping_sub(first).wrapping_add(LEADING);
    // The upper bits of both terms are the same, since the remainder is small: they need not be
    // there.
    let remainder = (a << shift).wrapping_sub(near.wrapping_mul(b)) as i32;
    let whole = nearest(remainder as f32 * (reciprocal * (1.0 / LEADING as f32)));
    let near = near.wrapping_add(whole as u32);
    let remainder = remainder.wrapping_sub(whole.wrapping_mul(b as i32));
    // Nearly half of the divisor may be either side of it. There is no tie: a quotient of two
    // mantissas never lies in the middle of two others.
    let step = i32::from(2 * remainder > b as i32) - i32::from(2 * remainder < -(b as i32));
    MantissaQuotient {
        rounded: near.wrapping_add(step as u32),
        remainder: remainder - step * b as i32,
        is_doubled,
    }
}

/// The bits of 1.
const ONE: u32 = (BIAS as u32) << FRACTION_BITS;
/// The bits of 1/2.
const HALF: u32 = (BIAS as u32 - 1) << FRACTION_BITS;

/// The integer nearest to a small number: the sum has no bits for less than 1.
fn nearest(x: f32) -> i32 {
    const MAGIC: f32 = 12_582_912.0;
    (x + MAGIC).to_bits().wrapping_sub(MAGIC.to_bits()) as i32
}

/// [`divide`] for bits of any kind.
fn divide_any(a: u32, b: u32) -> u32 {
    let sign = (a ^ b) & SIGN;
    let (a, b) = (a & !SIGN, b & !SIGN);
    if a > INFINITE || b > INFINITE || (a == INFINITE && b == INFINITE) || (a == 0 && b == 0) {
        NO_NUMBER
    } else if a == INFINITE || b == 0 {
        sign | INFINITE
    } else if b == INFINITE || a == 0 {
        sign
    } else {
        let (mantissa_a, exponent_a) = any_mantissa(a);
        let (mantissa_b, exponent_b) = any_mantissa(b);
        let quotient = mantissas_quotient(mantissa_a, mantissa_b);
        let exponent = exponent_a - exponent_b + BIAS - i32::from(quotient.is_doubled);
        sign | if exponent >= SPECIAL {
            INFINITE
        } else if exponent > 0 {
            // It may round up to a power of two, and so to infinity.
            ((exponent as u32 - 1) << FRACTION_BITS) + quotient.rounded
        } else {
            subnormal(&quotient, (1 - exponent) as u32)
        }
    }
}

/// Mantissa and exponent of a number that is not zero, infinite, or no number.
fn any_mantissa(bits: u32) -> (u32, i32) {
    if exponent(bits) > 0 { (mantissa(bits), exponent(bits)) } else { normalised(bits & FRACTION) }
}

/// The bits of a quotient that is halved `shift` times to be subnormal, rounded to even from the
/// quotient itself. It may round up to the smallest ordinary number.
fn subnormal(quotient: &MantissaQuotient, shift: u32) -> u32 {
    if shift > FRACTION_BITS + 2 {
        return 0;
    }
    let below = quotient.rounded - u32::from(quotient.remainder < 0);
    let is_inexact = quotient.remainder != 0;
    let (kept, lost) = (below >> shift, below & ((1 << shift) - 1));
    let half = 1 << (shift - 1);
    let rounds_up = lost > half || (lost == half && (is_inexact || kept & 1 == 1));
    kept + u32::from(rounds_up)
}

/// The bits of the root of a number of this mantissa and stored exponent.
fn root(mantissa: u32, stored: i32) -> u32 {
    // An even exponent is halved exactly.
    let is_odd = (stored - BIAS) & 1;
    let estimate = (unit(mantissa) * (1 + is_odd) as f32).sqrt();
    let half = (stored - BIAS - is_odd) >> 1;
    (((half + BIAS - 1) as u32) << FRACTION_BITS) + refine_root(mantissa, is_odd as u32, estimate)
}

/// The root of `mantissa 2^(23 + doublings)` to the nearest integer, from 2^23 up to 2^24, by an
/// estimate of that of the mantissa as a number in [1, 4).
fn refine_root(mantissa: u32, doublings: u32, estimate: f32) -> u32 {
    let near = estimate.to_bits() - ONE + LEADING;
    let square = mantissa << (FRACTION_BITS + doublings);
    let remainder = square.wrapping_sub(near.wrapping_mul(near)) as i32;
    let near = near
        .wrapping_add(nearest(remainder as f32 * (1.0 / (2.0 * LEADING as f32) / estimate)) as u32);
    let remainder = square.wrapping_sub(near.wrapping_mul(near)) as i32;
    // The middle of two neighbours, (near + 1/2)^2, is a quarter above near^2 + near.
    let step = i32::from(remainder > near as i32) - i32::from(remainder <= -(near as i32));
    near.wrapping_add(step as u32)
}

#[cfg(test)]
mod tests {
    use super::super::bits::{beside, is_same};
    use super::*;
    use crate::math::random::hash;

    /// Numbers at whose edges things go wrong.
    fn edges() -> std::vec::Vec<u32> {
        let around = |bits: u32| (-3..=3).map(move |off: i32| bits.wrapping_add_signed(off));
        let powers = (0..=255u32).flat_map(|exponent| around(exponent << FRACTION_BITS));
        let edges: std::vec::Vec<_> = powers.chain(around(1)).chain(around(LEADING / 2)).collect();
        edges.iter().copied().chain(edges.iter().map(|bits| bits | SIGN)).collect()
    }

    #[test]
    fn a_billion_quotients_are_the_processors() {
        const BILLION: u32 = 1_000_000_000;
        let edges = edges();
        let by_chance = (0..BILLION).map(|k| [hash(k), hash(k ^ 0x5eed_5eed)]);
        // Quotients of any exponent: also those that are subnormal.
        let pairs = edges.iter().flat_map(|&a| edges.iter().step_by(7).map(move |&b| [a, b]));
        for [a, b] in pairs.chain(by_chance).map(|pair| pair.map(f32::from_bits)) {
            assert!(is_same(divide(a, b), a / b), "{a:e} / {b:e}: {:e}", divide(a, b));
        }
    }

    #[test]
    fn quotients_are_right_from_any_estimate_that_vulkan_allows() {
        for k in 0..500_000u32 {
            let [a, b] = [hash(k), hash(!k)].map(mantissa);
            let exact = mantissas_quotient(a, b).rounded;
            for off in -4..=4 {
                let found = refine_quotient(a, b, beside(1.0 / unit(b), off)).rounded;
                assert_eq!(found, exact, "{a} / {b}, {off} units off");
            }
        }
    }

    #[test]
    fn roots_are_right_from_any_estimate_that_vulkan_allows() {
        for k in 0..1_000_000u32 {
            let (mantissa, doublings) = (mantissa(hash(k)), k & 1);
            let near = (unit(mantissa) * (1 + doublings) as f32).sqrt();
            let exact = refine_root(mantissa, doublings, near);
            for off in -8..=8 {
                let found = refine_root(mantissa, doublings, beside(near, off));
                assert_eq!(found, exact, "{mantissa} {doublings}, {off} units off");
            }
        }
    }

    #[test]
    fn all_roots_are_the_processors() {
        for bits in 0..=u32::MAX {
            let a = f32::from_bits(bits);
            assert!(is_same(square_root(a), a.sqrt()), "root of {a:e}");
        }
    }
}
