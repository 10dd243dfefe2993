//! Allocators: which pixels a round samples, and the way of its contributions into the film.
//!
//! | name | what it is |
//! |---|---|
//! | [`uniform`] | every pixel equally |
//! | [`runs`] | in proportion to the error, each pixel a run of consecutive slots |
//! | [`paper`] | streams of pixels whose error exceeds random thresholds |
//! | [`atomic`] | in proportion to the error, slots and sums by atomics |

pub mod atomic;
pub mod paper;
pub mod runs;
pub mod sampling;
pub mod uniform;

use self::sampling::AllocatorKind;
use super::film::FilmBuffers;
use crate::exec::{Array, ExecError, Executor, Launch};
use raystream_shaders::film::Contribution;
use raystream_shaders::film::stream::Slot;
use std::ops::Range;

/// Turns errors into sample streams, and streams into film.
///
/// A pixel's sample numbers continue its film's count without gaps. Samples are added to a pixel in
/// the order of their numbers, by one thread at a time: then the film does not depend on the
/// device. (All but [`atomic`] keep to this.)
pub trait Allocator<E: Executor>: Send + Sync {
    /// Cuts a round of `paths` paths into streams of at most `largest` slots.
    fn streams(&self, film: &FilmBuffers<E::Buffer>, paths: u64, largest: u32) -> Vec<Stream>;

    /// Launches that make the stream `stream` of the errors and of the film's counts.
    fn fill<'a>(
        &'a self,
        buffers: &RoundBuffers<'a, E::Buffer>,
        stream: &Stream,
    ) -> Vec<Launch<'a, E::Buffer>>;

    /// Launches that add the stream's contributions to the film.
    fn accumulate<'a>(
        &'a self,
        buffers: &RoundBuffers<'a, E::Buffer>,
        stream: &Stream,
    ) -> Vec<Launch<'a, E::Buffer>>;

    /// How many of the stream's slots were filled, once it has been accumulated.
    fn filled(&self, _executor: &E, stream: &Stream) -> Result<u32, ExecError> {
        Ok(stream.slots)
    }
}

/// A stream of a round.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Stream {
    /// Ranks of the pixels that it may sample; a multiple of
    /// [`WINDOW_ALIGNMENT`](super::film::WINDOW_ALIGNMENT) at its start.
    pub pixels: Range<u32>,
    /// Its slots.
    pub slots: u32,
}

/// What the launches of a round work on.
pub struct RoundBuffers<'a, B> {
    /// The film.
    pub film: &'a FilmBuffers<B>,
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

/// A new allocator for pictures of `pixels` pixels; it asks for memory only as far as it needs it.
pub fn create<E: Executor>(
    kind: AllocatorKind,
    executor: &E,
    pixels: u32,
) -> Result<Box<dyn Allocator<E>>, ExecError> {
    Ok(match kind {
        AllocatorKind::Uniform => Box::new(uniform::Uniform::new(executor)?),
        AllocatorKind::Paper => Box::new(paper::Paper::new(executor, pixels)?),
        AllocatorKind::Atomic => Box::new(atomic::Atomic::new(executor, pixels)?),
        AllocatorKind::Runs => Box::new(runs::Runs::new(executor, pixels)?),
    })
}

/// One stream over the whole picture.
fn one_stream<B>(film: &FilmBuffers<B>, paths: u64, largest: u32) -> Vec<Stream> {
    vec![Stream { pixels: 0..film.pixels(), slots: paths.min(u64::from(largest)) as u32 }]
}
