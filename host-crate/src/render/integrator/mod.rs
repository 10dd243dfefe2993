//! Integrators: how the contributions of a stream's slots are computed.
//!
//! | name | what it is |
//! |---|---|
//! | [`megakernel`] | one thread walks one path to its end |
//! | [`regeneration`] | a fixed number of threads; each takes the next slot when its path ends |
//! | `compaction` ([`wavefront`]) | all paths advance a segment at a time; ended ones are removed |
//! | `streaming` ([`wavefront`]) | likewise, and the next slots take their places |
//! | [`lvc`] | bidirectional, with a cache of light vertices |
//!
//! All but the last call the same functions of [`raystream_shaders::integrator::path`], which do
//! the same arithmetic in the same order.

pub mod first_hits;
pub mod lvc;
mod lvc_numbers;
pub mod megakernel;
mod passes;
pub mod regeneration;
pub mod wavefront;

use super::film::splats::SplatSums;
use super::settings::{IntegratorKind, Settings};
use crate::exec::{Array, ExecError, Executor, Launch, SceneBuffers};
use raystream_shaders::film::Contribution;
use raystream_shaders::film::stream::Slot;
use raystream_shaders::integrator::params::PathParams;
use std::ops::Range;

/// Turns slots into contributions.
///
/// The contribution of a slot depends on the slot (pixel and sample number) and on the scene, not
/// on the lane that computes it nor on the other slots; that of an empty slot
/// ([`NO_PIXEL`](raystream_shaders::film::stream::NO_PIXEL)) is [`Contribution::NOTHING`].
pub trait Integrator<E: Executor>: Send + Sync {
    /// Launches that must come before a round's paths are traced.
    fn begin_round<'a>(
        &'a self,
        _stream: &StreamBuffers<'a, E::Buffer>,
        _round: u32,
    ) -> Vec<Launch<'a, E::Buffer>> {
        Vec::new()
    }

    /// Launches that compute the contributions of the slots of `part`, which begins at a multiple
    /// of [`WINDOW_ALIGNMENT`](super::film::WINDOW_ALIGNMENT) and is not empty.
    fn trace<'a>(
        &'a self,
        stream: &StreamBuffers<'a, E::Buffer>,
        part: Range<u32>,
    ) -> Vec<Launch<'a, E::Buffer>>;

    /// How many paths were under way in each iteration over `part`, whose launches were the last
    /// that were run; empty where paths do not advance in step. For measurements: it waits for the
    /// device.
    fn active_paths(
        &self,
        _executor: &E,
        _stream: &StreamBuffers<'_, E::Buffer>,
        _part: Range<u32>,
    ) -> Result<Vec<u32>, ExecError> {
        Ok(Vec::new())
    }

    /// Copies to the host what the rounds so far have found without slots, to be added to the
    /// samples of each pixel, see [`Film::splats`](crate::film::Film::splats). None where all that
    /// is found is in contributions.
    fn splats(&self, _executor: &E) -> Result<Option<SplatSums>, ExecError> {
        Ok(None)
    }

    /// Goes on from sums that an integrator of the same scene and settings has given.
    fn restore(&self, _executor: &E, _splats: &SplatSums) -> Result<(), ExecError> {
        Ok(())
    }

    /// Slots that should share what one [`begin_round`](Self::begin_round) makes, at most; a round
    /// may always have one for each pixel. Where there is a limit, contributions may depend on the
    /// number of the round as well.
    fn slots_of_round(&self) -> u64 {
        u64::MAX
    }
}

/// What integrators work on.
pub struct StreamBuffers<'a, B> {
    /// The scene.
    pub scene: &'a SceneBuffers<B>,
    /// What is the same for all paths; `threads` is 0.
    pub parameters: &'a PathParams,
    /// The stream.
    pub slots: &'a Array<B, Slot>,
    /// What comes of it, an element for each slot.
    pub contributions: &'a Array<B, Contribution>,
}

/// What a new integrator may look at.
pub struct IntegratorContext<'a, E: Executor> {
    /// The device.
    pub executor: &'a E,
    /// The scene, there.
    pub scene: &'a SceneBuffers<E::Buffer>,
    /// What is the same for all paths; `threads` is 0.
    pub parameters: &'a PathParams,
    /// The render.
    pub settings: &'a Settings,
}

/// A new integrator for streams of at most `capacity` slots; it asks for memory only as far as it
/// needs it.
pub fn create<E: Executor>(
    context: &IntegratorContext<'_, E>,
    capacity: u32,
) -> Result<Box<dyn Integrator<E>>, ExecError> {
    let abilities = context.scene.abilities();
    let kind = match context.settings.integrator {
        IntegratorKind::Auto if context.executor.runs_in_step() => IntegratorKind::Regeneration,
        IntegratorKind::Auto => IntegratorKind::Megakernel,
        chosen => chosen,
    };
    Ok(match kind {
        IntegratorKind::Auto | IntegratorKind::Megakernel => Box::new(megakernel::Megakernel),
        IntegratorKind::Regeneration => {
            Box::new(regeneration::Regeneration::new(context.executor)?)
        }
        IntegratorKind::Compaction => {
            Box::new(wavefront::Wavefront::compaction(context.executor, abilities, capacity)?)
        }
        IntegratorKind::Streaming => {
            Box::new(wavefront::Wavefront::streaming(context.executor, abilities, capacity)?)
        }
        IntegratorKind::Lvc => Box::new(lvc::Lvc::new(context)?),
    })
}
