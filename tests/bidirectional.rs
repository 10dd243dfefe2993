//! The integrator `lvc`: its weights, its cache, and its pictures against the path tracer's.

mod common;

#[path = "bidirectional/agreement.rs"]
mod agreement;
#[path = "bidirectional/cache.rs"]
mod cache;
#[path = "bidirectional/renders.rs"]
mod renders;
#[path = "bidirectional/weights.rs"]
mod weights;
