//! The allocator `uniform`: every pixel gets the same number of samples.

use super::{Allocator, RoundBuffers, Stream};
use crate::exec::{Array, ExecError, Executor, Launch, View, kernels};
use crate::render::film::{Band, FilmBuffers, WINDOW_ALIGNMENT};
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
}

impl<E: Executor> Allocator<E> for Uniform<E::Buffer> {
    /// Cuts the round, `paths / pixels` samples for each pixel, into windows of pixels whose slots
    /// fit, and where even the smallest window's do not, into passes of fewer samples.
    fn streams(&self, film: &FilmBuffers<E::Buffer>, paths: u64, largest: u32) -> Vec<Stream> {
        let mut streams = Vec::new();
        let mut left = (paths / u64::from(film.pixels())) as u32;
        while left > 0 {
            let samples = left.min((largest / WINDOW_ALIGNMENT).max(1));
            for band in film.bands() {
                let mut next = 0;
                while let Some(window) = band.window(next, largest / samples) {
                    next = window.end;
                    let pixels = band.first_rank + window.start..band.first_rank + window.end;
                    streams.push(Stream { slots: pixels.len() as u32 * samples, pixels });
                }
            }
            left -= samples;
        }
        streams
    }

    fn fill<'a>(
        &'a self,
        buffers: &RoundBuffers<'a, E::Buffer>,
        stream: &Stream,
    ) -> Vec<Launch<'a, E::Buffer>> {
        fill_runs(
            buffers,
            stream,
            |_| self.no_starts.view(),
            stream.slots / stream.pixels.len() as u32,
        )
    }

    fn accumulate<'a>(
        &'a self,
        buffers: &RoundBuffers<'a, E::Buffer>,
        stream: &Stream,
    ) -> Vec<Launch<'a, E::Buffer>> {
        accumulate_runs(
            buffers,
            stream,
            |_| self.no_starts.view(),
            stream.slots / stream.pixels.len() as u32,
        )
    }
}

/// Fills a stream of runs: of `samples` slots each, or as `starts` (of a band's pixels) says where
/// that is 0.
pub(super) fn fill_runs<'a, B>(
    buffers: &RoundBuffers<'a, B>,
    stream: &Stream,
    starts: impl Fn(&Band<B>) -> View<'a, B, u32>,
    samples: u32,
) -> Vec<Launch<'a, B>> {
    let slots = || buffers.slots.slice(0..stream.slots as usize);
    windows(buffers.film, stream, samples)
        .map(|(band, pixels, window)| {
            kernels::fill_runs(&window, starts(band), band.film.slice(pixels), slots())
        })
        .collect()
}

/// Adds the contributions of a stream of runs to the film, likewise.
pub(super) fn accumulate_runs<'a, B>(
    buffers: &RoundBuffers<'a, B>,
    stream: &Stream,
    starts: impl Fn(&Band<B>) -> View<'a, B, u32>,
    samples: u32,
) -> Vec<Launch<'a, B>> {
    let contributions = || buffers.contributions.slice(0..stream.slots as usize);
    windows(buffers.film, stream, samples)
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
    film: &'a FilmBuffers<B>,
    stream: &Stream,
    samples: u32,
) -> impl Iterator<Item = (&'a Band<B>, Range<usize>, RunWindow)> {
    film.bands_of(&stream.pixels).map(move |(band, pixels)| {
        let threads = pixels.len() as u32;
        let window = RunWindow {
            threads,
            first_rank: band.first_rank + pixels.start,
            pixels: threads,
            samples,
        };
        (band, pixels.start as usize..pixels.end as usize, window)
    })
}
