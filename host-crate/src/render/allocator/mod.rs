//! Allocators: which pixels a round samples, and the way of its contributions into the film.
//!
//! | name | what it is |
//! |---|---|
//! | [`uniform`] | every pixel equally: what each round begins with |
//! | [`runs`] | filled up to what the error deserves, each pixel a run of consecutive slots |
//! | [`paper`] | streams of pixels whose error exceeds random thresholds |
//! | [`atomic`] | in proportion to the error, slots and sums by atomics |

pub mod atomic;
mod error_scale;
pub mod paper;
mod run_table;
pub mod runs;
pub mod uniform;

pub use self::uniform::Windows;

use self::uniform::Uniform;
use super::film::FilmBuffers;
use super::settings::sampling::{AllocatorKind, Split};
use crate::exec::{Array, ExecError, Executor, Launch, kernels};
use raystream_shaders::film::Contribution;
use raystream_shaders::film::accumulate::{AccumulateParams, LANES_PER_STRETCH};
use raystream_shaders::film::stream::Slot;
use std::ops::Range;

/// Turns errors into the adaptive part of a sample stream.
///
/// A pixel's sample numbers continue its film's counts without gaps.
pub trait Allocator<E: Executor>: Send + Sync {
    /// Launches that fill the adaptive part of `stream`, by the errors and the film's counts.
    fn fill<'a>(
        &'a self,
        buffers: &RoundBuffers<'a, E::Buffer>,
        stream: &Stream,
    ) -> Vec<Launch<'a, E::Buffer>>;

    /// Whether the slots of a pixel follow each other in that part.
    fn in_runs(&self) -> bool {
        true
    }

    /// How many slots of that part were filled, once it has been accumulated.
    fn filled(&self, _executor: &E, stream: &Stream) -> Result<u32, ExecError> {
        Ok(stream.adaptive_slots())
    }
}

/// A stream of a round: a uniform part, then an adaptive one. Either may be empty.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Stream {
    /// Ranks of the pixels that it may sample; a multiple of
    /// [`WINDOW_ALIGNMENT`](super::film::WINDOW_ALIGNMENT) at its start, all of them where there is
    /// an adaptive part.
    pub pixels: Range<u32>,
    /// Samples of each pixel in the uniform part.
    pub uniform: u32,
    /// Samples that each pixel has had, of those that the half of the uniform part counts.
    pub first_sample: u32,
    /// Slots of both parts.
    pub slots: u32,
}

impl Stream {
    /// Slots of the uniform part, which is the first.
    pub fn uniform_slots(&self) -> u32 {
        self.uniform * self.pixels.len() as u32
    }

    /// Slots of the adaptive part.
    pub fn adaptive_slots(&self) -> u32 {
        self.slots - self.uniform_slots()
    }
}

/// What the launches of a round work on.
pub struct RoundBuffers<'a, B> {
    /// The film.
    pub film: &'a FilmBuffers<B>,
    /// Paths that the film has, at least.
    pub paths: u64,
    /// How samples are split into halves.
    pub split: Split,
    /// The error of each pixel, in rank order, see [`raystream_shaders::allocator::error_scale`].
    /// Of any length where nobody estimates.
    pub errors: &'a Array<B, f32>,
    /// The stream.
    pub slots: &'a Array<B, Slot>,
    /// What came of it.
    pub contributions: &'a Array<B, Contribution>,
    /// A random number of the round.
    pub salt: u32,
}

impl<B> Clone for RoundBuffers<'_, B> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<B> Copy for RoundBuffers<'_, B> {}

/// Both parts of every stream: what pixels get alike, and what an allocator makes of the errors.
pub struct Allocation<E: Executor> {
    uniform: Uniform<E::Buffer>,
    /// None for [`AllocatorKind::Uniform`].
    adaptive: Option<Box<dyn Allocator<E>>>,
}

impl<E: Executor> Allocation<E> {
    /// For pictures of `pixels` pixels; it asks for memory only as far as it needs it.
    pub fn new(kind: AllocatorKind, executor: &E, pixels: u32) -> Result<Self, ExecError> {
        let adaptive: Option<Box<dyn Allocator<E>>> = match kind {
            AllocatorKind::Uniform => None,
            AllocatorKind::Paper => Some(Box::new(paper::Paper::new(executor, pixels)?)),
            AllocatorKind::Atomic => Some(Box::new(atomic::Atomic::new(executor, pixels)?)),
            AllocatorKind::Runs => Some(Box::new(runs::Runs::new(executor, pixels)?)),
        };
        Ok(Self { uniform: Uniform::new(executor)?, adaptive })
    }

    fn adaptive_part(&self, stream: &Stream) -> Option<&dyn Allocator<E>> {
        self.adaptive.as_deref().filter(|_| stream.adaptive_slots() > 0)
    }

    /// Launches that fill a stream.
    pub fn fill<'a>(
        &'a self,
        buffers: &RoundBuffers<'a, E::Buffer>,
        stream: &Stream,
    ) -> Vec<Launch<'a, E::Buffer>> {
        let mut launches = self.uniform.fill(buffers, stream);
        if let Some(allocator) = self.adaptive_part(stream) {
            launches.extend(allocator.fill(buffers, stream));
        }
        launches
    }

    /// Launches that add what came of a stream to the film.
    pub fn accumulate<'a>(
        &'a self,
        buffers: &RoundBuffers<'a, E::Buffer>,
        stream: &Stream,
    ) -> Vec<Launch<'a, E::Buffer>> {
        let uniform = stream.uniform_slots();
        // Whole runs, so that nobody waits for atomics.
        let stretch = stream.uniform.min(LONGEST_STRETCH);
        let mut launches = accumulated(buffers, stream, 0..uniform, (true, stretch));
        if let Some(allocator) = self.adaptive_part(stream) {
            let slots = uniform..stream.slots;
            let order = (allocator.in_runs(), STRETCH);
            launches.extend(accumulated(buffers, stream, slots, order));
        }
        launches
    }

    /// How many slots of a stream were filled, once it has been accumulated.
    pub fn filled(&self, executor: &E, stream: &Stream) -> Result<u32, ExecError> {
        let adaptive =
            self.adaptive_part(stream).map(|a| a.filled(executor, stream)).transpose()?;
        Ok(stream.uniform_slots() + adaptive.unwrap_or(0))
    }
}

/// Slots that are added up in one go in adaptive parts of streams: more than most runs have, few
/// enough for all processors of a GPU to have some.
const STRETCH: u32 = 16;
/// The same where runs are of one length, which is taken if it is not more than this.
const LONGEST_STRETCH: u32 = 64;

/// Adds the contributions of a part of a stream to the film, by stretches of so many slots, which are
/// in runs or not.
fn accumulated<'a, B>(
    buffers: &RoundBuffers<'a, B>,
    stream: &Stream,
    slots: Range<u32>,
    (in_runs, stretch): (bool, u32),
) -> Vec<Launch<'a, B>> {
    let film = buffers.film;
    let bands = film.bands_of(&stream.pixels).filter(|_| !slots.is_empty());
    let in_band = bands.map(|(band, _)| {
        let parameters = AccumulateParams {
            threads: (slots.len() as u32).div_ceil(stretch) * LANES_PER_STRETCH,
            first_slot: slots.start,
            end_slot: slots.end,
            first_rank: band.first_rank,
            pixels: band.film.len() as u32,
            unit_exponent: film.unit_exponent(),
            in_runs: in_runs.into(),
            stretch,
        };
        let all = 0..slots.end as usize;
        let (slots, contributions) = (buffers.slots.slice(all.clone()), buffers.contributions);
        let contributions = contributions.slice(all).cast();
        kernels::accumulate(&parameters, slots, contributions, band.film.view().cast())
    });
    in_band.collect()
}

/// The streams of a round that are still to be made.
#[derive(Clone, Debug)]
pub struct Streams {
    windows: Windows,
    /// Samples that each pixel will have had once all windows are done.
    samples: u32,
    /// The one with an adaptive part, which is the last.
    last: Option<Stream>,
}

impl Streams {
    /// Of a round of `uniform` samples for each pixel and `adaptive` slots beside, in streams of at
    /// most `largest` slots: one, if it fits. Else the uniform part is cut into windows of pixels;
    /// the adaptive part follows, cut off where it is too long. Each pixel has had `first_sample`
    /// samples, of those that the half of the uniform part counts.
    pub fn new<B>(
        film: &FilmBuffers<B>,
        uniform: u32,
        first_sample: u32,
        adaptive: u64,
        largest: u32,
    ) -> Self {
        let pixels = 0..film.pixels();
        let all = u64::from(uniform) * u64::from(film.pixels()) + adaptive;
        let samples = first_sample + uniform;
        let last = |uniform, slots| Some(Stream { pixels, uniform, first_sample, slots });
        if adaptive == 0 {
            Self { windows: Windows::new(uniform), samples, last: None }
        } else if all <= u64::from(largest) {
            Self { windows: Windows::new(0), samples, last: last(uniform, all as u32) }
        } else {
            let slots = adaptive.min(u64::from(largest)) as u32;
            Self { windows: Windows::new(uniform), samples, last: last(0, slots) }
        }
    }

    /// What is left of a round without an adaptive part, after which each pixel will have had so
    /// many samples.
    pub fn of_rest(rest: Windows, samples: u32) -> Self {
        Self { windows: rest, samples, last: None }
    }

    /// What is left of the windows.
    pub fn rest(&self) -> Windows {
        self.windows.rest()
    }

    /// The next stream; if it is a window, of at most `largest` slots.
    pub fn next<B>(&mut self, film: &FilmBuffers<B>, largest: u32) -> Option<Stream> {
        self.next_window(film, largest).or_else(|| self.last.take())
    }

    /// The next stream if it is a window, of at most `largest` slots.
    pub fn next_window<B>(&mut self, film: &FilmBuffers<B>, largest: u32) -> Option<Stream> {
        let first_sample = self.samples - self.windows.samples();
        let window = self.windows.next(film, largest)?;
        Some(Stream { first_sample, ..window })
    }
}
