//! The sample stream: which pixel each slot of a round traces.
//!
//! The stream of a round is a list of slots, each one path. The slots of one pixel are consecutive (a
//! **run**), and runs follow each other in rank order (see [`crate::tiles`]): neighbours in the stream are
//! neighbours in the picture, and accumulation is a loop over a pixel's own run.

use crate::device_struct;
use crate::film::FilmPixel;

device_struct! {
    /// The parameters of one window of a uniform round: ranks `first_rank ..`, `samples` slots each. 16 bytes.
    pub struct UniformWindow {
        /// Slots in the window: ranks times `samples`.
        pub threads: u32,
        /// Rank of the window's first pixel; the film that is bound starts there.
        pub first_rank: u32,
        /// Slots of each pixel, at least 1.
        pub samples: u32,
        /// Unused; zero.
        pub pad: u32,
    }
}

device_struct! {
    /// One slot of the stream. 8 bytes.
    pub struct Slot {
        /// Rank of the pixel.
        pub rank: u32,
        /// Which sample of the pixel this is, counted from 0 over the whole render: the index into its
        /// sample sequence.
        pub sample: u32,
    }
}

/// Kernel: the slot number `lane` of a window in which every pixel gets the same number of samples.
pub fn uniform_stream(lane: u32, window: &UniformWindow, film: &[FilmPixel], slot: &mut Slot) {
    let pixel = lane / window.samples;
    *slot = Slot { rank: window.first_rank + pixel, sample: film[pixel as usize].samples + lane % window.samples };
}
