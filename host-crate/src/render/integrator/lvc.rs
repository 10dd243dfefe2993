//! The integrator `lvc`: bidirectional path tracing with a light vertex cache, see
//! [`raystream_shaders::integrator::lvc`].
//!
//! Every round begins with light paths, whose vertices fill the cache:
//!
//! ```text
//! trace_light_paths ──> counts, scratch
//! counts ──sum_blocks, scan_blocks──> offsets
//! counts, offsets, scratch ──gather_vertices──> cache
//! cache ──connect_to_camera──> splats ──add_splats──> splat film
//! slots, cache ──trace_eye_paths──> contributions
//! ```
//!
//! The list of splats takes the place of the scratch memory, which is not needed any more by then.
//!
//! How many light paths there are, and how many connections, `lvc_numbers.rs` says.
//!
//! The samples of a round share its cache. Their errors are not quite independent of each other,
//! and the picture depends on how it is cut into rounds; so rounds are no longer than a slot for
//! each light path or vertex, whichever are more (four without light tracing), and their length
//! follows from the pilot run, not from time. The rays of light paths are not in the film's count
//! of rays, since they belong to no pixel; nor are those to the camera. Without lights, or where
//! paths are too short to be connected, there is no cache and what is left is the path tracer.

use super::lvc_numbers::{
    VERTEX_BYTES, automatic_light_paths, parameters, path_tracing, pilot, slots_that_share,
};
use super::{Integrator, IntegratorContext, StreamBuffers};
use crate::exec::{Array, ExecError, Executor, Launch, halve_until_it_fits, kernels};
use crate::render::film::splats::{SplatFilm, SplatSums};
use crate::render::settings::light_cache::TechniqueShares;
use bytemuck::Zeroable;
use glam::UVec4;
use raystream_shaders::integrator::lvc::LvcParams;
use raystream_shaders::integrator::lvc::cache::{GatherParams, HEADER_ROWS};
use raystream_shaders::math::fixed::unit_exponent;
use raystream_shaders::parallel::prefix::BlockParams;
use std::ops::Range;

/// Bytes that the vertices of all light paths may take where it is said how many paths there are.
/// Far more than is of use, and few enough that 32 bits count their rows.
const MAX_SCRATCH_BYTES: u64 = 4 << 30;
/// What buffers of vertices are called in errors.
pub const LABEL: &str = "light vertices (fewer or shorter light paths leave fewer)";

/// See the [module](self).
pub struct Lvc<B> {
    parameters: LvcParams,
    shares: TechniqueShares,
    /// Light paths of each round; 0 where there is no cache.
    light_paths: u32,
    /// Vertices that a round's cache has on average.
    vertices: f64,
    /// Vertices of each light path.
    counts: Array<B, u32>,
    /// Their sums over blocks, then over the blocks before each.
    offsets: Array<B, u32>,
    /// The vertices of each light path, at places of its own.
    /// Afterwards the list of splats.
    scratch: Array<B, UVec4>,
    cache: Array<B, UVec4>,
    /// None without light tracing.
    splats: Option<SplatFilm<B>>,
}

impl<B> Lvc<B> {
    /// Makes the pilot run and finds room for the cache and for what light tracing finds.
    pub fn new<E: Executor<Buffer = B>>(
        context: &IntegratorContext<'_, E>,
    ) -> Result<Self, ExecError> {
        let settings = &context.settings.light_cache;
        let shares = settings.techniques.shares();
        let path = *context.parameters;
        let beyond = if shares.camera > 0.0 { 1 } else { 2 };
        let light_segments = path.max_depth.saturating_sub(beyond);
        let has_use = shares.camera > 0.0 || shares.connection > 0.0;
        if path.scene.lights == 0 || light_segments == 0 || !has_use {
            return Self::with_room(context.executor, path_tracing(path, settings), shares, 0);
        }
        let vertices_per_path = pilot(context, light_segments)?;
        let automatic = automatic_light_paths(context, vertices_per_path, light_segments);
        // A number that was asked for is not made smaller.
        let (light_paths, smallest) = settings.light_paths.map_or((automatic, 1), |n| (n, n));
        halve_until_it_fits(light_paths, smallest, |light_paths| {
            let parameters = parameters(context, light_segments, vertices_per_path, light_paths);
            let lvc = Self::with_room(context.executor, parameters, shares, light_paths)?;
            let connections = parameters.connections;
            tracing::debug!(
                "light paths: {light_paths} of {vertices_per_path:.3} vertices, {connections} \
                 connections"
            );
            let splats = (shares.camera > 0.0).then(|| {
                let unit_exponent = unit_exponent(path.scene.brightest);
                let size = context.settings.size;
                SplatFilm::new(context.executor, size, light_paths, unit_exponent)
            });
            let vertices = vertices_per_path * f64::from(light_paths);
            Ok(Self { vertices, splats: splats.transpose()?, ..lvc })
        })
    }

    fn with_room<E: Executor<Buffer = B>>(
        executor: &E,
        parameters: LvcParams,
        shares: TechniqueShares,
        light_paths: u32,
    ) -> Result<Self, ExecError> {
        let bytes = u64::from(light_paths) * u64::from(parameters.vertices_per_path) * VERTEX_BYTES;
        executor.check_size(LABEL, bytes)?;
        if bytes > MAX_SCRATCH_BYTES {
            let device = executor.name().to_owned();
            return Err(ExecError::TooLarge {
                device,
                label: LABEL,
                bytes,
                limit: MAX_SCRATCH_BYTES,
            });
        }
        let rows = bytes as usize / size_of::<UVec4>();
        let blocks = BlockParams::per_block(light_paths).blocks as usize;
        Ok(Self {
            parameters,
            shares,
            light_paths,
            vertices: 0.0,
            counts: Array::zeroed(executor, "counts of light vertices", light_paths as usize)?,
            offsets: Array::zeroed(executor, "offsets of light vertices", blocks + 1)?,
            scratch: Array::zeroed(executor, LABEL, rows)?,
            cache: Array::zeroed(executor, LABEL, HEADER_ROWS as usize + rows)?,
            splats: None,
        })
    }
}

/// Launches that put the vertices of `paths` light paths, of which each has room for
/// `vertices_per_path` in `scratch` and has as many as `counts` says, close together in `cache`,
/// see [`raystream_shaders::integrator::lvc::cache`]. `offsets` has an element more than there are
/// blocks.
pub fn gather<'a, B>(
    paths: u32,
    vertices_per_path: u32,
    counts: &'a Array<B, u32>,
    offsets: &'a Array<B, u32>,
    scratch: &'a Array<B, UVec4>,
    cache: &'a Array<B, UVec4>,
) -> Vec<Launch<'a, B>> {
    let per_block = BlockParams::per_block(paths);
    let gather = GatherParams {
        threads: per_block.threads,
        paths,
        blocks: per_block.blocks,
        vertices_per_path,
        ..GatherParams::zeroed()
    };
    vec![
        kernels::sum_blocks(&per_block, counts.view(), offsets.view()),
        kernels::scan_blocks(&BlockParams::one_workgroup(paths), offsets.view()),
        kernels::gather_vertices(
            &gather,
            counts.view(),
            offsets.view(),
            scratch.view(),
            cache.view(),
        ),
    ]
}

impl<E: Executor> Integrator<E> for Lvc<E::Buffer> {
    fn begin_round<'a>(
        &'a self,
        stream: &StreamBuffers<'a, E::Buffer>,
        round: u32,
    ) -> Vec<Launch<'a, E::Buffer>> {
        if self.light_paths == 0 {
            return Vec::new();
        }
        let parameters = LvcParams { threads: self.light_paths, round, ..self.parameters };
        let mut launches = vec![kernels::trace_light_paths(
            &parameters,
            stream.scene,
            self.counts.view(),
            self.scratch.view(),
        )];
        let room = self.parameters.vertices_per_path;
        launches.extend(gather(
            self.light_paths,
            room,
            &self.counts,
            &self.offsets,
            &self.scratch,
            &self.cache,
        ));
        if let Some(film) = &self.splats {
            let splats = self.scratch.view();
            launches.extend([
                kernels::connect_to_camera(&parameters, stream.scene, self.cache.view(), splats),
                film.add(self.light_paths, self.scratch.view()),
            ]);
        }
        launches
    }

    fn trace<'a>(
        &'a self,
        stream: &StreamBuffers<'a, E::Buffer>,
        part: Range<u32>,
    ) -> Vec<Launch<'a, E::Buffer>> {
        let slots = part.start as usize..part.end as usize;
        vec![kernels::trace_eye_paths(
            &LvcParams { threads: part.end - part.start, ..self.parameters },
            stream.scene,
            stream.slots.slice(slots.clone()),
            self.cache.view(),
            stream.contributions.slice(slots),
        )]
    }

    fn restore(&self, executor: &E, splats: &SplatSums) -> Result<(), ExecError> {
        self.splats.as_ref().map_or(Ok(()), |film| film.write(executor, splats))
    }

    fn slots_of_round(&self) -> u64 {
        if self.light_paths == 0 {
            u64::MAX
        } else {
            slots_that_share(self.shares, self.vertices, self.light_paths) as u64
        }
    }

    fn splats(&self, executor: &E) -> Result<Option<SplatSums>, ExecError> {
        self.splats.as_ref().map(|splats| splats.read(executor)).transpose()
    }
}
