//! The integrator `lvc`: its weights, its cache, and its pictures against the path tracer's.

mod agreement;
mod cache;
mod light_tracing;
pub mod renders;
mod weights;
