//! The uniform part of a stream, which is all of it with the allocator `uniform`: every pixel gets
//! the same number of samples.

use super::{RoundBuffers, Stream};
use crate::exec::{Array, ExecError, Executor, Launch, View, kernels};
use crate::render::film::{Band, FilmBuffers, WINDOW_ALIGNMENT};
use bytemuck::Zeroable;
use raystream_shaders::film::stream::RunWindow;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Every pixel equally.
pub struct Uniform<B> {
    /// Bound where runs of different lengths would have their starts.
    no_starts: Array<B, u32>,
}

impl<B> Uniform<B> {
    /// A new one.
    pub fn new<E: Executor<Buffer = B>>(executor: &E) -> Result<Self, ExecError> {
        Ok(Self { no_starts: Array::zeroed(executor, "nothing", 1)? })
    }

    /// Launches that fill the uniform part of a stream.
    pub fn fill<'a>(
        &'a self,
        buffers: &RoundBuffers<'a, B>,
        stream: &Stream,
    ) -> Vec<Launch<'a, B>> {
        fill_runs(buffers, stream, |_| self.no_starts.view(), Part::Uniform)
    }
}

/// What is left of a uniform round: streams are made of it one by one, each no longer than is
/// wanted by then. By default nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Windows {
    /// Samples of each pixel that are left, those of the pass under way included.
    samples: u32,
    /// Samples of each pixel in the pass under way.
    pass: u32,
    /// Rank of the next pixel of the pass.
    next: u32,
}

impl Windows {
    /// A round that gives every pixel `samples` samples.
    pub fn new(samples: u32) -> Self {
        Self { samples, pass: 0, next: 0 }
    }

    /// Samples of each pixel that are left, those of the pass under way included.
    pub fn samples(self) -> u32 {
        self.samples
    }

    /// What is left, in the same words wherever nothing is.
    pub fn rest(self) -> Self {
        if self.samples == 0 { Self::default() } else { self }
    }

    /// Slots that are left, for a film of `pixels` pixels.
    pub fn slots(self, pixels: u32) -> u64 {
        let all = u64::from(self.samples) * u64::from(pixels);
        all - u64::from(self.pass.min(self.samples)) * u64::from(self.next)
    }

    /// The next window of pixels whose slots are at most `largest`; where even the smallest
    /// window's are more, in a pass of fewer samples. None at the round's end. Its first sample
    /// is left open.
    pub fn next<B>(&mut self, film: &FilmBuffers<B>, largest: u32) -> Option<Stream> {
        if self.samples == 0 {
            return None;
        }
        if self.next == 0 {
            let smallest = WINDOW_ALIGNMENT.min(film.pixels());
            self.pass = self.samples.min((largest / smallest).max(1));
        }
        let left = self.next..film.pixels();
        let (band, _) = film.bands_of(&left).next()?;
        let window = band.window(self.next - band.first_rank, largest / self.pass)?;
        let pixels = band.first_rank + window.start..band.first_rank + window.end;
        self.next = pixels.end;
        let (uniform, slots) = (self.pass, pixels.len() as u32 * self.pass);
        let stream = Stream { pixels, uniform, first_sample: 0, slots };
        if self.next == film.pixels() {
            self.samples -= self.pass;
            self.next = 0;
        }
        Some(stream)
    }
}

/// A part of a stream of runs.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Part {
    /// Runs of one length.
    Uniform,
    /// Runs that begin where a table says.
    Adaptive,
}

/// Fills a part of a stream of runs, the adaptive one as `starts` (of a band's pixels) says.
pub(super) fn fill_runs<'a, B>(
    buffers: &RoundBuffers<'a, B>,
    stream: &Stream,
    starts: impl Fn(&Band<B>) -> View<'a, B, u32>,
    part: Part,
) -> Vec<Launch<'a, B>> {
    let slots = || buffers.slots.slice(0..stream.slots as usize);
    windows(buffers, stream, part)
        .map(|(band, pixels, window)| {
            kernels::fill_runs(&window, starts(band), band.film.slice(pixels), slots())
        })
        .collect()
}

/// The bands that have pixels of a part of a stream, these pixels' places there, and what kernels
/// with a lane for each are told; none where the part is empty.
fn windows<'a, B>(
    buffers: &RoundBuffers<'a, B>,
    stream: &Stream,
    part: Part,
) -> impl Iterator<Item = (&'a Band<B>, Range<usize>, RunWindow)> {
    let (split, uniform, first_pixel) = (buffers.split, stream.uniform, stream.pixels.start);
    let stream_first = stream.first_sample;
    let uniform_slots = stream.uniform_slots();
    let is_empty = part == Part::Uniform && uniform == 0;
    let bands = buffers.film.bands_of(&stream.pixels).filter(move |_| !is_empty);
    bands.map(move |(band, pixels)| {
        let threads = pixels.len() as u32;
        let first_rank = band.first_rank + pixels.start;
        let shared = RunWindow { threads, first_rank, pixels: threads, ..RunWindow::zeroed() };
        let window = match part {
            Part::Uniform => RunWindow {
                samples: uniform,
                first_sample: stream_first,
                first_slot: (first_rank - first_pixel) * uniform,
                half: split.of_uniform(),
                ..shared
            },
            Part::Adaptive => {
                RunWindow { first_slot: uniform_slots, half: split.of_adaptive(), ..shared }
            }
        };
        (band, pixels.start as usize..pixels.end as usize, window)
    })
}
