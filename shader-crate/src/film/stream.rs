//! The sample stream: which pixel each slot of a round traces.
//!
//! The stream of a round is a list of slots, each one path. With [`Runs`] the slots of one pixel
//! are consecutive (a **run**), and runs follow each other in rank order (see
//! [`crate::film::tiles`]): neighbours in the stream are neighbours in the picture, and
//! whoever adds up a pixel's samples mostly has all of them.

use crate::film::sums::PixelSums;
use crate::math::random::SECOND_HALF;
use crate::memory::access::{Scatter, at, local, local_mut};
use crate::memory::device_struct;
use crate::parallel::prefix::{LANES, Lane};

device_struct! {
    /// One slot of the stream. 8 bytes.
    pub struct Slot {
        /// Rank of the pixel, or [`NO_PIXEL`].
        pub rank: u32,
        /// Which sample of the pixel this is: its half by [`SECOND_HALF`], and its number in that,
        /// counted from 0 over the whole render, which is the index into the half's sequence.
        pub sample: u32,
    }
}

/// [`RunWindow::half`]: all samples are of the first half.
pub const FIRST: u32 = 0;
/// [`RunWindow::half`]: all samples are of the second half.
pub const SECOND: u32 = 1;
/// [`RunWindow::half`]: the halves take turns, the first one begins.
pub const BY_TURNS: u32 = 2;

/// Samples that a pixel has of those that `half` counts.
pub fn counted(half: u32, pixel: &PixelSums) -> u32 {
    if half == FIRST {
        pixel.first_samples
    } else if half == SECOND {
        pixel.second_samples
    } else {
        pixel.samples()
    }
}

/// Whether the sample after `count` of those that `half` counts is of the second half.
pub fn is_second(half: u32, count: u32) -> bool {
    half == SECOND || half == BY_TURNS && count & 1 == 1
}

/// [`Slot::sample`] of the sample after `count` of those that `half` counts.
pub fn sample_number(half: u32, count: u32) -> u32 {
    let number = if half == BY_TURNS { count >> 1 } else { count };
    if is_second(half, count) { number | SECOND_HALF } else { number }
}

/// [`Slot::rank`] of a slot that stays empty.
pub const NO_PIXEL: u32 = u32::MAX;

device_struct! {
    /// The runs of a stretch of pixels that follow each other in rank order. 32 bytes.
    pub struct RunWindow {
        /// Lanes of the launch.
        pub threads: u32,
        /// Rank of the first pixel; the film that is bound starts there.
        pub first_rank: u32,
        /// Pixels.
        pub pixels: u32,
        /// Slots of each pixel; 0 where runs have lengths of their own.
        pub samples: u32,
        /// The slot where the window's runs begin: what is added to the places that runs have by
        /// themselves.
        pub first_slot: u32,
        /// Which half samples are of: [`FIRST`], [`SECOND`] or [`BY_TURNS`].
        pub half: u32,
        /// Where all runs are of one length: the samples that each pixel has of those that `half`
        /// counts.
        pub first_sample: u32,
        /// Unused; zero.
        pub pad: u32,
    }
}

/// Where each pixel's run begins and ends.
#[derive(Clone, Copy)]
pub struct Runs<'a> {
    window: RunWindow,
    /// The first slot of each pixel of the window and, after the last, where its run ends. Not
    /// looked at where all runs are of one length.
    starts: &'a [u32],
}

impl<'a> Runs<'a> {
    /// The runs of the pixels of a window.
    pub fn new(window: &RunWindow, starts: &'a [u32]) -> Self {
        Self { window: *window, starts }
    }

    /// The first slot of the run of a pixel; that of the pixel after the last is the end.
    pub fn start(&self, pixel: u32) -> u32 {
        let place = if self.window.samples > 0 {
            pixel * self.window.samples
        } else {
            at(self.starts, pixel)
        };
        self.window.first_slot + place
    }
}

/// Phases of [`fill_runs`].
pub const PHASES: u32 = 2;
/// The memory of a workgroup that fills runs: where the runs of its pixels begin, where the last
/// one ends, and how many samples they have had.
pub type Memory = [u32; (2 * LANES + 1) as usize];
const END: u32 = LANES;
const SAMPLES: u32 = END + 1;

/// Kernel, in phases: fills the runs of the [`LANES`] pixels of a workgroup. Neighbouring lanes
/// fill neighbouring slots, whosever they are, so that memory is written in order and a long run
/// holds up nobody.
pub fn fill_runs(
    phase: u32,
    lane: Lane,
    window: &RunWindow,
    starts: &[u32],
    film: &[PixelSums],
    slots: &mut Scatter<'_, Slot>,
    memory: &mut Memory,
) {
    let first_pixel = lane.group * LANES;
    if phase == 0 {
        let runs = Runs::new(window, starts);
        let pixel = first_pixel + lane.index;
        // Beyond the window all runs begin where the last one ends.
        *local_mut(memory, lane.index) = runs.start(pixel.min(window.pixels));
        if pixel < window.pixels {
            let samples = if window.samples > 0 {
                window.first_sample
            } else {
                counted(window.half, &at(film, pixel))
            };
            *local_mut(memory, SAMPLES + lane.index) = samples;
        }
        if lane.index == 0 {
            *local_mut(memory, END) = runs.start((first_pixel + LANES).min(window.pixels));
        }
    } else {
        let mut slot = local(memory, 0) + lane.index;
        while slot < local(memory, END) {
            let run = run_of(memory, slot);
            let count = local(memory, SAMPLES + run) + (slot - local(memory, run));
            let rank = window.first_rank + first_pixel + run;
            slots.set(slot, Slot { rank, sample: sample_number(window.half, count) });
            slot += LANES;
        }
    }
}

/// The run that `slot` is in: the last one that begins no later. (Those before it that begin at the
/// same slot are empty.)
fn run_of(memory: &Memory, slot: u32) -> u32 {
    let (mut run, mut step) = (0, LANES / 2);
    while step > 0 {
        if local(memory, run + step) <= slot {
            run += step;
        }
        step /= 2;
    }
    run
}

/// Kernel: makes slot `lane` empty.
pub fn clear_slots(_: u32, _: &RunWindow, slot: &mut Slot) {
    *slot = Slot { rank: NO_PIXEL, sample: 0 };
}
