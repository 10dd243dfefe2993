//! The integrator `lvc`: bidirectional path tracing with a light vertex cache, see
//! [`raystream_shaders::integrator::lvc`].
//!
//! Every round begins with light paths, whose vertices fill the cache:
//!
//! ```text
//! trace_light_paths ──> counts, scratch
//! counts ──sum_blocks, scan_blocks──> offsets
//! counts, offsets, scratch ──gather_vertices──> cache
//! slots, cache ──trace_eye_paths──> contributions
//! ```
//!
//! A short pilot run before the first round finds how many vertices a light path has. From it
//! follow
//!
//! - the number of light paths `N`: as many as give the cache one vertex for each pixel, up to
//!   2^20. There are no more than vertices are wanted, since where most paths leave no vertex, more
//!   of them cost more than they bring; and as many as memory has room for, if all are as long as
//!   they may be;
//! - the number of connections `M`: as many as a light path has vertices, but at most 2. As many as
//!   that would give connections the weight that they have where each eye path is connected to a
//!   light path of its own; but a connection costs a ray, and where next-event estimation does well
//!   most of these rays are wasted;
//! - the number of samples by which connections are weighed. It must be the same for all paths of
//!   the render, so it is that of the pilot run and not of the round's own cache: an estimate does
//!   well, since any number gives weights that sum to 1.
//!
//! The samples of a round share its cache. Their errors are not quite independent of each other,
//! and the picture depends on how it is cut into rounds; so rounds are no longer than four slots
//! for each light path or vertex, whichever are more, and their length follows from the pilot run,
//! not from time. The rays of light paths are not in the film's count of rays, since they belong to
//! no pixel. Without lights, or where paths are too short to be connected, there is no cache and
//! what is left is the path tracer.

use super::{Integrator, IntegratorContext, StreamBuffers};
use crate::exec::{Array, ExecError, Executor, Launch, SceneBuffers, halve_until_it_fits, kernels};
use crate::render::integrator::lvc_settings::LightCacheSettings;
use bytemuck::Zeroable;
use glam::UVec4;
use raystream_shaders::integrator::lvc::LvcParams;
use raystream_shaders::integrator::lvc::cache::{GatherParams, HEADER_ROWS};
use raystream_shaders::integrator::lvc::light_vertex::ROWS_PER_VERTEX;
use raystream_shaders::integrator::params::PathParams;
use raystream_shaders::parallel::prefix::BlockParams;
use std::ops::Range;

/// Vertices that the cache holds on average, at most, unless it is said how many light paths to
/// trace.
const MAX_VERTICES: f64 = (1 << 20) as f64;
/// Connections by the pilot run, at most.
const MAX_PILOT_CONNECTIONS: f64 = 2.0;
/// Slots in a round for each light path or vertex, at most.
const REUSE: f64 = 4.0;
/// Light paths of the pilot run.
const PILOT_PATHS: u32 = 4096;
/// The pilot run is the round of this number, which no render reaches.
const PILOT_ROUND: u32 = u32::MAX;
/// Bytes that the vertices of all light paths may take, unless it is said how many light paths to
/// trace. The cache has as much.
const SCRATCH_BYTES: u64 = 256 << 20;
/// Bytes of a vertex.
const VERTEX_BYTES: u64 = ROWS_PER_VERTEX as u64 * size_of::<UVec4>() as u64;
/// The same where it is said. Far more than is of use, and few enough that 32 bits count their
/// rows.
const MAX_SCRATCH_BYTES: u64 = 4 << 30;
/// What buffers of vertices are called in errors.
pub const LABEL: &str = "light vertices (fewer or shorter light paths leave fewer)";

/// See the [module](self).
pub struct Lvc<B> {
    parameters: LvcParams,
    /// Light paths of each round; 0 where there is no cache.
    light_paths: u32,
    /// Vertices that a round's cache has on average.
    vertices: f64,
    /// Vertices of each light path.
    counts: Array<B, u32>,
    /// Their sums over blocks, then over the blocks before each.
    offsets: Array<B, u32>,
    /// The vertices of each light path, at places of its own.
    scratch: Array<B, UVec4>,
    cache: Array<B, UVec4>,
}

impl<B> Lvc<B> {
    /// Makes the pilot run and finds room for the cache.
    pub fn new<E: Executor<Buffer = B>>(
        context: &IntegratorContext<'_, E>,
    ) -> Result<Self, ExecError> {
        let settings = &context.settings.light_cache;
        let path = *context.parameters;
        let light_segments = path.max_depth.saturating_sub(2);
        if path.scene.lights == 0 || light_segments == 0 || settings.techniques.samples()[2] == 0.0
        {
            return Self::with_room(context.executor, path_tracing(path, settings), 0);
        }
        let vertices_per_path = pilot(context, light_segments)?;
        let automatic = automatic_light_paths(context, vertices_per_path, light_segments);
        let light_paths = settings.light_paths.unwrap_or(automatic);
        let connections = settings
            .connections
            .unwrap_or_else(|| vertices_per_path.round().clamp(1.0, MAX_PILOT_CONNECTIONS) as u32);
        // A number that was asked for is not made smaller.
        let smallest = settings.light_paths.unwrap_or(1);
        halve_until_it_fits(light_paths, smallest, |light_paths| {
            let parameters = LvcParams {
                light_segments,
                vertices_per_path: light_segments,
                connections,
                connection_samples: settings.techniques.samples()[2]
                    * (f64::from(connections) / vertices_per_path) as f32,
                connection_scale: (1.0 / (f64::from(light_paths) * f64::from(connections))) as f32,
                ..path_tracing(path, settings)
            };
            let lvc = Self::with_room(context.executor, parameters, light_paths)?;
            tracing::debug!(
                "light paths: {light_paths} of {vertices_per_path:.3} vertices, {connections} \
                 connections"
            );
            Ok(Self { vertices: vertices_per_path * f64::from(light_paths), ..lvc })
        })
    }

    fn with_room<E: Executor<Buffer = B>>(
        executor: &E,
        parameters: LvcParams,
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
            light_paths,
            vertices: 0.0,
            counts: Array::zeroed(executor, "counts of light vertices", light_paths as usize)?,
            offsets: Array::zeroed(executor, "offsets of light vertices", blocks + 1)?,
            scratch: Array::zeroed(executor, LABEL, rows)?,
            cache: Array::zeroed(executor, LABEL, HEADER_ROWS as usize + rows)?,
        })
    }
}

/// What is left without a cache.
fn path_tracing(path: PathParams, settings: &LightCacheSettings) -> LvcParams {
    let [emission_samples, light_samples, _] = settings.techniques.samples();
    LvcParams { emission_samples, light_samples, path, ..LvcParams::zeroed() }
}

/// The number of vertices of a light path, on average over a few; above 0.
fn pilot<E: Executor>(
    context: &IntegratorContext<'_, E>,
    light_segments: u32,
) -> Result<f64, ExecError> {
    let executor = context.executor;
    let counts = Array::zeroed(executor, "counts of light vertices", PILOT_PATHS as usize)?;
    let nowhere = Array::zeroed(executor, "light vertices", 1)?;
    let parameters = LvcParams {
        threads: PILOT_PATHS,
        round: PILOT_ROUND,
        light_segments,
        ..path_tracing(*context.parameters, &context.settings.light_cache)
    };
    executor.run(&[trace_light_paths(context.scene, &parameters, &counts, &nowhere)])?;
    let vertices: u64 = counts.read(executor)?.into_iter().map(u64::from).sum();
    // Where none was found there may be some all the same: a weight of infinity would spoil these.
    Ok(vertices.max(1) as f64 / f64::from(PILOT_PATHS))
}

fn automatic_light_paths<E: Executor>(
    context: &IntegratorContext<'_, E>,
    vertices_per_path: f64,
    light_segments: u32,
) -> u32 {
    let size = context.settings.size;
    let wanted = (f64::from(size.width) * f64::from(size.height)).min(MAX_VERTICES);
    let paths = (wanted / vertices_per_path.max(1.0)).ceil();
    let room = SCRATCH_BYTES.min(context.executor.limits().buffer_bytes - VERTEX_BYTES);
    let fitting = room / (u64::from(light_segments) * VERTEX_BYTES);
    (paths as u64).min(fitting).max(1) as u32
}

fn trace_light_paths<'a, B>(
    scene: &'a SceneBuffers<B>,
    parameters: &LvcParams,
    counts: &'a Array<B, u32>,
    scratch: &'a Array<B, UVec4>,
) -> Launch<'a, B> {
    kernels::trace_light_paths(parameters, scene, counts.view(), scratch.view())
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
        let mut launches =
            vec![trace_light_paths(stream.scene, &parameters, &self.counts, &self.scratch)];
        let room = self.parameters.vertices_per_path;
        launches.extend(gather(
            self.light_paths,
            room,
            &self.counts,
            &self.offsets,
            &self.scratch,
            &self.cache,
        ));
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

    fn slots_of_round(&self) -> u64 {
        let many = self.vertices.max(f64::from(self.light_paths));
        if self.light_paths == 0 { u64::MAX } else { (REUSE * many) as u64 }
    }
}
