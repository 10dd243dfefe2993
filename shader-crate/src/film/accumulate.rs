//! How a round's contributions get into the film.
//!
//! Accumulation is exact: a pixel is owned by one thread, which adds its run in slot order, and the
//! additions are those of [compensated sums](super::sum), which leave a compiler nothing to fuse
//! and no order to vary. The same contributions give the same film, bit for bit, on any processor
//! that adds like IEEE 754.

use super::stream::{RunWindow, Runs, counted, is_second};
use super::{Contribution, FilmPixel};
use crate::glam::UVec4;
use crate::memory::access::at;
use crate::memory::device_struct;
use crate::memory::rows::vector;

/// `uvec4`s of one contribution.
pub(super) const ROWS_PER_CONTRIBUTION: u32 = 2;

/// The contributions of a stream, as whoever adds them up reads them: sixteen bytes at a time, in a
/// quarter of the loads.
#[derive(Clone, Copy)]
pub struct ContributionView<'a> {
    rows: &'a [UVec4],
}

impl<'a> ContributionView<'a> {
    /// Wraps the buffer.
    pub fn new(rows: &'a [UVec4]) -> Self {
        Self { rows }
    }

    /// The contribution of `slot`.
    #[inline(always)]
    pub fn get(&self, slot: u32) -> Contribution {
        let radiance = at(self.rows, slot * ROWS_PER_CONTRIBUTION);
        let squared = at(self.rows, slot * ROWS_PER_CONTRIBUTION + 1);
        Contribution {
            radiance: vector(radiance),
            rays: radiance.w,
            squared: vector(squared),
            zero: squared.w,
        }
    }
}

/// Kernel: adds to the pixel `lane` of a window its run of contributions, in slot order.
pub fn accumulate_runs(
    lane: u32,
    window: &RunWindow,
    starts: &[u32],
    contributions: &[UVec4],
    film: &mut FilmPixel,
) {
    let runs = Runs::new(window, starts);
    let mut slot = runs.start(lane);
    let end = runs.start(lane + 1);
    if slot == end {
        return;
    }
    let contributions = ContributionView::new(contributions);
    let last = end - 1;
    let mut pixel = *film;
    let mut count = counted(window.half, &pixel);
    // Sums must be taken in order, but loads need not wait for them. The next four are loaded a
    // turn before they are added: a compiler that has them in the same turn delays each until it is
    // added, and a long run takes as long as its loads, one after the other.
    let (mut a, mut b, mut c, mut d) = (
        load(&contributions, last, slot),
        load(&contributions, last, slot + 1),
        load(&contributions, last, slot + 2),
        load(&contributions, last, slot + 3),
    );
    while slot < end {
        let next = (
            load(&contributions, last, slot + 4),
            load(&contributions, last, slot + 5),
            load(&contributions, last, slot + 6),
            load(&contributions, last, slot + 7),
        );
        pixel.add(&a, is_second(window.half, count));
        if slot < last {
            pixel.add(&b, is_second(window.half, count + 1));
        }
        if slot + 1 < last {
            pixel.add(&c, is_second(window.half, count + 2));
        }
        if slot + 2 < last {
            pixel.add(&d, is_second(window.half, count + 3));
        }
        slot += 4;
        count += 4;
        (a, b, c, d) = next;
    }
    *film = pixel;
}

/// The contribution of `slot`, or of the last one.
#[inline(always)]
fn load(contributions: &ContributionView<'_>, last: u32, slot: u32) -> Contribution {
    contributions.get(slot.min(last))
}

device_struct! {
    /// The parameters of a count of rays or of samples. 16 bytes.
    pub struct CountParams {
        /// Partial sums of rays; pixels whose samples are counted.
        pub threads: u32,
        /// Pixels of the film that is bound.
        pub pixels: u32,
        /// Unused; zero.
        pub pad0: u32,
        /// Unused; zero.
        pub pad1: u32,
    }
}

/// Kernel: the samples of pixel `lane` of a film.
pub fn copy_counts(lane: u32, _: &CountParams, film: &[FilmPixel], count: &mut u32) {
    *count = at(film, lane).samples();
}

/// Kernel: the rays of every `threads`-th pixel, from pixel `lane` on.
pub fn count_rays(lane: u32, params: &CountParams, film: &[FilmPixel], rays: &mut u32) {
    let mut sum = 0_u32;
    let mut pixel = lane;
    while pixel < params.pixels {
        sum = sum.wrapping_add(at(film, pixel).rays);
        pixel += params.threads;
    }
    *rays = sum;
}
