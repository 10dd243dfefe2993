//! From a scene and a device to a film.
//!
//! [`prepare`] turns a scene into the buffers that the kernels read; [`Renderer`] owns them, the
//! film and the sample stream, and renders round by round; [`run`](run::run) is the loop with its
//! stops (samples, time, interruption).

pub mod allocator;
mod batch;
mod bvh;
mod camera;
mod counter;
pub mod estimation;
mod estimation_settings;
mod features;
pub mod film;
pub mod integrator;
mod light_cache_settings;
mod lights;
pub mod prepare;
mod renderer;
mod round;
pub mod run;
mod sampling;
mod settings;
mod triangles;

pub use bvh::BvhQuality;
pub use estimation_settings::{EstimationSettings, FilterSettings};
pub use film::FilmBuffers;
pub use light_cache_settings::{BidirectionalTechniques, LightCacheSettings};
pub use prepare::PreparedScene;
pub use renderer::Renderer;
pub use run::{Budget, Outcome, Progress, RenderError, run};
pub use sampling::{AllocatorKind, Estimator, Sampling};
pub use settings::{IntegratorKind, Settings, Techniques, Timings};
