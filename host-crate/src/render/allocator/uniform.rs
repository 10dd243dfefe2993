//! The uniform part of a stream, which is all of it with the allocator `uniform`: every pixel gets
//! the same number of samples.

use super::{RoundBuffers, Stream};
use crate::exec::{Array, ExecError, Executor, Launch, View, kernels};
use crate::render::film::{Band, FilmBuffers, WINDOW_ALIGNMENT};
use bytemuck::Zeroable;
use raystream_shaders::film::stream::RunWindow;
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
        if stream.uniform == 0 {
            return Vec::new();
        }
        fill_runs(buffers, stream, |_| self.no_starts.view(), Part::Uniform)
    }

    /// Launches that add the contributions of that part to the film.
    pub fn accumulate<'a>(
        &'a self,
        buffers: &RoundBuffers<'a, B>,
        stream: &Stream,
    ) -> Vec<Launch<'a, B>> {
        if stream.uniform == 0 {
            return Vec::new();
        }
        accumulate_runs(buffers, stream, |_| self.no_starts.view(), Part::Uniform)
    }
}

/// Streams that give every pixel `samples` samples.
pub(super) fn windows_of<B>(film: &FilmBuffers<B>, samples: u32, largest: u32) -> Vec<Stream> {
    let mut streams = Vec::new();
    let mut left = samples;
    while left > 0 {
        let uniform = left.min((largest / WINDOW_ALIGNMENT).max(1));
        for band in film.bands() {
            let mut next = 0;
            while let Some(window) = band.window(next, largest / uniform) {
                next = window.end;
                let pixels = band.first_rank + window.start..band.first_rank + window.end;
                streams.push(Stream { slots: pixels.len() as u32 * uniform, uniform, pixels });
            }
        }
        left -= uniform;
    }
    streams
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

/// Adds the contributions of such a part to the film.
pub(super) fn accumulate_runs<'a, B>(
    buffers: &RoundBuffers<'a, B>,
    stream: &Stream,
    starts: impl Fn(&Band<B>) -> View<'a, B, u32>,
    part: Part,
) -> Vec<Launch<'a, B>> {
    let contributions = || buffers.contributions.slice(0..stream.slots as usize);
    windows(buffers, stream, part)
        .map(|(band, pixels, window)| {
            kernels::accumulate_runs(
                &window,
                starts(band),
                contributions().cast(),
                band.film.slice(pixels),
            )
        })
        .collect()
}

/// The bands that have pixels of a stream of runs, these pixels' places there, and what kernels
/// with a lane for each are told.
fn windows<'a, B>(
    buffers: &RoundBuffers<'a, B>,
    stream: &Stream,
    part: Part,
) -> impl Iterator<Item = (&'a Band<B>, Range<usize>, RunWindow)> {
    let (split, uniform, first_pixel) = (buffers.split, stream.uniform, stream.pixels.start);
    let uniform_slots = stream.uniform_slots();
    buffers.film.bands_of(&stream.pixels).map(move |(band, pixels)| {
        let threads = pixels.len() as u32;
        let first_rank = band.first_rank + pixels.start;
        let shared = RunWindow { threads, first_rank, pixels: threads, ..RunWindow::zeroed() };
        let window = match part {
            Part::Uniform => RunWindow {
                samples: uniform,
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
