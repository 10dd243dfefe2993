//! The integrator `megakernel`: one thread walks one path to its end.

use super::{Integrator, StreamBuffers};
use crate::exec::{Executor, Launch, kernels};
use raystream_shaders::integrator::params::PathParams;
use std::ops::Range;

/// See the [module](self). It needs no memory of its own.
pub struct Megakernel;

impl<E: Executor> Integrator<E> for Megakernel {
    fn trace<'a>(
        &'a self,
        stream: &StreamBuffers<'a, E::Buffer>,
        part: Range<u32>,
    ) -> Vec<Launch<'a, E::Buffer>> {
        let slots = part.start as usize..part.end as usize;
        vec![kernels::trace_paths(
            &PathParams { threads: part.end - part.start, ..*stream.parameters },
            stream.scene,
            stream.slots.slice(slots.clone()),
            stream.contributions.slice(slots),
        )]
    }
}
