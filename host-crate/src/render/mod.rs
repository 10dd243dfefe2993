//! From a scene and a device to a film.
//!
//! [`scene`] turns a scene into the buffers that the kernels read; [`Renderer`] owns them, the film
//! and the sample stream, and renders round by round; [`run`](run::run) is the loop with its stops
//! (samples, time, interruption).

pub mod allocator;
mod checkpoint;
mod denoised;
mod error;
pub mod estimator;
pub mod film;
pub mod integrator;
pub mod reconstruction;
mod relay;
mod renderer;
pub mod round;
pub mod run;
pub mod scene;
pub mod settings;
mod steps;
mod team;
mod timings;

pub use checkpoint::{Checkpoint, RenderProgress};
pub use error::RenderError;
pub use film::FilmBuffers;
pub use relay::{Kept, Leg, Relay};
pub use renderer::Renderer;
pub use round::{Batch, Round};
pub use run::{Budget, Outcome, Progress, Stop, Watch, run, run_watched};
pub use scene::bvh::BvhQuality;
pub use scene::{LightChoice, PreparedScene};
pub use settings::estimation::{EstimationSettings, Estimator, FilterSettings};
pub use settings::light_cache::{BidirectionalTechniques, LightCacheSettings};
pub use settings::pixel_filter::{PixelFilter, PixelFilterShape};
pub use settings::reconstruction::FilterKind;
pub use settings::sampling::{AllocatorKind, Sampling, Split};
pub use settings::{IntegratorKind, Settings, Techniques};
pub use steps::Run;
pub use team::{FilmTransfer, Link, LocalWorker, Peer, RemoteWorker, Way, Worker, serve};
pub use timings::{Part, Timings};
