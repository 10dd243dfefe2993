//! Exponentials, logarithms, powers and angles from sums, products and quotients alone, so that
//! they have the same bits wherever those have.
//!
//! The polynomials make the largest error least over their intervals. None makes a number that is
//! subnormal: devices differ in what becomes of these.

#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

use super::arithmetic::INFINITE;
use core::f32::consts::LOG2_E;

/// The upper part of the logarithm of 2: of so few bits that its product with an exponent is exact.
const LN_2_HIGH: f32 = 0.693_359_4;
/// What that lacks.
const LN_2_LOW: f32 = -2.121_944_4e-4;
/// Above this an exponential is infinite.
const LARGEST_EXPONENT: f32 = 88.722_83;
/// Below this it is less than the smallest ordinary number, but for a part in 20 000 of that, and
/// is taken for 0.
const SMALLEST_EXPONENT: f32 = -87.336_5;

/// `e^x`, to 1.1 units in its last place; 0 where it would be subnormal.
#[cfg_attr(target_arch = "spirv", inline(never))]
pub fn exp(x: f32) -> f32 {
    exp_of_sum(x, 0.0)
}

/// The natural logarithm of `x`, to 1.1 units in its last place: minus infinity at 0 and at
/// subnormal numbers, no number below.
#[cfg_attr(target_arch = "spirv", inline(never))]
pub fn ln(x: f32) -> f32 {
    let (high, low) = ln_as_sum(x);
    high + low
}

/// `x^y` for an `x` of at least 0, to two units in its last place, and a quarter of one for
/// each unit of `y`; 0 where it would be subnormal, and
/// where `x` is. No number where `x` is below 0.
#[cfg_attr(target_arch = "spirv", inline(never))]
pub fn pow(x: f32, y: f32) -> f32 {
    if y == 0.0 || x == 1.0 {
        return 1.0;
    }
    if x < f32::MIN_POSITIVE || x.to_bits() == INFINITE {
        // Zero or infinity to a power, or what is no number.
        let is_large = (x > 1.0) == (y > 0.0);
        return if x < 0.0 {
            no_number(x)
        } else if is_large {
            infinite(x)
        } else {
            0.0
        };
    }
    let (high, low) = ln_as_sum(x);
    // The product of the upper parts without an error: each half of a factor has 12 bits.
    let (y_high, high_high) = (upper_half(y), upper_half(high));
    let (y_low, high_low) = (y - y_high, high - high_high);
    let product = y_high * high_high;
    let rest = y_high * high_low + y_low * high_high + (y_low * high_low + y * low);
    if product > 2.0 * LARGEST_EXPONENT {
        infinite(x)
    } else if product < 2.0 * SMALLEST_EXPONENT {
        0.0
    } else {
        exp_of_sum(product, rest)
    }
}

/// The angle of the point `(x, y)` from the axis `x`, in [-pi, pi], to 2.4 units in its last place;
/// as the function `atan2` of IEEE 754 has it, but for points whose quotient is subnormal.
#[cfg_attr(target_arch = "spirv", inline(never))]
pub fn arc_tangent(y: f32, x: f32) -> f32 {
    let (across, ahead) = (y.abs(), x.abs());
    let is_steep = across > ahead;
    let (short, long) = if is_steep { (ahead, across) } else { (across, ahead) };
    let ratio = if short == long { of_equals(long) } else { short / long };
    // Beyond the tangent of pi / 8 the angle is told from pi / 4.
    let is_beyond = ratio > 0.414_213_56;
    let t = if ratio == 1.0 {
        0.0
    } else if is_beyond {
        (short - long) / (short + long)
    } else {
        ratio
    };
    let z = t * t;
    let terms = ((8.053_744_5e-2 * z - 1.387_768_6e-1) * z + 1.997_771_1e-1) * z - 3.333_295e-1;
    let angle = terms * z * t + t;
    let eighths = if is_beyond { 1.0 } else { 0.0 };
    let (eighths, angle) = if is_steep { (2.0 - eighths, -angle) } else { (eighths, angle) };
    let (eighths, angle) =
        if is_below_zero(x) { (4.0 - eighths, -angle) } else { (eighths, angle) };
    with_sign_of(y, eighths * EIGHTH_HIGH + (eighths * EIGHTH_LOW + angle))
}

/// The upper part of an eighth of a turn, of so few bits that its multiples are exact.
const EIGHTH_HIGH: f32 = 0.785_156_25;
/// What that lacks.
const EIGHTH_LOW: f32 = 2.419_134e-4;

/// The quotient of two equal numbers, also infinite ones; of two zeros 0.
fn of_equals(number: f32) -> f32 {
    if number == 0.0 { 0.0 } else { 1.0 }
}

/// Whether a number or a zero has the sign of those below 0.
fn is_below_zero(x: f32) -> bool {
    x.to_bits() >> 31 == 1
}

/// `magnitude`, of at least 0, with the sign of `signed`.
fn with_sign_of(signed: f32, magnitude: f32) -> f32 {
    f32::from_bits(magnitude.to_bits() | signed.to_bits() & 1 << 31)
}

/// The upper 12 bits of a mantissa: products of two such halves are exact.
fn upper_half(x: f32) -> f32 {
    f32::from_bits(x.to_bits() & !0xfff)
}

/// Infinity, as no constant: WGSL has none. `x` may be any number.
fn infinite(x: f32) -> f32 {
    f32::from_bits((x.to_bits() | INFINITE) & INFINITE)
}

/// No number, likewise.
fn no_number(x: f32) -> f32 {
    f32::from_bits(x.to_bits() | 0x7fc0_0000)
}

/// `e^(high + low)`, where `low` is small.
fn exp_of_sum(high: f32, low: f32) -> f32 {
    let sum = high + low;
    if sum > LARGEST_EXPONENT {
        return infinite(sum);
    }
    if sum < SMALLEST_EXPONENT {
        return 0.0;
    }
    let doublings = (sum * LOG2_E + 0.5).floor();
    let x = (high - doublings * LN_2_HIGH) - (doublings * LN_2_LOW - low);
    let terms = ((1.987_569_1e-4 * x + 1.398_199_9e-3) * x + 8.333_452e-3) * x + 4.166_579_6e-2;
    let terms = (terms * x + 1.666_666_5e-1) * x + 0.5;
    let near_one = terms * (x * x) + x + 1.0;
    // 2^128 alone is too large for a factor.
    let doublings = doublings as i32;
    let half = doublings >> 1;
    near_one * power_of_two(half) * power_of_two(doublings - half)
}

/// `2^exponent`, in the range of ordinary numbers.
fn power_of_two(exponent: i32) -> f32 {
    f32::from_bits(((exponent + 127) as u32) << 23)
}

/// The natural logarithm as a sum of two numbers, of which the second is small; its error is some
/// 1e-8 of a unit where `x` is near 1, and a part in 2^30 elsewhere.
fn ln_as_sum(x: f32) -> (f32, f32) {
    if x < f32::MIN_POSITIVE {
        return (if x < 0.0 { no_number(x) } else { -infinite(x) }, 0.0);
    }
    if x.to_bits() >= INFINITE {
        return (x, 0.0);
    }
    // x = mantissa 2^exponent, the mantissa from sqrt(1/2) to sqrt(2).
    let shifted = x.to_bits().wrapping_sub(0x3f35_04f3);
    let exponent = (shifted as i32 >> 23) as f32;
    let mantissa = f32::from_bits((shifted & 0x007f_ffff) + 0x3f35_04f3);
    let f = mantissa - 1.0;
    let z = f * f;
    let terms = ((7.037_683_6e-2 * f - 1.151_461e-1) * f + 1.167_699_87e-1) * f - 1.242_014_1e-1;
    let terms = ((terms * f + 1.424_932_3e-1) * f - 1.666_805_8e-1) * f + 2.000_071_5e-1;
    let terms = (terms * f - 2.499_999_4e-1) * f + 3.333_333e-1;
    // ln(1 + f) = f - z / 2 + ..., of which f is exact.
    let tail = f * z * terms - 0.5 * z;
    let whole = exponent * LN_2_HIGH;
    let high = whole + f;
    let lost = if exponent == 0.0 { 0.0 } else { f - (high - whole) };
    (high, tail + (exponent * LN_2_LOW + lost))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::random::hash;

    /// How far `found` is from `exact`, in units of the last place of the latter.
    fn units_off(found: f32, exact: f64) -> f64 {
        let unit = f64::from(f32::EPSILON) * 2_f64.powi(exact.abs().log2().floor() as i32);
        (f64::from(found) - exact).abs() / unit
    }

    /// The largest error of `found` over the inputs `x`, where the truth is an ordinary number.
    fn largest(
        inputs: impl Iterator<Item = f32>,
        found: impl Fn(f32) -> f32,
        exact: impl Fn(f64) -> f64,
    ) -> f64 {
        let ordinary = 1.0001 * f64::from(f32::MIN_POSITIVE)..f64::from(f32::MAX);
        let off = |x: f32| {
            let exact = exact(f64::from(x));
            if ordinary.contains(&exact.abs()) { units_off(found(x), exact) } else { 0.0 }
        };
        inputs.map(off).fold(0.0, f64::max)
    }

    fn by_chance() -> impl Iterator<Item = f32> {
        (0..4_000_000).map(|k| f32::from_bits(hash(k)))
    }

    fn unit_interval() -> impl Iterator<Item = f32> {
        (0..4_000_000).map(|k| (hash(k) >> 8) as f32 / (1u32 << 24) as f32)
    }

    #[test]
    fn exponentials_are_right_to_their_last_place() {
        let off = largest(by_chance(), exp, f64::exp);
        let near = largest(unit_interval().map(|x| 176.0 * (x - 0.5)), exp, f64::exp);
        assert!(off < 1.1 && near < 1.1, "{off} {near}");
    }

    #[test]
    fn logarithms_are_right_to_their_last_place() {
        let positive = || by_chance().map(f32::abs).filter(|x| x.is_normal());
        let off = largest(positive(), ln, f64::ln);
        let near = largest(unit_interval().map(|x| 0.5 + x), ln, f64::ln);
        assert!(off < 1.1 && near < 1.1, "{off} {near}");
    }

    #[test]
    fn powers_are_right_to_two_places_and_what_their_exponents_magnify() {
        for y in [2.4, 1.0 / 2.4, 2.0 / 3.0, -1.0, 0.5, 7.3, 250.0] {
            let exact = |x: f64| x.powf(f64::from(y));
            let off = largest(unit_interval(), |x| pow(x, y), exact);
            let ordinary = by_chance().map(f32::abs).filter(|x| x.is_normal());
            let wide = largest(ordinary, |x| pow(x, y), exact);
            let limit = 2.0 + 0.25 * f64::from(y.abs());
            assert!(off < limit && wide < limit, "to {y}: {off} {wide}");
        }
    }

    #[test]
    fn angles_are_right_to_three_places() {
        let off = |[x, y]: [f32; 2]| {
            let exact = f64::from(y).atan2(f64::from(x));
            let is_small = exact.abs() < f64::from(f32::MIN_POSITIVE) || !exact.is_finite();
            if is_small { 0.0 } else { units_off(arc_tangent(y, x), exact) }
        };
        let wide = (0..4_000_000).map(|k| [hash(k), hash(!k)].map(f32::from_bits));
        let alike = (0..4_000_000).map(|k| [hash(k), hash(!k)].map(|bits| bits as i32 as f32));
        let ordinary = |point: &[f32; 2]| point.iter().all(|x| x.abs() < 1e37 && x.abs() > 1e-37);
        let off = wide.chain(alike).filter(ordinary).map(off).fold(0.0, f64::max);
        assert!(off < 2.4, "{off}");
    }

    #[test]
    fn ends_and_edges_are_those_of_ieee() {
        let inf = f32::INFINITY;
        assert_eq!([exp(inf), exp(-inf), exp(0.0), exp(89.0)], [inf, 0.0, 1.0, inf]);
        assert_eq!([ln(0.0), ln(1.0), ln(inf)], [-inf, 0.0, inf]);
        assert!(exp(f32::NAN).is_nan() && ln(f32::NAN).is_nan() && ln(-1.0).is_nan());
        assert_eq!(
            [pow(0.0, 2.0), pow(0.0, -2.0), pow(inf, 2.0), pow(inf, -1.0)],
            [0.0, inf, inf, 0.0]
        );
        assert_eq!([pow(0.0, 0.0), pow(2.0, 200.0), pow(2.0, -200.0)], [1.0, inf, 0.0]);
        assert!(pow(-1.0, 2.0).is_nan() && pow(f32::NAN, 1.0).is_nan());
        for [x, y] in [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0], [inf, 1.0], [1.0, inf]] {
            for [x, y] in [[x, y], [-x, y], [x, -y], [-x, -y]] {
                assert_eq!(arc_tangent(y, x).to_bits(), f32::atan2(y, x).to_bits(), "{y} {x}");
            }
        }
    }

    #[test]
    fn nothing_is_subnormal() {
        for k in 0..2_000_000 {
            let [x, y] = [hash(k), hash(!k)].map(f32::from_bits);
            let x = if x.is_subnormal() { 1.0 } else { x };
            for found in [exp(x), exp(-87.0 - y.abs().fract()), ln(x), pow(x.abs(), y)] {
                assert!(!found.is_subnormal(), "{x:e} {y:e}: {found:e}");
            }
        }
    }
}
