//! The integrator `lvc`: its weights, its cache, and its pictures against the path tracer's.

mod agreement;
mod cache;
mod renders;
mod weights;
