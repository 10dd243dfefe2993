//! Allocators: which pixels a round samples, and the way of its contributions into the film.

use super::film::Band;
use crate::exec::{Array, Launch, kernels};
use raystream_shaders::film::{AccumulateWindow, Contribution};
use raystream_shaders::stream::{Slot, UniformWindow};
use std::ops::Range;

/// The allocator `uniform`: every pixel gets the same number of samples.
///
/// A round is worked off in windows, ranges of pixels within one band of the film, whose slots fit the batch.
#[derive(Clone, Copy, Debug)]
pub struct Uniform {
    /// Samples that the round gives each pixel, at least 1.
    pub samples: u32,
}

impl Uniform {
    /// Slots of a window.
    pub fn slots(&self, window: &Range<u32>) -> u32 {
        (window.end - window.start) * self.samples
    }

    /// Fills the window's part of the sample stream.
    pub fn fill<'a, B>(&self, band: &'a Band<B>, window: &Range<u32>, slots: &'a Array<B, Slot>) -> Launch<'a, B> {
        let threads = self.slots(window);
        Launch::new(
            &kernels::uniform_stream,
            &UniformWindow { threads, first_rank: band.first_rank + window.start, samples: self.samples, pad: 0 },
            vec![band.film.slice(pixels(window)), slots.slice(0..threads as usize)],
        )
    }

    /// Adds the window's contributions to the film.
    pub fn accumulate<'a, B>(
        &self,
        band: &'a Band<B>,
        window: &Range<u32>,
        contributions: &'a Array<B, Contribution>,
    ) -> Launch<'a, B> {
        Launch::new(
            &kernels::accumulate_runs,
            &AccumulateWindow { threads: window.end - window.start, samples: self.samples, pad0: 0, pad1: 0 },
            vec![contributions.slice(0..self.slots(window) as usize), band.film.slice(pixels(window))],
        )
    }
}

fn pixels(window: &Range<u32>) -> Range<usize> {
    window.start as usize..window.end as usize
}
