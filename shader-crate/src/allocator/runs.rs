//! From weights to a run of consecutive slots for each pixel.
//!
//! Pixels have weights, whatever they stand for. Let `P` be the sum of the weights of all pixels
//! before one in rank order and `W` that of all: its run begins at slot
//! `(P * 256 * slots / W + phase) / 256`, rounded down (the quotient too), where `phase` is one
//! random number below 256 for the whole round. So the runs follow each other without gaps, their
//! lengths add up to `slots` exactly, and a pixel that is due 2.3 samples gets 2 or 3, 2.3 on
//! average over phases.

use crate::math::wide::{Wide, divide, multiply};
use crate::memory::access::{Scatter, at, local_mut};
use crate::memory::device_struct;
use crate::parallel::prefix::{LANES, Lane, Memory, PER_LANE, sum_before, sum_groups, sum_values};

device_struct! {
    /// The parameters of a round of runs. 32 bytes.
    pub struct RunParams {
        /// Lanes: [`LANES`] for each block of pixels.
        pub threads: u32,
        /// Pixels.
        pub pixels: u32,
        /// Blocks of pixels.
        pub blocks: u32,
        /// Slots of the round, at most 2^22.
        pub slots: u32,
        /// A random number below 256.
        pub phase: u32,
        /// Unused; zero.
        pub pad0: u32,
        /// Unused; zero.
        pub pad1: u32,
        /// Unused; zero.
        pub pad2: u32,
    }
}

/// From sums of weights to places in a stream.
struct Scale {
    shift: u32,
    factor: u32,
}

impl Scale {
    /// Sums up to `all` become places up to `end`, which is at most 2^30.
    fn new(end: u32, all: u32) -> Self {
        // Shifted up until all its 32 bits are used, the sum's reciprocal is exact enough for one
        // multiplication to do for a division.
        let shift = all.leading_zeros();
        Self { shift, factor: divide(Wide { high: end, low: 0 }, all << shift) }
    }

    /// The place of a sum: `sum * end / all`, rounded down, or 1 less.
    fn of(&self, sum: u32) -> u32 {
        multiply(sum << self.shift, self.factor).high
    }
}

/// Kernel, in phases: the first slot of each pixel's run, and after the last the number of slots.
/// `offsets` are the sums of weights before each block, with that of all after the last. Where all
/// weights are 0, pixels share alike.
pub fn run_starts(
    phase: u32,
    lane: Lane,
    params: &RunParams,
    weights: &[u32],
    offsets: &[u32],
    starts: &mut Scatter<'_, u32>,
    memory: &mut Memory,
) {
    let first = lane.first_element().min(params.pixels);
    let end = (first + PER_LANE).min(params.pixels);
    if phase == 0 {
        *local_mut(memory, lane.index) = sum_values(weights, first, end);
    } else if phase == 1 {
        sum_groups(lane, memory);
    } else {
        let all = at(offsets, params.blocks);
        let scale = Scale::new(params.slots << 8, if all == 0 { params.pixels } else { all });
        let mut sum = at(offsets, lane.group) + sum_before(lane, memory);
        let mut pixel = first;
        while pixel < end {
            let place = scale.of(if all == 0 { pixel } else { sum });
            starts.set(pixel, (place + params.phase) >> 8);
            sum += at(weights, pixel);
            pixel += 1;
        }
        if lane.group == params.blocks - 1 && lane.index == LANES - 1 {
            starts.set(params.pixels, params.slots);
        }
    }
}
