//! Errors as integers: what makes everything that follows from the error buffer the same on every
//! processor.
//!
//! An error is an `f32`, not negative; what is not finite counts as 0, a negative error (or -0)
//! says that the pixel has converged and wants no samples. Relative to the largest, errors become
//! integers of 31 bits by shifting their mantissas: no float is computed with.

use crate::math::wide::Wide;
use crate::memory::access::{Scatter, at, local, local_mut};
use crate::memory::device_struct;
use crate::parallel::prefix::{BLOCK, BlockParams, GROUP, LANES, Lane};

/// The bits of an error that is not known to be 0: 0 for what is not finite, converged, or too
/// small to be normal.
pub fn magnitude(error: f32) -> u32 {
    let bits = error.to_bits();
    let exponent = bits >> 23;
    // With the sign bit set the exponent is larger than any.
    if exponent == 0 || exponent >= 255 { 0 } else { bits }
}

/// Whether a pixel of this error wants samples.
pub fn is_live(error: f32) -> bool {
    error.to_bits() >> 31 == 0
}

/// An error of this [`magnitude`] as an integer below 2^31, in proportion. `exponent` is the
/// largest of all magnitudes' exponents.
pub fn quantised(magnitude: u32, exponent: u32) -> u32 {
    let shift = exponent - (magnitude >> 23);
    if magnitude == 0 || shift >= 31 {
        0
    } else {
        (magnitude & 0x7f_ffff | 0x80_0000) << 7 >> shift
    }
}

device_struct! {
    /// What a block of errors comes to. 16 bytes.
    pub struct BlockErrors {
        /// The largest exponent (biased, 1 to 254); 0 if all errors are 0.
        pub exponent: u32,
        /// Pixels that want samples.
        pub live: u32,
        /// The sum of the errors [`quantised`] by that exponent, upper 32 bits.
        pub sum_high: u32,
        /// The lower 32 bits.
        pub sum_low: u32,
    }
}

/// Phases of [`block_errors`] and of [`add_block_errors`].
pub const PHASES: u32 = 5;

/// Kernel, in phases: the largest exponent of each block of errors, and their sum.
pub fn block_errors(
    phase: u32,
    lane: Lane,
    params: &BlockParams,
    errors: &[f32],
    blocks: &mut Scatter<'_, BlockErrors>,
    memory: &mut Memory,
) {
    let end = (lane.group * BLOCK + BLOCK).min(params.elements);
    let mut element = lane.group * BLOCK + lane.index;
    if phase == 0 {
        let mut seen = BlockErrors::NOTHING;
        while element < end {
            let error = at(errors, element);
            seen.exponent = seen.exponent.max(magnitude(error) >> 23);
            seen.live += is_live(error) as u32;
            element += LANES;
        }
        store_exponent(memory, lane.index, &seen);
    } else if phase == 2 {
        let exponent = exponent_of_all(memory).exponent;
        let mut sum = Wide::ZERO;
        while element < end {
            sum = sum
                .plus(Wide { high: 0, low: quantised(magnitude(at(errors, element)), exponent) });
            element += LANES;
        }
        store_sum(memory, lane.index, sum);
    } else if phase == PHASES - 1 {
        if lane.index == 0 {
            blocks.set(lane.group, all(memory));
        }
    } else {
        fold(phase, lane, memory);
    }
}

/// Kernel, in phases, one workgroup: puts the errors of all blocks together, as the element after
/// the last block.
pub fn add_block_errors(
    phase: u32,
    lane: Lane,
    params: &BlockParams,
    blocks: &mut Scatter<'_, BlockErrors>,
    memory: &mut Memory,
) {
    let mut block = lane.index;
    if phase == 0 {
        let mut seen = BlockErrors::NOTHING;
        while block < params.blocks {
            let errors = blocks.get(block);
            seen.exponent = seen.exponent.max(errors.exponent);
            seen.live += errors.live;
            block += LANES;
        }
        store_exponent(memory, lane.index, &seen);
    } else if phase == 2 {
        let exponent = exponent_of_all(memory).exponent;
        let mut sum = Wide::ZERO;
        while block < params.blocks {
            let errors = blocks.get(block);
            let own = Wide { high: errors.sum_high, low: errors.sum_low };
            sum = sum.plus(own.shifted_right(exponent - errors.exponent));
            block += LANES;
        }
        store_sum(memory, lane.index, sum);
    } else if phase == PHASES - 1 {
        if lane.index == 0 {
            blocks.set(params.blocks, all(memory));
        }
    } else {
        fold(phase, lane, memory);
    }
}

impl BlockErrors {
    const NOTHING: Self = Self { exponent: 0, live: 0, sum_high: 0, sum_low: 0 };
}

/// The workgroup's memory: four words for each lane, of each kind those of all lanes together, and
/// then those of groups of lanes.
pub type Memory = [u32; 4 * PLACES as usize];

const EXPONENT: u32 = 0;
const LIVE: u32 = PLACES;
const HIGH: u32 = 2 * PLACES;
const LOW: u32 = 3 * PLACES;
/// Words of each kind.
const PLACES: u32 = LANES + LANES / GROUP;

fn store_exponent(memory: &mut Memory, place: u32, errors: &BlockErrors) {
    *local_mut(memory, EXPONENT + place) = errors.exponent;
    *local_mut(memory, LIVE + place) = errors.live;
}

fn store_sum(memory: &mut Memory, place: u32, sum: Wide) {
    *local_mut(memory, HIGH + place) = sum.high;
    *local_mut(memory, LOW + place) = sum.low;
}

/// The phases between: what the lanes of each group have, put together.
fn fold(phase: u32, lane: Lane, memory: &mut Memory) {
    if lane.index < LANES / GROUP {
        let first = lane.index * GROUP;
        if phase == 1 {
            let errors = exponents(memory, first, GROUP);
            store_exponent(memory, LANES + lane.index, &errors);
        } else if phase == 3 {
            let sum = sums(memory, first, GROUP);
            store_sum(memory, LANES + lane.index, sum);
        }
    }
}

fn exponents(memory: &Memory, first: u32, count: u32) -> BlockErrors {
    let mut errors = BlockErrors::NOTHING;
    let mut k = 0;
    while k < count {
        errors.exponent = errors.exponent.max(local(memory, EXPONENT + first + k));
        errors.live += local(memory, LIVE + first + k);
        k += 1;
    }
    errors
}

fn sums(memory: &Memory, first: u32, count: u32) -> Wide {
    let mut sum = Wide::ZERO;
    let mut k = 0;
    while k < count {
        let high = local(memory, HIGH + first + k);
        sum = sum.plus(Wide { high, low: local(memory, LOW + first + k) });
        k += 1;
    }
    sum
}

fn exponent_of_all(memory: &Memory) -> BlockErrors {
    exponents(memory, LANES, LANES / GROUP)
}

fn all(memory: &Memory) -> BlockErrors {
    let sum = sums(memory, LANES, LANES / GROUP);
    BlockErrors { sum_high: sum.high, sum_low: sum.low, ..exponent_of_all(memory) }
}
