//! The weights of the allocator `runs`: what each pixel lacks of the best number of samples.
//!
//! If the error of pixel `i` is the deviation `s` of one of its samples, each of cost `c`, then of
//! all ways to spend a budget the one with counts in proportion to `s / sqrt(c)` leaves the least
//! squared error. Pixels have had `n` samples already, some of them more than that. So a round of
//! `N` samples **fills up**: with the errors `q` as integers (see
//! [`crate::allocator::error_scale`]), pixel `i` lacks
//!
//! ```text
//! d = max(0, L q - n),   where the level L is such that the sum of d is N.
//! ```
//!
//! The level is found by a fixed point: with `S` the pixels that lacked something at the last
//! level, the next one is `(N + sum of n over S) / (sum of q over S)`. It falls from pass to pass
//! and is exact as soon as `S` stays as it is. [`PASSES`] bring it close; the rest is a common
//! factor, which [`run_starts`](crate::allocator::runs::run_starts) divides out.
//!
//! All is in integers, whose sums do not depend on their order, so it is the same on every device.

use crate::allocator::error_scale::{BlockErrors, is_live, magnitude, quantised};
use crate::math::wide::{Wide, divide, multiply};
use crate::memory::access::{Atomics, Scatter, at, local, local_mut};
use crate::memory::device_struct;
use crate::parallel::prefix::{
    BLOCK, GROUP, LANES, Lane, Memory as SumMemory, PER_LANE, finish_block_sum,
};

/// Levels before the last one.
pub const PASSES: u32 = 4;

/// The largest error, by the mean over the pixels that want samples. A pixel on which a rare bright
/// path has fallen seems worse than all others together; beyond some more samples it would waste
/// them.
const LARGEST_ERROR: u32 = 16;

/// The most that a pixel is given in a round for what it lacks, by the round's average: one thread
/// adds up a pixel's run, and all wait for the longest. The next round gives it more.
const LONGEST_RUN: u32 = 128;

device_struct! {
    /// The parameters of a pass. 32 bytes.
    pub struct DeficitParams {
        /// Lanes: [`LANES`] for each block of pixels.
        pub threads: u32,
        /// Pixels.
        pub pixels: u32,
        /// Blocks of pixels.
        pub blocks: u32,
        /// Samples of the round, at most 2^22.
        pub slots: u32,
        /// Samples that every pixel gets before, beside those that it has had.
        pub control: u32,
        /// Bits behind the point of targets and deficits, see [`fraction_bits`].
        pub fraction_bits: u32,
        /// Number of the pass, below [`PASSES`].
        pub pass: u32,
        /// Unused; zero.
        pub pad: u32,
    }
}

/// The bits behind the point with which a round of `slots` samples is shared out after pixels have
/// got `samples` together: as many as sums of 31 bits of deficits and of 62 bits of targets have
/// room for.
pub fn fraction_bits(slots: u32, samples: u64) -> u32 {
    let bits = |number: u64| 64 - number.leading_zeros();
    let all = bits(samples + u64::from(slots));
    (31_u32.saturating_sub(bits(u64::from(slots)))).min(62_u32.saturating_sub(all))
}

/// Words of what a pass finds.
pub const LEVEL_WORDS: u32 = 4;

/// Sums over the pixels that lack something at the level of the pass before (in the first pass,
/// over all that have an error).
#[derive(Clone, Copy)]
struct Filled {
    /// Samples that they have.
    samples: Wide,
    /// Their errors.
    errors: Wide,
}

impl Filled {
    const NOTHING: Self = Self { samples: Wide::ZERO, errors: Wide::ZERO };

    fn plus(self, other: Self) -> Self {
        Self { samples: self.samples.plus(other.samples), errors: self.errors.plus(other.errors) }
    }
}

/// `(round + samples) / errors` of [`Filled`] as a floating-point number, with the bits behind the
/// point of targets: `mantissa / 2^shift`.
#[derive(Clone, Copy)]
struct Level {
    mantissa: u32,
    shift: i32,
}

impl Level {
    fn new(params: &DeficitParams, filled: &Filled) -> Self {
        let target = filled.samples.plus(Wide { high: 0, low: params.slots });
        let errors = filled.errors;
        if errors.bits() == 0 {
            return Self { mantissa: 0, shift: 0 };
        }
        // The target with 63 bits by one of 32.
        let (up, down) = (63 - target.bits() as i32, errors.bits() as i32 - 32);
        Self {
            mantissa: divide(shifted(target, -up), shifted(errors, down).low),
            shift: up + down - params.fraction_bits as i32,
        }
    }

    /// What a pixel of this error lacks.
    fn deficit(&self, params: &DeficitParams, error: u32, samples: u32) -> Wide {
        let target = shifted(multiply(error, self.mantissa), self.shift);
        let has = Wide { high: 0, low: samples }.shifted_left(params.fraction_bits);
        if has.is_below(target) { target.minus(has) } else { Wide::ZERO }
    }

    /// What all pixels together lack that lack something, whose sums are `filled`; no less than
    /// what they lack by [`Self::deficit`], which rounds down.
    fn deficits(&self, params: &DeficitParams, filled: &Filled) -> Wide {
        let low = shifted(multiply(filled.errors.low, self.mantissa), self.shift);
        let high = shifted(multiply(filled.errors.high, self.mantissa), self.shift - 32);
        let target = low.plus(high).plus(Wide { high: 0, low: 2 });
        let has = filled.samples.shifted_left(params.fraction_bits);
        if has.is_below(target) { target.minus(has) } else { Wide::ZERO }
    }
}

/// `number >> shift`, or shifted left if that is negative.
fn shifted(number: Wide, shift: i32) -> Wide {
    if shift < 0 { number.shifted_left(-shift as u32) } else { number.shifted_right(shift as u32) }
}

/// What is known of all errors.
struct Scale {
    exponent: u32,
    /// Largest error.
    largest: u32,
}

impl Scale {
    fn new(all: &BlockErrors) -> Self {
        let sum = Wide { high: all.sum_high, low: all.sum_low };
        // As many errors below 2^31 make a mean below that.
        let mean = divide(sum, all.live.max(1));
        Self { exponent: all.exponent, largest: mean.min(u32::MAX / LARGEST_ERROR) * LARGEST_ERROR }
    }

    fn error(&self, error: f32) -> u32 {
        if is_live(error) {
            quantised(magnitude(error), self.exponent).min(self.largest)
        } else {
            0
        }
    }
}

/// Phases of [`raise_level`].
pub const PHASES: u32 = 3;
/// Words of each kind in a workgroup's memory: for each lane, then for each group of lanes.
const PLACES: u32 = LANES + LANES / GROUP;
/// The memory of a workgroup: the words of what a pass finds, each of all lanes and groups.
pub type Memory = [u32; (LEVEL_WORDS * PLACES) as usize];

/// Kernel, in phases: adds up samples and errors of the pixels that lack something at the level
/// of the pass before. `levels` are [`LEVEL_WORDS`] words for each pass, zeroed before the first.
pub fn raise_level(
    phase: u32,
    lane: Lane,
    params: &DeficitParams,
    errors: &[f32],
    counts: &[u32],
    totals: &[BlockErrors],
    levels: &mut Atomics<'_>,
    memory: &mut Memory,
) {
    if phase == 0 {
        let scale = Scale::new(&at(totals, params.blocks));
        let level = Level::new(params, &last_pass(params.pass, levels));
        let (mut pixel, mut filled) = (lane.group * BLOCK + lane.index, Filled::NOTHING);
        let mut k = 0;
        while k < PER_LANE {
            if pixel < params.pixels {
                let error = scale.error(at(errors, pixel));
                let samples = at(counts, pixel) + params.control;
                let deficits = level.deficit(params, error, samples);
                if deficits.bits() > 0 || params.pass == 0 && error > 0 {
                    filled = filled.plus(Filled {
                        samples: Wide { high: 0, low: samples },
                        errors: Wide { high: 0, low: error },
                    });
                }
            }
            pixel += LANES;
            k += 1;
        }
        store(memory, lane.index, &filled);
    } else if phase == 1 {
        if lane.index < LANES / GROUP {
            let filled = sum(memory, lane.index * GROUP, GROUP);
            store(memory, LANES + lane.index, &filled);
        }
    } else if lane.index == 0 {
        let filled = sum(memory, LANES, LANES / GROUP);
        let first = params.pass * LEVEL_WORDS;
        add(levels, first, filled.samples);
        add(levels, first + 2, filled.errors);
    }
}

/// What the pass before number `pass` found; nothing before the first.
fn last_pass(pass: u32, levels: &Atomics<'_>) -> Filled {
    if pass == 0 {
        return Filled::NOTHING;
    }
    let first = (pass - 1) * LEVEL_WORDS;
    Filled {
        samples: Wide { high: levels.get(first), low: levels.get(first + 1) },
        errors: Wide { high: levels.get(first + 2), low: levels.get(first + 3) },
    }
}

fn found_by(levels: &[u32], pass: u32) -> Filled {
    let first = pass * LEVEL_WORDS;
    Filled {
        samples: Wide { high: at(levels, first), low: at(levels, first + 1) },
        errors: Wide { high: at(levels, first + 2), low: at(levels, first + 3) },
    }
}

/// Adds to the number of two words at `first`. Whoever makes the lower one overflow carries.
fn add(levels: &mut Atomics<'_>, first: u32, number: Wide) {
    let before = levels.add(first + 1, number.low);
    let carry = (before.wrapping_add(number.low) < before) as u32;
    levels.add(first, number.high + carry);
}

fn store(memory: &mut Memory, place: u32, filled: &Filled) {
    store_number(memory, place, filled.samples);
    store_number(memory, 2 * PLACES + place, filled.errors);
}

fn store_number(memory: &mut Memory, first: u32, number: Wide) {
    *local_mut(memory, first) = number.high;
    *local_mut(memory, first + PLACES) = number.low;
}

fn stored_number(memory: &Memory, first: u32) -> Wide {
    Wide { high: local(memory, first), low: local(memory, first + PLACES) }
}

/// The sum of `count` places from `first` on.
fn sum(memory: &Memory, first: u32, count: u32) -> Filled {
    let (mut filled, mut place) = (Filled::NOTHING, first);
    while place < first + count {
        filled = filled.plus(Filled {
            samples: stored_number(memory, place),
            errors: stored_number(memory, 2 * PLACES + place),
        });
        place += 1;
    }
    filled
}

/// Kernel, in phases: the weight of each pixel, what it lacks at the last level, and the sum of
/// each block's. Sums of all are below 2^32.
#[expect(clippy::too_many_arguments, reason = "one for each binding of the table's row")]
pub fn weigh_deficits(
    phase: u32,
    lane: Lane,
    params: &DeficitParams,
    errors: &[f32],
    counts: &[u32],
    totals: &[BlockErrors],
    levels: &[u32],
    weights: &mut Scatter<'_, u32>,
    sums: &mut Scatter<'_, u32>,
    memory: &mut SumMemory,
) {
    if phase == 0 {
        let scale = Scale::new(&at(totals, params.blocks));
        let filled = found_by(levels, PASSES - 1);
        let level = Level::new(params, &filled);
        // Levels fall, so pixels lack no more than at the level before.
        let before = Level::new(params, &found_by(levels, PASSES - 2));
        let shift = before.deficits(params, &filled).bits().max(31) - 31;
        // `slots << fraction_bits` is below 2^31.
        let average = divide(
            Wide { high: 0, low: params.slots << params.fraction_bits },
            params.pixels.max(1),
        );
        let longest = multiply(average.max(1), LONGEST_RUN).shifted_right(shift);
        let (mut pixel, mut sum) = (lane.group * BLOCK + lane.index, 0);
        let mut k = 0;
        while k < PER_LANE {
            if pixel < params.pixels {
                let error = scale.error(at(errors, pixel));
                let samples = at(counts, pixel) + params.control;
                let deficit = level.deficit(params, error, samples).shifted_right(shift);
                let weight = if longest.is_below(deficit) { longest } else { deficit }.low;
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
