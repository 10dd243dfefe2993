//! The splat film: what lands on pixels from elsewhere, as sums that no order can change.
//!
//! Light tracing finds its pixel last, so many lanes may add to one pixel at once. Sums of floats
//! would depend on who comes first. Here a component is an integer of 96 bits, in units of a power
//! of two, and lanes add by atomics: addition modulo 2^96 commutes. The conversion of a splat is a
//! pure function of its bits, so the same splats give the same film, bit for bit, on every device.
//!
//! # Why 96 bits
//!
//! The host takes the unit to be 2^-44 of the brightest light's radiance `E`, so that no scene is
//! too bright or too dim. Half a unit is what a splat may lose by rounding. A splat counts as at
//! most 2^40 `E` (2^84 units). Splats are not divided by the number of light paths before they are
//! added; so a pixel of radiance `L` holds `L` for every light path so far, and 2^44 of these fit
//! where `L` is 256 `E`. With words of 32 bits alone, in pairs, either the bright splats of few
//! light paths or the faint ones of many would be lost.
//!
//! ```text
//! words: rounds, splats cut off, 0, 0 | pixel 0: red low, middle, high, green ..., blue ... | ...
//! ```
//!
//! Pixels are row by row from the top.

use crate::glam::{UVec4, Vec3};
use crate::math::wide::Wide;
use crate::memory::access::{Atomics, at};
use crate::memory::device_struct;
use crate::memory::rows::{row, vector};
use crate::scene::camera::NO_PIXEL;

/// Rows of a list of splats before the first one. The first word of it is how many there are.
pub const FIRST_SPLAT: u32 = 1;

/// The word that counts rounds.
pub const ROUNDS: u32 = 0;
/// The word that counts components which were cut off at the largest that fits.
pub const CUT_OFF: u32 = 1;
/// Words before the first pixel.
pub const HEADER_WORDS: u32 = 4;
/// Words of a component, the lowest first.
pub const COMPONENT_WORDS: u32 = 3;
/// Words of a pixel.
pub const PIXEL_WORDS: u32 = 3 * COMPONENT_WORDS;

/// The unit is this many powers of two below the brightest light's radiance.
pub const UNIT_BITS: i32 = 44;
/// Bits that a mantissa is shifted up by, at most: it then has 84.
const MAX_SHIFT: i32 = 60;
/// What is added to the exponent in the bits of an `f32` whose mantissa is read as an integer.
const MANTISSA_EXPONENT: i32 = 150;

device_struct! {
    /// The parameters of [`add_splats`]. 16 bytes.
    pub struct SplatParams {
        /// Lanes. Each takes every `threads`-th splat.
        pub threads: u32,
        /// The unit is 2 to this power, see [`unit_exponent`].
        pub unit_exponent: i32,
        /// Unused; zero.
        pub pad0: u32,
        /// Unused; zero.
        pub pad1: u32,
    }
}

/// The exponent of the unit where lights emit at most `brightest`, by component: finite and above
/// 0.
pub fn unit_exponent(brightest: f32) -> i32 {
    (brightest.to_bits() >> 23) as i32 - 127 - UNIT_BITS
}

/// What one light vertex adds to a pixel.
#[cfg_attr(not(target_arch = "spirv"), derive(Debug, PartialEq))]
#[derive(Clone, Copy)]
pub struct Splat {
    /// Radiance times the number of light paths, linear Rec.709; from 0 on.
    pub radiance: Vec3,
    /// Number of the pixel, row by row from the top, or [`NO_PIXEL`].
    pub pixel: u32,
}

impl Splat {
    /// Of a vertex that the camera does not see.
    pub const NOTHING: Self = Self { radiance: Vec3::ZERO, pixel: NO_PIXEL };

    /// Its row in a list of splats.
    pub fn to_row(&self) -> UVec4 {
        row(self.radiance, self.pixel)
    }

    /// Unpacks the row.
    pub fn from_row(row: UVec4) -> Self {
        Self { radiance: vector(row), pixel: row.w }
    }
}

/// Kernel: adds a list of splats to the `film`, and one to its rounds.
pub fn add_splats(lane: u32, params: &SplatParams, splats: &[UVec4], film: &mut Atomics<'_>) {
    if lane == 0 {
        film.add(ROUNDS, 1);
    }
    let count = at(splats, 0).x;
    let mut index = lane;
    while index < count {
        let splat = Splat::from_row(at(splats, FIRST_SPLAT + index));
        if splat.pixel != NO_PIXEL {
            let first = HEADER_WORDS + splat.pixel * PIXEL_WORDS;
            add(film, first, Fixed::new(splat.radiance.x, params.unit_exponent));
            add(film, first + COMPONENT_WORDS, Fixed::new(splat.radiance.y, params.unit_exponent));
            add(
                film,
                first + 2 * COMPONENT_WORDS,
                Fixed::new(splat.radiance.z, params.unit_exponent),
            );
        }
        index += params.threads;
    }
}

/// A component in units.
#[cfg_attr(not(target_arch = "spirv"), derive(Debug, PartialEq))]
#[derive(Clone, Copy)]
pub struct Fixed {
    /// The upper 32 bits.
    pub high: u32,
    /// The lower 64.
    pub low: Wide,
    /// Whether it was more.
    pub is_cut_off: bool,
}

impl Fixed {
    const ZERO: Self = Self { high: 0, low: Wide::ZERO, is_cut_off: false };

    /// `value`, from 0 on and finite, rounded to units of 2 to the power of `unit_exponent`. In
    /// integers throughout: the result follows from the bits. Denormal numbers, which a GPU may
    /// have flushed, are 0 everywhere.
    pub fn new(value: f32, unit_exponent: i32) -> Self {
        let exponent = (value.to_bits() >> 23) as i32;
        if exponent == 0 {
            return Self::ZERO;
        }
        let mantissa = value.to_bits() & 0x7f_ffff | 0x80_0000;
        let shift = exponent - MANTISSA_EXPONENT - unit_exponent;
        if shift < 0 {
            let down = (-shift) as u32;
            let rounded = if down > 24 { 0 } else { (mantissa + (1 << (down - 1))) >> down };
            return Self { low: Wide { high: 0, low: rounded }, ..Self::ZERO };
        }
        let up = shift.min(MAX_SHIFT) as u32;
        let wide = Wide { high: 0, low: mantissa };
        Self {
            high: if up > 32 { wide.shifted_left(up - 32).high } else { 0 },
            low: wide.shifted_left(up),
            is_cut_off: shift > MAX_SHIFT,
        }
    }
}

/// Adds to the component at `first`. Whoever makes a word overflow carries into the next, so once
/// all have added, the words are those of the sum.
fn add(film: &mut Atomics<'_>, first: u32, value: Fixed) {
    let carry = add_word(film, first, value.low.low);
    let middle = add_word(film, first + 1, value.low.high);
    let carried = add_word(film, first + 1, carry);
    add_word(film, first + 2, value.high + middle + carried);
    if value.is_cut_off {
        film.add(CUT_OFF, 1);
    }
}

/// Adds to a word; what there is to carry, 0 or 1. Most words of a component are zero: 24 bits lie
/// in one or two of them.
fn add_word(film: &mut Atomics<'_>, index: u32, value: u32) -> u32 {
    if value == 0 {
        return 0;
    }
    let before = film.add(index, value);
    (before.wrapping_add(value) < before) as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::random::hash;

    fn units(fixed: Fixed) -> u128 {
        u128::from(fixed.high) << 64 | u128::from(fixed.low.high) << 32 | u128::from(fixed.low.low)
    }

    #[test]
    fn conversion_rounds_to_the_nearest_unit() {
        for k in 0..200_000_u32 {
            let value = f32::from_bits(hash(k) >> 1);
            let unit = (hash(k ^ 0x55aa) % 200) as i32 - 150;
            if !value.is_finite() || value < f32::MIN_POSITIVE {
                continue;
            }
            let fixed = Fixed::new(value, unit);
            let exact = f64::from(value) * f64::from(unit).exp2();
            let exact = exact / f64::from(2 * unit).exp2();
            if exact >= 84_f64.exp2() {
                assert!(fixed.is_cut_off && units(fixed) < 1 << 84, "{value} in 2^{unit}");
            } else {
                // Both sides have 53 bits for 24 that count.
                let error = units(fixed) as f64 - exact;
                assert!(!fixed.is_cut_off && error.abs() <= 0.5, "{value} in 2^{unit}: {error}");
            }
        }
        assert_eq!(units(Fixed::new(0.0, 0)), 0);
        assert_eq!(units(Fixed::new(1e-40, -149)), 0, "denormal numbers are 0");
        assert_eq!([0.49_f32, 0.5, 1.49, 1.5].map(|v| units(Fixed::new(v, 0))), [0, 1, 1, 2]);
    }

    #[test]
    fn the_unit_follows_the_brightest_light() {
        assert_eq!([1.0, 1.99, 2.0, 0.25].map(unit_exponent), [-44, -44, -43, -46]);
        for brightest in [f32::MIN_POSITIVE, 1e-20, 1.0, 1e20, f32::MAX] {
            let fixed = Fixed::new(brightest, unit_exponent(brightest));
            assert!((1 << 44..1 << 45).contains(&units(fixed)), "{brightest}: {fixed:?}");
        }
    }
}
