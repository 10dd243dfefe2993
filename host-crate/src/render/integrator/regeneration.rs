//! The integrator `regeneration`: threads take slot after slot.

use super::{Integrator, StreamBuffers};
use crate::exec::{Counter, ExecError, Executor, Launch, kernels};
use raystream_shaders::integrator::params::PathParams;
use raystream_shaders::integrator::regeneration::SEGMENTS;
use std::ops::Range;

/// More threads than any device holds at once. Those that start late find no slot left.
pub const RESIDENT: u32 = 1 << 18;

/// Threads of a launch over `slots` slots of paths of at most `max_depth` segments: enough to take
/// all, however long paths turn out to be.
fn threads(slots: u32, max_depth: u32) -> u32 {
    let slots_of_a_thread = SEGMENTS.div_ceil(max_depth);
    slots.div_ceil(slots_of_a_thread).max(slots.min(RESIDENT))
}

/// See the [module](self).
pub struct Regeneration<B> {
    /// How many slots of the part have been taken.
    taken: Counter<B>,
}

impl<B> Regeneration<B> {
    /// A new one.
    pub fn new<E: Executor<Buffer = B>>(executor: &E) -> Result<Self, ExecError> {
        Ok(Self { taken: Counter::new(executor, "a counter of slots")? })
    }
}

impl<E: Executor> Integrator<E> for Regeneration<E::Buffer> {
    fn trace<'a>(
        &'a self,
        stream: &StreamBuffers<'a, E::Buffer>,
        part: Range<u32>,
    ) -> Vec<Launch<'a, E::Buffer>> {
        let slots = part.start as usize..part.end as usize;
        let threads = threads(part.end - part.start, stream.parameters.max_depth);
        vec![
            self.taken.clear(),
            kernels::regenerate_paths(
                &PathParams { threads, ..*stream.parameters },
                stream.scene,
                stream.slots.slice(slots.clone()),
                stream.contributions.slice(slots),
                self.taken.view(),
            ),
        ]
    }
}
