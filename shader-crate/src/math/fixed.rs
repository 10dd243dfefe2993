//! Sums that no order can change: integers of 128 bits, in units of a power of two.
//!
//! Sums of floats depend on who comes first, and lose more the longer they get. Addition modulo
//! 2^128 commutes and loses nothing. The conversion of a number is a pure function of its bits, in
//! integers throughout. So the same numbers give the same sum, bit for bit, on every device, in
//! every order and however they are cut into parts.
//!
//! # Why 128 bits
//!
//! The unit is 2^-64 of the brightest light's radiance `E` (see [`unit_exponent`]), so that no scene
//! is too bright or too dim: half a unit is what a number may lose by rounding, and what is dimmer
//! than the brightest light by 2^-40 keeps all its 24 bits. Numbers have at most [`BITS`] bits,
//! 2^43 `E`, so that 2^21 of the largest can be added; of numbers that are no larger than `E` on
//! average as many as there can be.
//!
//! Squares go down further: their unit is 2^-80 of `E` squared. Larger ones than 2^25 of that may be
//! cut to between this and 2^27, which is a lower bound for the spread of numbers above 2^12 `E`.

use crate::glam::UVec4;
use crate::math::wide::{Wide, square_of_24_bits};
use crate::memory::access::Atomics;

/// The unit is this many powers of two below the brightest light's radiance.
pub const UNIT_BITS: i32 = 64;
/// The unit of squares is this many powers of two above the square of the unit.
const SQUARE_UNIT_BITS: i32 = 48;
/// Bits of a number that may be added to a sum.
pub const BITS: i32 = 107;
/// Words of a sum, the lowest first.
pub const WORDS: u32 = 4;

/// Bits of a mantissa.
const MANTISSA_BITS: i32 = 24;
/// What is added to the exponent in the bits of an `f32` whose mantissa is read as an integer.
const MANTISSA_EXPONENT: i32 = 150;
/// What is added to the exponent in the bits of an `f32`.
const EXPONENT_BIAS: i32 = 127;

/// The exponent of the unit where lights emit at most `brightest`, by component: finite and from 0
/// on.
pub fn unit_exponent(brightest: f32) -> i32 {
    (brightest.to_bits() >> 23) as i32 - EXPONENT_BIAS - UNIT_BITS
}

/// The exponent of the unit of squares.
pub fn square_unit_exponent(unit_exponent: i32) -> i32 {
    2 * unit_exponent + SQUARE_UNIT_BITS
}

/// A number to be added, in units.
#[cfg_attr(not(target_arch = "spirv"), derive(Debug, PartialEq))]
#[derive(Clone, Copy)]
pub struct Fixed {
    /// The words, the lowest first.
    pub words: UVec4,
    /// Whether the number is one from 0 on of at most [`BITS`] bits. If not, the words are those of
    /// the nearest such number, of 0 for NaN.
    pub fits: bool,
}

impl Fixed {
    /// The nearest whole number of units of 2 to the power of `unit_exponent`. Denormal numbers,
    /// which a GPU may have flushed, are 0 everywhere, as is -0.
    #[inline(always)]
    pub fn new(value: f32, unit_exponent: i32) -> Self {
        Self::of_bits(value, unit_exponent, BITS)
    }

    /// The same of a sum, which may have a bit less than all.
    #[cfg(not(target_arch = "spirv"))]
    pub fn of_sum(sum: f32, unit_exponent: i32) -> Self {
        Self::of_bits(sum, unit_exponent, 32 * WORDS as i32 - 1)
    }

    #[inline(always)]
    fn of_bits(value: f32, unit_exponent: i32, bits: i32) -> Self {
        let float = Float::of(value);
        let shift = float.exponent - unit_exponent;
        let largest = bits - MANTISSA_BITS;
        let words = shifted(Wide { high: 0, low: float.mantissa }, shift.min(largest));
        Self { words, fits: float.is_number && (shift <= largest || float.mantissa == 0) }
    }
}

/// The square of `value`, in units of 2 to the power of [`square_unit_exponent`]: the nearest whole
/// number, of at most [`BITS`] bits; 0 where [`Fixed::new`] gives 0 for a number.
#[inline(always)]
pub fn square(value: f32, unit_exponent: i32) -> UVec4 {
    let float = Float::of(value);
    let shift = 2 * float.exponent - square_unit_exponent(unit_exponent);
    let product = square_of_24_bits(float.mantissa);
    shifted(product, shift.min(BITS - 2 * MANTISSA_BITS))
}

/// `mantissa * 2^exponent`, from 0 on.
struct Float {
    mantissa: u32,
    exponent: i32,
    is_number: bool,
}

impl Float {
    /// Infinity is the largest mantissa at the largest exponent; what is negative or NaN is 0.
    #[inline(always)]
    fn of(value: f32) -> Self {
        let bits = value.to_bits();
        let exponent = bits >> 23;
        let is_zero = exponent & 0xff == 0;
        let is_number = is_zero || exponent < 0xff;
        let is_counted = !is_zero && bits <= f32::INFINITY.to_bits();
        let mantissa = if is_counted { bits & 0x7f_ffff | 0x80_0000 } else { 0 };
        Self { mantissa, exponent: exponent as i32 - MANTISSA_EXPONENT, is_number }
    }
}

/// `number * 2^shift`, rounded to the nearest, halves up; modulo 2^128.
#[inline(always)]
fn shifted(number: Wide, shift: i32) -> UVec4 {
    if shift < 0 {
        let down = (-shift).min(63) as u32;
        let half = Wide { high: 0, low: 1 }.shifted_left(down - 1);
        let rounded = number.plus(half).shifted_right(down);
        return UVec4::new(rounded.low, rounded.high, 0, 0);
    }
    let (word, bit) = (shift as u32 / 32, shift as u32 % 32);
    // Shifts by 32, which are none, are made of two.
    let low = number.low << bit;
    let middle = number.high << bit | (number.low >> 1) >> (31 - bit);
    let high = (number.high >> 1) >> (31 - bit);
    if word == 0 {
        UVec4::new(low, middle, high, 0)
    } else if word == 1 {
        UVec4::new(0, low, middle, high)
    } else if word == 2 {
        UVec4::new(0, 0, low, middle)
    } else {
        UVec4::new(0, 0, 0, low)
    }
}

/// `a + b`, modulo 2^128.
#[inline(always)]
pub fn add(a: UVec4, b: UVec4) -> UVec4 {
    let x = a.x.wrapping_add(b.x);
    let (y, carry_y) = add_carried(a.y, b.y, (x < b.x) as u32);
    let (z, carry_z) = add_carried(a.z, b.z, carry_y);
    UVec4::new(x, y, z, a.w.wrapping_add(b.w).wrapping_add(carry_z))
}

/// `a + b + carry`, and what it carries.
#[inline(always)]
fn add_carried(a: u32, b: u32, carry: u32) -> (u32, u32) {
    let sum = a.wrapping_add(b);
    let carried = sum.wrapping_add(carry);
    (carried, (sum < b || carried < carry) as u32)
}

/// Adds to the sum whose words begin at `first`, which other lanes may add to at the same time:
/// whoever makes a word overflow carries into the next, so once all have added, the words are those
/// of the sum.
pub fn add_atomic(sums: &mut Atomics<'_>, first: u32, value: UVec4) {
    let carry = add_word(sums, first, value.x);
    let carry = add_word(sums, first + 1, value.y) + add_word(sums, first + 1, carry);
    let carry = add_word(sums, first + 2, value.z) + add_word(sums, first + 2, carry);
    add_word(sums, first + 3, value.w.wrapping_add(carry));
}

/// Adds to a word; what there is to carry, 0 or 1. Most words of a number are zero: 24 bits lie in
/// one or two of them.
fn add_word(sums: &mut Atomics<'_>, index: u32, value: u32) -> u32 {
    if value == 0 {
        return 0;
    }
    let before = sums.add(index, value);
    (before.wrapping_add(value) < before) as u32
}

/// The sum as a number, in the bits of an `f32`: the nearest one, halves up; 0 below the smallest
/// normal one. (They stay bits because there are languages in which infinity is no constant.)
pub fn to_float_bits(words: UVec4, unit_exponent: i32) -> u32 {
    // The highest word that is not zero, the one below it, and the place of its lowest bit.
    let (high, low, place) = if words.w != 0 {
        (words.w, words.z, 96)
    } else if words.z != 0 {
        (words.z, words.y, 64)
    } else if words.y != 0 {
        (words.y, words.x, 32)
    } else {
        (words.x, 0, 0)
    };
    if high == 0 {
        return 0;
    }
    let zeros = high.leading_zeros();
    let top = high << zeros | (low >> 1) >> (31 - zeros);
    // With the bit that is always there; rounded up to 2^24, it makes the exponent one more.
    let mantissa = (top >> 8) + (top >> 7 & 1);
    let exponent = place + 31 - zeros as i32 + unit_exponent + EXPONENT_BIAS;
    if exponent <= 0 {
        0
    } else if exponent >= 0xff {
        0x7f80_0000
    } else {
        ((exponent as u32) << 23) + (mantissa - 0x80_0000)
    }
}

/// The sum as an integer.
#[cfg(not(target_arch = "spirv"))]
pub fn to_integer(words: UVec4) -> u128 {
    words.to_array().into_iter().rev().fold(0, |number, word| number << 32 | u128::from(word))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::random::hash;

    fn to_float(words: UVec4, unit_exponent: i32) -> f32 {
        f32::from_bits(to_float_bits(words, unit_exponent))
    }

    /// Numbers of all sizes with units that suit them and some that do not.
    fn numbers() -> impl Iterator<Item = (f32, i32)> {
        (0..200_000_u32).filter_map(|k| {
            let value = f32::from_bits(hash(k) >> 1);
            let unit = value.log2() as i32 + (hash(k ^ 0x55aa) % 160) as i32 - 120;
            (value.is_finite() && value >= f32::MIN_POSITIVE).then_some((value, unit))
        })
    }

    /// `value / 2^exponent`.
    fn in_units(value: f64, exponent: i32) -> f64 {
        value * 2_f64.powi(-exponent / 2) * 2_f64.powi(-exponent - -exponent / 2)
    }

    #[test]
    fn conversion_rounds_to_the_nearest_unit() {
        let (mut fitting, mut others) = (0, 0);
        for (value, unit) in numbers() {
            let fixed = Fixed::new(value, unit);
            let exact = in_units(f64::from(value), unit);
            if exact >= 107_f64.exp2() {
                others += 1;
                assert!(!fixed.fits && to_integer(fixed.words) < 1 << 107, "{value} in 2^{unit}");
            } else {
                fitting += 1;
                // Both sides have 53 bits for 24 that count.
                let error = to_integer(fixed.words) as f64 - exact;
                assert!(fixed.fits && error.abs() <= 0.5, "{value} in 2^{unit}: {error}");
            }
        }
        assert!(fitting > 50_000 && others > 5000, "{fitting} fit, {others} do not");
        let units = |value: f32| to_integer(Fixed::new(value, 0).words);
        assert_eq!([0.0, -0.0, 0.49, 0.5, 1.49, 1.5].map(units), [0, 0, 0, 1, 1, 2]);
        assert_eq!(to_integer(Fixed::new(1e-40, -149).words), 0, "denormal numbers are 0");
    }

    #[test]
    fn what_is_no_number_does_not_fit() {
        for value in [f32::NAN, -f32::NAN, f32::NEG_INFINITY, -1.0, -1e-30] {
            assert_eq!(Fixed::new(value, -64), Fixed { words: UVec4::ZERO, fits: false });
            assert_eq!(square(value, -64), UVec4::ZERO);
        }
        assert!(!Fixed::new(f32::INFINITY, -64).fits && !Fixed::new(1e30, -64).fits);
        assert!([0.0, -0.0, 1e-40].map(|value| Fixed::new(value, -200).fits) == [true; 3]);
    }

    #[test]
    fn squares_round_and_stop_at_the_largest() {
        for (value, unit) in numbers() {
            let exact = in_units(f64::from(value).powi(2), square_unit_exponent(unit));
            let squared = to_integer(square(value, unit)) as f64;
            if exact >= 105_f64.exp2() {
                let range = 105_f64.exp2()..=107_f64.exp2().min(exact * 1.000_001);
                assert!(range.contains(&squared), "{value}: {squared} for {exact}");
            } else {
                let error = (squared - exact).abs();
                assert!(error <= 0.5, "{value} in 2^{unit}: {squared} for {exact}");
            }
        }
    }

    #[test]
    fn sums_carry() {
        let words =
            |number: u128| UVec4::from_array([0, 32, 64, 96].map(|shift| (number >> shift) as u32));
        let edges = [0, 1, u128::MAX, 1 << 64, (1 << 64) - 1, (1 << 96) - 1, 0xffff_ffff];
        // The edges, and random numbers.
        let number = |i: u32| {
            let random = || (0..4).fold(0, |n, j| n << 32 | u128::from(hash(4 * i + j)));
            edges.get(i as usize).copied().unwrap_or_else(random)
        };
        for (i, j) in (0..40).flat_map(|i| (0..40).map(move |j| (i, j))) {
            let (a, b) = (number(i), number(j));
            assert_eq!(to_integer(add(words(a), words(b))), a.wrapping_add(b));
            let cells = words(a).to_array().map(core::sync::atomic::AtomicU32::new);
            add_atomic(&mut Atomics::new(&cells), 0, words(b));
            let sum = UVec4::from_array(cells.map(core::sync::atomic::AtomicU32::into_inner));
            assert_eq!(to_integer(sum), a.wrapping_add(b), "by atomics");
        }
    }

    #[test]
    fn floats_come_back() {
        for (value, unit) in numbers() {
            let fixed = Fixed::new(value, unit);
            // Without roundings.
            if fixed.fits && value.log2() - unit as f32 > 24.0 {
                assert_eq!(to_float(fixed.words, unit), value, "in 2^{unit}");
            }
        }
        let float = |number: u32, unit| to_float(UVec4::new(number, 0, 0, 0), unit);
        assert_eq!(float(0xff_ffff, 0), 16_777_215.0);
        assert_eq!(float(0x1ff_ffff, 0), 33_554_432.0, "rounded up to the next power");
        assert_eq!(to_float(UVec4::new(u32::MAX, 1, 0, 0), 0), 2_f32.powi(33));
        assert_eq!(to_float(UVec4::splat(u32::MAX), 0), f32::INFINITY);
        assert_eq!([float(1, -126), float(1, -127), float(0, 0)], [f32::MIN_POSITIVE, 0.0, 0.0]);
        assert_eq!(to_float(UVec4::new(0, 0, 0, 1), 31), 2_f32.powi(127));
    }

    #[test]
    fn the_unit_follows_the_brightest_light() {
        assert_eq!([1.0, 1.99, 2.0, 0.25].map(unit_exponent), [-64, -64, -63, -66]);
        for brightest in [f32::MIN_POSITIVE, 1e-20, 1.0, 1e20, f32::MAX] {
            let fixed = Fixed::new(brightest, unit_exponent(brightest));
            assert!((1 << 64..1 << 65).contains(&to_integer(fixed.words)), "{brightest}");
        }
    }
}
