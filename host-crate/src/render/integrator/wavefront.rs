//! The integrators `compaction` and `streaming`: a pool of paths that all advance by a segment at a
//! time.
//!
//! What an iteration's launches do is told in [`raystream_shaders::integrator::wavefront`]. Here is
//! how many there are. Nothing is read back on the way, so it must not depend on how long paths
//! turn out to be: see `passes.rs`.

use super::passes::Pass;
use super::{Integrator, StreamBuffers};
use crate::exec::{Array, ExecError, Executor, Launch, halve_until_it_fits, kernels};
use crate::render::film::WINDOW_ALIGNMENT;
use bytemuck::Zeroable;
use glam::UVec4;
use raystream_shaders::integrator::wavefront::WavefrontParams;
use raystream_shaders::integrator::wavefront::pool::{POOL_ROWS, POOL_ROWS_WITH_PLACES, Queue};
use raystream_shaders::parallel::prefix::BlockParams;
use raystream_shaders::scene::abilities::{LIGHT_TREE, MEDIA};
use std::ops::Range;

/// Paths in the pool of `streaming`, at most: enough to fill any GPU, few enough that their states
/// stay near the processor. `compaction` needs no larger pool than a stream is long.
const STREAMING_POOL: u32 = 1 << 20;

/// A pool that must be replaced more often than this until a stream ends would take thousands of
/// launches: then there is not enough memory.
const MOST_REPLACEMENTS: u32 = 16;

/// See the [module](self).
pub struct Wavefront<B> {
    /// Paths in the pool, at most.
    capacity: u32,
    /// Whether lanes without a path take the next slots.
    regenerates: bool,
    /// See [`queue_rows`].
    queues: u32,
    /// The queues and the states of the paths, see
    /// [`raystream_shaders::integrator::wavefront::pool`].
    rows: Array<B, UVec4>,
    /// Which lanes have a path that goes on: 1, else 0.
    goes_on: Array<B, u32>,
    /// These lanes, close together.
    kept: Array<B, u32>,
    /// How many there are before each block of lanes and, after the last, in all.
    offsets: Array<B, u32>,
}

impl<B> Wavefront<B> {
    /// Removes terminated paths; for streams of at most `stream` slots, through scenes that use
    /// these [`abilities`](raystream_shaders::scene::abilities).
    pub fn compaction<E: Executor<Buffer = B>>(
        executor: &E,
        abilities: u32,
        stream: u32,
    ) -> Result<Self, ExecError> {
        Self::of_capacity(executor, abilities, stream, stream, false)
    }

    /// Removes terminated paths and puts new ones into their places; likewise.
    pub fn streaming<E: Executor<Buffer = B>>(
        executor: &E,
        abilities: u32,
        stream: u32,
    ) -> Result<Self, ExecError> {
        Self::of_capacity(executor, abilities, stream, stream.min(STREAMING_POOL), true)
    }

    /// A pool of `capacity` paths, or half as many, and so on, until the device has room for it.
    /// Less than a sixteenth of the stream is an error.
    pub fn of_capacity<E: Executor<Buffer = B>>(
        executor: &E,
        abilities: u32,
        stream: u32,
        capacity: u32,
        regenerates: bool,
    ) -> Result<Self, ExecError> {
        let fitting = executor.limits().buffer_bytes / size_of::<UVec4>() as u64;
        let lane_rows =
            if abilities & (MEDIA | LIGHT_TREE) == 0 { POOL_ROWS } else { POOL_ROWS_WITH_PLACES };
        let rows_of = |capacity: u32| {
            u64::from(queue_rows(stream, capacity, regenerates))
                + u64::from(capacity) * u64::from(lane_rows)
        };
        let mut capacity = u64::from(capacity).min(fitting / u64::from(lane_rows)).max(1) as u32;
        while capacity > WINDOW_ALIGNMENT && rows_of(capacity) > fitting {
            capacity -= WINDOW_ALIGNMENT;
        }
        let smallest = (stream / MOST_REPLACEMENTS).max(4 * WINDOW_ALIGNMENT);
        halve_until_it_fits(capacity, smallest, |capacity| {
            Self::allocate(executor, lane_rows, stream, capacity, regenerates)
        })
    }

    fn allocate<E: Executor<Buffer = B>>(
        executor: &E,
        lane_rows: u32,
        stream: u32,
        capacity: u32,
        regenerates: bool,
    ) -> Result<Self, ExecError> {
        let lanes = capacity as usize;
        let queues = queue_rows(stream, capacity, regenerates);
        Ok(Self {
            capacity,
            regenerates,
            queues,
            rows: Array::zeroed(
                executor,
                "paths under way",
                queues as usize + lanes * lane_rows as usize,
            )?,
            goes_on: Array::zeroed(executor, "which paths go on", lanes)?,
            kept: Array::zeroed(executor, "a queue of paths", lanes)?,
            offsets: Array::zeroed(
                executor,
                "sums over paths",
                BlockParams::per_block(capacity).blocks as usize + 1,
            )?,
        })
    }

    /// The passes over a part of a stream.
    fn passes(&self, stream: &StreamBuffers<'_, B>, part: &Range<u32>) -> Vec<Pass> {
        Pass::all(
            part.end - part.start,
            self.capacity,
            self.regenerates,
            stream.parameters.max_depth,
        )
    }
}

/// Rows of the pool's buffer for the queues of all iterations over a stream, rounded up so that
/// what follows is aligned.
fn queue_rows(stream: u32, capacity: u32, regenerates: bool) -> u32 {
    let passes = Pass::all(stream, capacity, regenerates, u32::MAX);
    let iterations = passes.last().map_or(0, |pass| pass.iterations.end);
    iterations.next_multiple_of(WINDOW_ALIGNMENT)
}

/// The launches of one pass.
struct Launcher<'a, 's, B> {
    pool: &'a Wavefront<B>,
    stream: &'s StreamBuffers<'a, B>,
    part: Range<usize>,
    pass: &'s Pass,
}

impl<'a, B> Launcher<'a, '_, B> {
    fn all(&self) -> Vec<Launch<'a, B>> {
        let Range { start, end } = self.pass.iterations;
        let mut launches = Vec::new();
        for iteration in start..end {
            launches.push(self.trace(iteration));
            launches.push(self.shade(iteration));
            // In the last iteration of all every path is at its last segment, where no light is
            // sampled.
            if iteration + 1 < end || self.pass.leaves_paths {
                launches.push(self.shadow(iteration));
                launches.extend(self.compact());
            }
        }
        if self.pass.leaves_paths {
            launches.push(self.finish(end));
        }
        launches
    }

    fn parameters(&self, iteration: u32) -> WavefrontParams {
        WavefrontParams {
            threads: self.pass.lanes,
            iteration,
            is_first: u32::from(iteration == self.pass.iterations.start),
            regenerates: u32::from(self.pool.regenerates),
            first_slot: self.pass.slots.start,
            end_slot: self.pass.slots.end,
            queues: self.pool.queues,
            path: *self.stream.parameters,
            ..WavefrontParams::zeroed()
        }
    }

    fn trace(&self, iteration: u32) -> Launch<'a, B> {
        let pool = self.pool;
        kernels::trace_queue(
            &self.parameters(iteration),
            self.stream.scene,
            self.stream.slots.slice(self.part.clone()),
            pool.kept.view(),
            pool.offsets.view(),
            pool.rows.view(),
        )
    }

    fn shade(&self, iteration: u32) -> Launch<'a, B> {
        let pool = self.pool;
        kernels::shade_queue(
            &self.parameters(iteration),
            self.stream.scene,
            self.stream.slots.slice(self.part.clone()),
            pool.kept.view(),
            pool.goes_on.view(),
            pool.rows.view(),
            self.stream.contributions.slice(self.part.clone()),
        )
    }

    fn shadow(&self, iteration: u32) -> Launch<'a, B> {
        kernels::shadow_queue(
            &self.parameters(iteration),
            self.stream.scene,
            self.pool.rows.view(),
            self.stream.contributions.slice(self.part.clone()),
        )
    }

    fn compact(&self) -> [Launch<'a, B>; 3] {
        let Wavefront { goes_on, kept, offsets, .. } = self.pool;
        let per_block = BlockParams::per_block(self.pass.lanes);
        let one = BlockParams::one_workgroup(self.pass.lanes);
        [
            kernels::sum_blocks(&per_block, goes_on.view(), offsets.view()),
            kernels::scan_blocks(&one, offsets.view()),
            kernels::scatter_kept(&per_block, goes_on.view(), offsets.view(), kept.view()),
        ]
    }

    /// `end` is the number after that of the last iteration.
    fn finish(&self, end: u32) -> Launch<'a, B> {
        let pool = self.pool;
        kernels::finish_queue(
            &self.parameters(end),
            self.stream.scene,
            self.stream.slots.slice(self.part.clone()),
            pool.kept.view(),
            pool.offsets.view(),
            pool.rows.view(),
            self.stream.contributions.slice(self.part.clone()),
        )
    }
}

impl<E: Executor> Integrator<E> for Wavefront<E::Buffer> {
    fn trace<'a>(
        &'a self,
        stream: &StreamBuffers<'a, E::Buffer>,
        part: Range<u32>,
    ) -> Vec<Launch<'a, E::Buffer>> {
        let slots = part.start as usize..part.end as usize;
        let passes = self.passes(stream, &part);
        passes
            .iter()
            .flat_map(|pass| Launcher { pool: self, stream, part: slots.clone(), pass }.all())
            .collect()
    }

    fn active_paths(
        &self,
        executor: &E,
        stream: &StreamBuffers<'_, E::Buffer>,
        part: Range<u32>,
    ) -> Result<Vec<u32>, ExecError> {
        let iterations =
            self.passes(stream, &part).last().map_or(0, |pass| pass.iterations.end) as usize;
        let rows = self.rows.read_range(executor, 0..iterations)?;
        Ok(rows.into_iter().map(|row| Queue::from_row(row).active).collect())
    }
}
