//! The allocator `atomic`: the method that Podee et al. compare with ("Efficient Adaptive GPU Path
//! Tracing", equation 2).
//!
//! Each pixel gets samples in proportion to its error, reserves its slots by an atomic counter, and
//! results are added to the film by atomics. So the order of the stream and that of the additions
//! are whatever the device makes of them. What comes of it is the same all the same: the numbers of
//! samples are the lengths of [runs](crate::allocator::runs) without a random phase, and
//! [sums](crate::film::sums) do not know their order. (The paper's are sums of floats, which do.)

use crate::allocator::error_scale::{BlockErrors, is_live, magnitude, quantised};
use crate::allocator::runs::RunParams;
use crate::film::stream::{RunWindow, Runs, Slot, counted, sample_number};
use crate::film::sums::PixelSums;
use crate::math::wide::{Wide, multiply, multiply_divide};
use crate::memory::access::{Atomics, Scatter, at, local_mut};
use crate::parallel::prefix::{BLOCK, LANES, Lane, Memory, PER_LANE, finish_block_sum};

/// What the weights of all errors add up to, but for rounding.
pub const ERROR_WEIGHTS: u32 = 1 << 29;

/// How errors become weights; the same for all pixels of a round.
#[derive(Clone, Copy)]
struct Weighing {
    exponent: u32,
    /// A weight is `error * factor >> 32 >> shift`.
    factor: u32,
    shift: u32,
}

impl Weighing {
    fn new(all: &BlockErrors) -> Self {
        let sum = Wide { high: all.sum_high, low: all.sum_low };
        // The largest error is at least 2^30 and so is the sum, unless all are 0.
        if sum.bits() < 31 {
            return Self { exponent: 0, factor: 0, shift: 0 };
        }
        let shift = sum.bits() - 31;
        let divisor = sum.shifted_right(shift).low;
        Self {
            exponent: all.exponent,
            factor: multiply_divide(1 << 31, 2 * ERROR_WEIGHTS, divisor),
            shift,
        }
    }

    fn weight(&self, error: f32) -> u32 {
        if !is_live(error) || self.factor == 0 {
            return 0;
        }
        let product = multiply(quantised(magnitude(error), self.exponent), self.factor);
        product.shifted_right(32 + self.shift).low
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
        let weighing = Weighing::new(&at(totals, params.blocks));
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

/// Kernel: zeroes counters.
pub fn clear_counter(_: u32, _: &RunWindow, counter: &mut u32) {
    *counter = 0;
}

/// Kernel: reserves slots for pixel `lane` of the window, as many as its run is long.
pub fn reserve_slots(
    lane: u32,
    window: &RunWindow,
    starts: &[u32],
    reserved: &mut u32,
    counter: &mut Atomics<'_>,
) {
    let runs = Runs::new(window, starts);
    let count = runs.start(lane + 1) - runs.start(lane);
    if count > 0 {
        *reserved = counter.add(0, count);
    }
}

/// Kernel: fills the slot that would be number `lane` if pixels came in order, where it is one of
/// the window's: runs may be so long that one lane must not fill them alone.
pub fn fill_reserved(
    lane: u32,
    window: &RunWindow,
    starts: &[u32],
    reserved: &[u32],
    film: &[PixelSums],
    slots: &mut Scatter<'_, Slot>,
) {
    if lane < at(starts, 0) || lane >= at(starts, window.pixels) {
        return;
    }
    // The last pixel whose run does not begin after the slot; runs before it may be empty.
    let (mut pixel, mut end) = (0, window.pixels);
    while end - pixel > 1 {
        let middle = (pixel + end) / 2;
        if at(starts, middle) <= lane {
            pixel = middle;
        } else {
            end = middle;
        }
    }
    let k = lane - at(starts, pixel);
    let sample = sample_number(window.half, counted(window.half, &at(film, pixel)) + k);
    let slot = Slot { rank: window.first_rank + pixel, sample };
    slots.set(at(reserved, pixel) + k, slot);
}
