//! The splat film: what lands on pixels from elsewhere.
//!
//! Light tracing finds its pixel last, so many lanes may add to one pixel at once: by atomics, to
//! sums that [no order can change](fixed). The same splats give the same film, bit for bit, on
//! every device. Splats are not divided by the number of light paths before they are added; so a
//! pixel of radiance `L` holds `L` for every light path so far, and 2^55 of these fit where `L` is
//! 256 times that of the brightest light.
//!
//! ```text
//! words: rounds, splats cut off, 0, 0 | pixel 0: red lowest to highest, green ..., blue ... | ...
//! ```
//!
//! Pixels are row by row from the top.

use crate::glam::{UVec4, Vec3};
use crate::math::fixed::{self, Fixed};
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
/// Words of a pixel.
pub const PIXEL_WORDS: u32 = 3 * fixed::WORDS;

device_struct! {
    /// The parameters of [`add_splats`]. 16 bytes.
    pub struct SplatParams {
        /// Lanes. Each takes every `threads`-th splat.
        pub threads: u32,
        /// The unit is 2 to this power, see [`fixed::unit_exponent`].
        pub unit_exponent: i32,
        /// Unused; zero.
        pub pad0: u32,
        /// Unused; zero.
        pub pad1: u32,
    }
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
            add(film, first, splat.radiance.x, params.unit_exponent);
            add(film, first + fixed::WORDS, splat.radiance.y, params.unit_exponent);
            add(film, first + 2 * fixed::WORDS, splat.radiance.z, params.unit_exponent);
        }
        index += params.threads;
    }
}

/// Adds to the component whose words begin at `first`.
fn add(film: &mut Atomics<'_>, first: u32, value: f32, unit_exponent: i32) {
    let number = Fixed::new(value, unit_exponent);
    fixed::add_atomic(film, first, number.words);
    if !number.fits {
        film.add(CUT_OFF, 1);
    }
}
