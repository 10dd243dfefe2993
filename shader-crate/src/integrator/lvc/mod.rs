//! Bidirectional path tracing with a light vertex cache.
//!
//! Davidovič, Křivánek, Hašan, Slusallek, "Progressive Light Transport Simulation on the GPU:
//! Survey and Improvements", ACM TOG 33(3), 2014, call it LVC-BPT. Once a round [`light_path`]
//! traces `N` paths from the lights; where they meet diffuse surfaces they leave a
//! [`light_vertex`], and all of a round's lie close together in one [`cache`]. An [`eye_path`] is
//! that of the path tracer, and at every diffuse vertex it also connects to `M` vertices drawn from
//! the cache. A path of light with `s` vertices from a light's side and the others from the
//! camera's can then be found by
//!
//! | s | technique |
//! |---|---|
//! | 0 | the eye path runs into the light |
//! | 1 | next-event estimation |
//! | 2 and more | connection to a vertex of the cache |
//! | all but the camera's | [`light_tracing`]: each vertex of the cache connects to the camera |
//!
//! and [`mis`] weighs them. Light tracing alone finds caustics that the camera sees directly. It
//! writes to other pixels than a slot's own, so it has a film of its own
//! ([`splats`](crate::film::splats)), which is added to the picture.

pub mod cache;
pub mod eye_path;
pub mod light_path;
pub mod light_tracing;
pub mod light_vertex;
pub mod mis;

use crate::integrator::params::PathParams;
use crate::memory::device_struct;
use crate::scene::{SceneParams, TracingParams};
use mis::TechniqueSamples;

device_struct! {
    /// What is the same for all paths of a round. 208 bytes.
    pub struct LvcParams {
        /// Light paths to trace, or lanes that share the cache's vertices, or slots.
        pub threads: u32,
        /// Number of the round: the light paths of different rounds are independent.
        pub round: u32,
        /// Longest light path in segments: with one to the camera it has
        /// [`PathParams::max_depth`], or with a connection and a segment from the camera where
        /// there is no light tracing.
        pub light_segments: u32,
        /// Vertices that the scratch memory has for each light path: `light_segments`, or 0 to
        /// count vertices only.
        pub vertices_per_path: u32,
        /// Connections of each vertex of an eye path to vertices of the cache, at most
        /// [`MAX_CONNECTIONS`]; 0 where there is no cache.
        pub connections: u32,
        /// [`TechniqueSamples::emission`]
        pub emission_samples: f32,
        /// [`TechniqueSamples::light`]
        pub light_samples: f32,
        /// [`TechniqueSamples::connection`]
        pub connection_samples: f32,
        /// What a connection's contribution is multiplied by, beside the number of vertices in the
        /// cache: `1 / (N M)`.
        pub connection_scale: f32,
        /// [`TechniqueSamples::camera`]
        pub camera_samples: f32,
        /// Unused; zero.
        pub pad0: u32,
        /// Unused; zero.
        pub pad1: u32,
        /// The render; its `threads` do not count.
        pub path: PathParams,
    }
}

/// Connections that a vertex of an eye path may have, at most.
pub const MAX_CONNECTIONS: u32 = 64;

impl TracingParams for LvcParams {
    fn scene(&self) -> SceneParams {
        self.path.scene
    }
}

impl LvcParams {
    /// How many samples each technique has.
    pub fn samples(&self) -> TechniqueSamples {
        TechniqueSamples {
            emission: self.emission_samples,
            light: self.light_samples,
            connection: self.connection_samples,
            camera: self.camera_samples,
        }
    }
}
