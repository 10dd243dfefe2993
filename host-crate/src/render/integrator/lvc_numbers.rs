//! How many light paths and connections `lvc` has.
//!
//! A short pilot run before the first round finds how many vertices a light path has. From it
//! follow
//!
//! - the number of light paths `N`: as many as give the cache four vertices for each pixel (one
//!   without light tracing), up to 2^20 vertices. There are no more than vertices are wanted, since
//!   where most paths leave no vertex, more of them cost more than they bring; and as many as
//!   memory has room for, if all are as long as they may be;
//! - the number of connections `M`: as many as a light path has vertices, but at most 2. As many as
//!   that would give connections the weight that they have where each eye path is connected to a
//!   light path of its own; but a connection costs a ray, and where next-event estimation does well
//!   most of these rays are wasted;
//! - the number of samples by which connections are weighed. It must be the same for all paths of
//!   the render, so it is that of the pilot run and not of the round's own cache: an estimate does
//!   well, since any number gives weights that sum to 1. Likewise that of light tracing: light
//!   paths for each sample of a pixel in a round of full length.

use super::IntegratorContext;
use crate::exec::{Array, ExecError, Executor, kernels};
use crate::render::settings::light_cache::{LightCacheSettings, TechniqueShares};
use bytemuck::Zeroable;
use glam::UVec4;
use raystream_shaders::integrator::lvc::LvcParams;
use raystream_shaders::integrator::lvc::light_vertex::ROWS_PER_VERTEX;
use raystream_shaders::integrator::params::PathParams;

/// Bytes of a vertex.
pub const VERTEX_BYTES: u64 = ROWS_PER_VERTEX as u64 * size_of::<UVec4>() as u64;
/// Vertices that the cache holds on average, at most, unless it is said how many light paths to
/// trace.
const MAX_VERTICES: f64 = (1 << 20) as f64;
/// Connections by the pilot run, at most.
const MAX_PILOT_CONNECTIONS: f64 = 2.0;
/// Slots in a round for each light path or vertex, at most, where these only serve connections.
const REUSE: f64 = 4.0;
/// The same with light tracing. Its noise falls with the number of light paths alone, and where it
/// is needed no other technique helps; so there are more of them, in rounds that are as long.
const REUSE_BY_LIGHT_TRACING: f64 = 1.0;
/// Light paths of the pilot run.
const PILOT_PATHS: u32 = 4096;
/// The pilot run is the round of this number, which no render reaches.
const PILOT_ROUND: u32 = u32::MAX;
/// Bytes that the vertices of all light paths may take, unless it is said how many light paths to
/// trace. The cache has as much.
const SCRATCH_BYTES: u64 = 256 << 20;

/// What is left without a cache.
pub fn path_tracing(path: PathParams, settings: &LightCacheSettings) -> LvcParams {
    let shares = settings.techniques.shares();
    LvcParams {
        emission_samples: shares.emission,
        light_samples: shares.light,
        path,
        ..LvcParams::zeroed()
    }
}

/// The parameters of a render by `light_paths` a round, each of so many vertices on average.
pub fn parameters<E: Executor>(
    context: &IntegratorContext<'_, E>,
    light_segments: u32,
    vertices_per_path: f64,
    light_paths: u32,
) -> LvcParams {
    let settings = &context.settings.light_cache;
    let shares = settings.techniques.shares();
    let connections = match settings.connections {
        _ if shares.connection == 0.0 => 0,
        Some(connections) => connections,
        None => vertices_per_path.round().clamp(1.0, MAX_PILOT_CONNECTIONS) as u32,
    };
    let paths = f64::from(light_paths);
    let size = context.settings.size;
    let pixels = f64::from(size.width) * f64::from(size.height);
    // Rounds have at least one sample of each pixel.
    let vertices = vertices_per_path * paths;
    let samples = (slots_that_share(shares, vertices, light_paths) / pixels).max(1.0);
    LvcParams {
        light_segments,
        vertices_per_path: light_segments,
        connections,
        connection_samples: shares.connection * (f64::from(connections) / vertices_per_path) as f32,
        connection_scale: (1.0 / (paths * f64::from(connections.max(1)))) as f32,
        camera_samples: shares.camera * (paths / samples) as f32,
        ..path_tracing(*context.parameters, settings)
    }
}

/// Slots in a round for each light path or vertex, at most.
fn reuse(shares: TechniqueShares) -> f64 {
    if shares.camera > 0.0 { REUSE_BY_LIGHT_TRACING } else { REUSE }
}

/// Slots that should share light paths with this many vertices, at most.
pub fn slots_that_share(shares: TechniqueShares, vertices: f64, light_paths: u32) -> f64 {
    reuse(shares) * vertices.max(f64::from(light_paths))
}

/// The number of vertices of a light path, on average over a few; above 0.
pub fn pilot<E: Executor>(
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
    executor.run(&[kernels::trace_light_paths(
        &parameters,
        context.scene,
        counts.view(),
        nowhere.view(),
    )])?;
    let vertices: u64 = counts.read(executor)?.into_iter().map(u64::from).sum();
    // Where none was found there may be some all the same: a weight of infinity would spoil these.
    Ok(vertices.max(1) as f64 / f64::from(PILOT_PATHS))
}

/// The light paths of a round, unless it is said how many.
pub fn automatic_light_paths<E: Executor>(
    context: &IntegratorContext<'_, E>,
    vertices_per_path: f64,
    light_segments: u32,
) -> u32 {
    let size = context.settings.size;
    let shares = context.settings.light_cache.techniques.shares();
    let pixels = f64::from(size.width) * f64::from(size.height);
    let wanted = (pixels * REUSE / reuse(shares)).min(MAX_VERTICES);
    let paths = (wanted / vertices_per_path.max(1.0)).ceil();
    let room = SCRATCH_BYTES.min(context.executor.limits().buffer_bytes - VERTEX_BYTES);
    let fitting = room / (u64::from(light_segments) * VERTEX_BYTES);
    (paths as u64).min(fitting).max(1) as u32
}
