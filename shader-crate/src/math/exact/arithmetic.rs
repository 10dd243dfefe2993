//! Quotients and roots that are rounded correctly, whatever the device's own are: the device's are
//! taken for estimates, what they leave is found in integers, and the nearest neighbour is chosen.

#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

/// Bits of a number after the leading one of its mantissa.
pub(super) const FRACTION_BITS: u32 = 23;
/// Those bits.
pub(super) const FRACTION: u32 = (1 << FRACTION_BITS) - 1;
/// The leading one, which is not stored.
const LEADING: u32 = 1 << FRACTION_BITS;
/// The sign.
pub(super) const SIGN: u32 = 1 << 31;
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
        divide_any(a, b, mantissas_quotient)
    })
}

/// The square root of `a`, correctly rounded: that of IEEE 754.
///
/// The device's root of the mantissa may be off by as much as 8 units in its last place.
#[cfg_attr(target_arch = "spirv", inline(never))]
pub fn square_root(a: f32) -> f32 {
    f32::from_bits(root_any(a.to_bits(), |mantissa, doublings| {
        let estimate = (unit(mantissa) * (1 + doublings) as f32).sqrt();
        refine_root(mantissa, doublings, estimate)
    }))
}

/// [`square_root`] for bits of any kind, by the root of `mantissa 2^(23 + doublings)`.
pub(super) fn root_any(a: u32, mantissas_root: impl Fn(u32, u32) -> u32) -> u32 {
    let normal = normalised(a & !SIGN);
    // An even exponent is halved exactly.
    let unbiased = (normal >> FRACTION_BITS) - BIAS;
    let is_odd = unbiased & 1;
    let exponent = ((unbiased - is_odd) >> 1) + BIAS - 1;
    let root = mantissas_root(mantissa(normal as u32), is_odd as u32);
    let root = ((exponent as u32) << FRACTION_BITS).wrapping_add(root);
    let root = select(a > INFINITE, NO_NUMBER, root);
    select((a << 1 == 0) | (a == INFINITE), a, root)
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
pub(super) fn mantissa(bits: u32) -> u32 {
    bits & FRACTION | LEADING
}

/// A mantissa as a number in [1, 2).
pub(super) fn unit(mantissa: u32) -> f32 {
    f32::from_bits(mantissa & FRACTION | ONE)
}

/// The bits of a number without its sign as if exponents had no end below: a subnormal number has
/// its leading one, and an exponent of 0 or less. Zero has one that is less still.
fn normalised(bits: u32) -> i32 {
    // Units of subnormal numbers, of 2^-149.
    let units = (bits & FRACTION) as f32;
    let subnormal = units.to_bits() as i32 - (149 << FRACTION_BITS);
    select(bits < LEADING, subnormal as u32, bits) as i32
}

/// `yes` if `is` and `no` if not, without a branch: these are inlined wherever kernels divide.
fn select(is: bool, yes: u32, no: u32) -> u32 {
    let mask = 0u32.wrapping_sub(u32::from(is));
    yes & mask | no & !mask
}

/// The quotient of two mantissas, doubled where it is below 1.
pub(super) struct MantissaQuotient {
    /// It times 2^23, to the nearest integer: from 2^23 up to 2^24.
    pub rounded: u32,
    /// What that lacks, times the divisor: at most half of the divisor.
    pub remainder: i32,
    /// Whether it is doubled.
    pub is_doubled: bool,
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

/// [`divide`] for bits of any kind, by the quotient of two mantissas.
pub(super) fn divide_any(
    a: u32,
    b: u32,
    mantissas_quotient: impl Fn(u32, u32) -> MantissaQuotient,
) -> u32 {
    let sign = (a ^ b) & SIGN;
    let (a, b) = (a & !SIGN, b & !SIGN);
    let (normal_a, normal_b) = (normalised(a), normalised(b));
    let quotient = mantissas_quotient(mantissa(normal_a as u32), mantissa(normal_b as u32));
    let difference = (normal_a >> FRACTION_BITS) - (normal_b >> FRACTION_BITS);
    let exponent = difference + BIAS - i32::from(quotient.is_doubled);
    // It may round up to a power of two, and so to infinity.
    let ordinary =
        ((exponent as u32).wrapping_sub(1) << FRACTION_BITS).wrapping_add(quotient.rounded);
    let result = select(exponent > 0, ordinary, subnormal(&quotient, 1 - exponent));
    let result = select((a == 0) | (b == INFINITE), 0, result);
    let is_infinite = (exponent >= SPECIAL) | (b == 0) | (a == INFINITE);
    let result = sign | select(is_infinite, INFINITE, result);
    let is_none = (a == b) & ((a == 0) | (a == INFINITE));
    select(is_none | (a > INFINITE) | (b > INFINITE), NO_NUMBER, result)
}

/// The bits of a quotient that is halved `shift` times to be subnormal, rounded to even from the
/// quotient itself. It may round up to the smallest ordinary number.
fn subnormal(quotient: &MantissaQuotient, shift: i32) -> u32 {
    // Those that lose more have nothing left.
    let shift = (shift.max(1) as u32).min(27);
    let below = quotient.rounded - u32::from(quotient.remainder < 0);
    // A last bit says that there is more.
    let doubled = below << 1 | u32::from(quotient.remainder != 0);
    let is_odd = doubled >> (shift + 1) & 1;
    (doubled + (1 << shift) - 1 + is_odd) >> (shift + 1)
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
