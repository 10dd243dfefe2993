//! Errors as integers: what makes everything that follows from the error buffer the same on every processor.
//!
//! An error is an `f32`, not negative; what is not finite counts as 0, a negative error (or -0) says that the pixel has converged and wants
//! no samples. Relative to the largest, errors become integers of 31 bits by shifting their mantissas: no float
//! is computed with.

use crate::access::Scatter;
use crate::device_struct;
use crate::prefix::{BLOCK, BlockParams, LANES, Lane, STEPS, fold_partner};
use crate::wide::Wide;

/// The bits of an error that is not known to be 0: 0 for what is not finite, converged, or too small to be normal.
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

/// An error of this [`magnitude`] as an integer below 2^31, in proportion. `exponent` is the largest of all
/// magnitudes' exponents.
pub fn quantised(magnitude: u32, exponent: u32) -> u32 {
    let shift = exponent - (magnitude >> 23);
    if magnitude == 0 || shift >= 31 { 0 } else { (magnitude & 0x7f_ffff | 0x80_0000) << 7 >> shift }
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

/// Phases of [`block_errors`].
pub const BLOCK_PHASES: u32 = 2 * STEPS + 3;

/// Kernel, in phases: the largest exponent of each block of errors, and their sum.
pub fn block_errors(
    phase: u32,
    lane: Lane,
    params: &BlockParams,
    errors: &[f32],
    blocks: &mut Scatter<'_, BlockErrors>,
    memory: &mut [u32; 1024],
) {
    let first = lane.group * BLOCK + lane.index;
    let end = (lane.group * BLOCK + BLOCK).min(params.elements);
    if phase == 0 {
        let (mut exponent, mut live) = (0, 0);
        let mut element = first;
        while element < end {
            let error = errors[element as usize];
            exponent = exponent.max(magnitude(error) >> 23);
            live += is_live(error) as u32;
            element += LANES;
        }
        set(memory, EXPONENT, lane.index, exponent);
        set(memory, LIVE, lane.index, live);
    } else if phase <= STEPS {
        fold_exponent_and_live(phase - 1, lane.index, memory);
    } else if phase == STEPS + 1 {
        let mut sum = Wide { high: 0, low: 0 };
        let mut element = first;
        while element < end {
            let low = quantised(magnitude(errors[element as usize]), get(memory, EXPONENT, 0));
            sum = sum.plus(Wide { high: 0, low });
            element += LANES;
        }
        set_sum(memory, lane.index, sum);
    } else if phase <= 2 * STEPS + 1 {
        fold_sums(phase - STEPS - 2, lane.index, memory);
    } else if lane.index == 0 {
        blocks.set(lane.group, total(memory));
    }
}

/// Phases of [`add_block_errors`].
pub const ADD_PHASES: u32 = BLOCK_PHASES;

/// Kernel, in phases, one workgroup: puts the errors of all blocks together, as the element after the last block.
pub fn add_block_errors(
    phase: u32,
    lane: Lane,
    params: &BlockParams,
    blocks: &mut Scatter<'_, BlockErrors>,
    memory: &mut [u32; 1024],
) {
    if phase == 0 {
        let (mut exponent, mut live) = (0, 0);
        let mut block = lane.index;
        while block < params.blocks {
            let errors = blocks.get(block);
            exponent = exponent.max(errors.exponent);
            live += errors.live;
            block += LANES;
        }
        set(memory, EXPONENT, lane.index, exponent);
        set(memory, LIVE, lane.index, live);
    } else if phase <= STEPS {
        fold_exponent_and_live(phase - 1, lane.index, memory);
    } else if phase == STEPS + 1 {
        let mut sum = Wide { high: 0, low: 0 };
        let mut block = lane.index;
        while block < params.blocks {
            let errors = blocks.get(block);
            let own = Wide { high: errors.sum_high, low: errors.sum_low };
            sum = sum.plus(own.shifted_right(get(memory, EXPONENT, 0) - errors.exponent));
            block += LANES;
        }
        set_sum(memory, lane.index, sum);
    } else if phase <= 2 * STEPS + 1 {
        fold_sums(phase - STEPS - 2, lane.index, memory);
    } else if lane.index == 0 {
        blocks.set(params.blocks, total(memory));
    }
}

// The four quarters of the workgroup's memory.
const EXPONENT: u32 = 0;
const LIVE: u32 = LANES;
const SUM_HIGH: u32 = 2 * LANES;
const SUM_LOW: u32 = 3 * LANES;

fn get(memory: &[u32; 1024], quarter: u32, index: u32) -> u32 {
    memory[(quarter + index) as usize]
}

fn set(memory: &mut [u32; 1024], quarter: u32, index: u32, value: u32) {
    memory[(quarter + index) as usize] = value;
}

fn set_sum(memory: &mut [u32; 1024], index: u32, sum: Wide) {
    set(memory, SUM_HIGH, index, sum.high);
    set(memory, SUM_LOW, index, sum.low);
}

/// What lane 0 has in the end.
fn total(memory: &[u32; 1024]) -> BlockErrors {
    BlockErrors {
        exponent: get(memory, EXPONENT, 0),
        live: get(memory, LIVE, 0),
        sum_high: get(memory, SUM_HIGH, 0),
        sum_low: get(memory, SUM_LOW, 0),
    }
}

fn fold_exponent_and_live(step: u32, index: u32, memory: &mut [u32; 1024]) {
    if let Some(partner) = fold_partner(step, index) {
        let exponent = get(memory, EXPONENT, index).max(get(memory, EXPONENT, partner));
        set(memory, EXPONENT, index, exponent);
        let live = get(memory, LIVE, index) + get(memory, LIVE, partner);
        set(memory, LIVE, index, live);
    }
}

fn fold_sums(step: u32, index: u32, memory: &mut [u32; 1024]) {
    if let Some(partner) = fold_partner(step, index) {
        let sum = |i| Wide { high: get(memory, SUM_HIGH, i), low: get(memory, SUM_LOW, i) };
        let sum = sum(index).plus(sum(partner));
        set_sum(memory, index, sum);
    }
}
