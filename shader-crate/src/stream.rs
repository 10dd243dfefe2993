//! The sample stream: which pixel each slot of a round traces.
//!
//! The stream of a round is a list of slots, each one path. With [`Runs`] the slots of one pixel are consecutive (a
//! **run**), and runs follow each other in rank order (see [`crate::tiles`]): neighbours in the stream are
//! neighbours in the picture, and accumulation is a loop over a pixel's own run.

use crate::access::Scatter;
use crate::device_struct;
use crate::film::FilmPixel;

device_struct! {
    /// One slot of the stream. 8 bytes.
    pub struct Slot {
        /// Rank of the pixel, or [`NO_PIXEL`].
        pub rank: u32,
        /// Which sample of the pixel this is, counted from 0 over the whole render: the index into its
        /// sample sequence.
        pub sample: u32,
    }
}

/// [`Slot::rank`] of a slot that stays empty.
pub const NO_PIXEL: u32 = u32::MAX;

device_struct! {
    /// The runs of a stretch of pixels that follow each other in rank order. 16 bytes.
    pub struct RunWindow {
        /// Lanes of the launch.
        pub threads: u32,
        /// Rank of the first pixel; the film that is bound starts there.
        pub first_rank: u32,
        /// Pixels.
        pub pixels: u32,
        /// Slots of each pixel; 0 where runs have lengths of their own.
        pub samples: u32,
    }
}

/// Where each pixel's run begins and ends.
#[derive(Clone, Copy)]
pub struct Runs<'a> {
    window: RunWindow,
    /// The first slot of each pixel of the window and, after the last, where its run ends. Not looked at where all runs are of
    /// one length.
    starts: &'a [u32],
}

impl<'a> Runs<'a> {
    /// The runs of the pixels of a window.
    pub fn new(window: &RunWindow, starts: &'a [u32]) -> Self {
        Self { window: *window, starts }
    }

    /// The first slot of the run of a pixel, counted from the window's first; that of the pixel after the last is the end.
    pub fn start(&self, pixel: u32) -> u32 {
        if self.window.samples > 0 { pixel * self.window.samples } else { self.starts[pixel as usize] }
    }
}

/// Kernel: fills the run of pixel `lane` of the window.
pub fn fill_runs(lane: u32, window: &RunWindow, starts: &[u32], film: &[FilmPixel], slots: &mut Scatter<'_, Slot>) {
    let runs = Runs::new(window, starts);
    let mut slot = runs.start(lane);
    let end = runs.start(lane + 1);
    if slot == end {
        return;
    }
    let mut sample = film[lane as usize].samples;
    while slot < end {
        slots.set(slot, Slot { rank: window.first_rank + lane, sample });
        slot += 1;
        sample += 1;
    }
}

/// Kernel: makes slot `lane` empty.
pub fn clear_slots(_: u32, _: &RunWindow, slot: &mut Slot) {
    *slot = Slot { rank: NO_PIXEL, sample: 0 };
}
