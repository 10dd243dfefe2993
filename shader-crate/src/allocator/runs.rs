//! The allocator `runs`: from errors to a run of consecutive slots for each pixel.
//!
//! A pixel gets a **weight** in proportion to its error, plus a small uniform share. Let `P` be the
//! sum of the weights of all pixels before it in rank order and `W` that of all: its run begins at
//! slot `(P * 256 * slots / W + phase) / 256`, rounded down (the quotient too), where `phase` is
//! one random number below 256 for the whole round. So the runs follow each other without gaps,
//! their lengths add up to `slots` exactly, and a pixel that is due 2.3 samples gets 2 or 3, 2.3 on
//! average over phases.

use crate::allocator::error_scale::{BlockErrors, is_live, magnitude, quantised};
use crate::math::wide::{Wide, divide, multiply, multiply_divide};
use crate::memory::access::{Scatter, at, local_mut};
use crate::memory::device_struct;
use crate::parallel::prefix::{
    BLOCK, LANES, Lane, Memory, PER_LANE, finish_block_sum, sum_before, sum_groups, sum_values,
};

/// What the weights of all errors add up to, but for rounding.
pub const ERROR_WEIGHTS: u32 = 1 << 29;

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
        /// What the uniform share's weights add up to, beside [`ERROR_WEIGHTS`]; 0 for none.
        pub uniform_weights: u32,
        /// Largest weight that an error can have.
        pub largest_weight: u32,
        /// Unused; zero.
        pub pad: u32,
    }
}

/// How errors become weights; the same for all pixels of a round.
#[derive(Clone, Copy)]
struct Weighing {
    exponent: u32,
    /// A weight is `error * factor >> 32 >> shift`.
    factor: u32,
    shift: u32,
    uniform: u32,
    largest: u32,
    /// Where every pixel has converged, all count as if none had.
    all_live: bool,
}

impl Weighing {
    fn new(params: &RunParams, all: &BlockErrors) -> Self {
        let sum = Wide { high: all.sum_high, low: all.sum_low };
        let all_live = all.live == 0;
        let live = if all_live { params.pixels } else { all.live };
        // The largest error is at least 2^30 and so is the sum, unless all are 0.
        let (shift, factor, uniform) = if sum.bits() < 31 {
            (0, 0, ERROR_WEIGHTS.checked_div(live).unwrap_or(0))
        } else {
            let shift = sum.bits() - 31;
            let divisor = sum.shifted_right(shift).low;
            (
                shift,
                multiply_divide(1 << 31, 2 * ERROR_WEIGHTS, divisor),
                params.uniform_weights.checked_div(live).unwrap_or(0),
            )
        };
        // So that no live pixel starves, however many there are.
        let uniform = if params.uniform_weights > 0 || factor == 0 { uniform.max(1) } else { 0 };
        Self {
            exponent: all.exponent,
            factor,
            shift,
            uniform,
            largest: params.largest_weight,
            all_live,
        }
    }

    fn weight(&self, error: f32) -> u32 {
        if self.all_live {
            return self.uniform;
        }
        if !is_live(error) {
            return 0;
        }
        let product = multiply(quantised(magnitude(error), self.exponent), self.factor);
        product.shifted_right(32 + self.shift).low.min(self.largest) + self.uniform
    }
}

/// Kernel, in phases: the weight of each pixel and the sum of each block's. `totals` are
/// [`BlockErrors`] with those of all after the last.
pub fn weigh_errors(
    phase: u32,
    lane: Lane,
    params: &RunParams,
    errors: &[f32],
    totals: &[BlockErrors],
    weights: &mut Scatter<'_, u32>,
    sums: &mut Scatter<'_, u32>,
    memory: &mut Memory,
) {
    if phase == 0 {
        let weighing = Weighing::new(params, &at(totals, params.blocks));
        let (mut pixel, mut sum) = (lane.group * BLOCK + lane.index, 0);
        let mut k = 0;
        while k < PER_LANE {
            if pixel < params.pixels {
                let weight = weighing.weight(at(errors, pixel));
                weights.set(pixel, weight);
                sum += weight;
            }
            pixel += LANES;
            k += 1;
        }
        *local_mut(memory, lane.index) = sum;
    } else {
        finish_block_sum(phase, lane, sums, memory);
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
/// `offsets` are the sums of weights before each block, with that of all after the last.
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
        let scale = Scale::new(params.slots << 8, at(offsets, params.blocks));
        let mut sum = at(offsets, lane.group) + sum_before(lane, memory);
        let mut pixel = first;
        while pixel < end {
            starts.set(pixel, (scale.of(sum) + params.phase) >> 8);
            sum += at(weights, pixel);
            pixel += 1;
        }
        if lane.group == params.blocks - 1 && lane.index == LANES - 1 {
            starts.set(params.pixels, params.slots);
        }
    }
}
