//! From a slot to its contribution: one path tracer, walked in several orders, and a bidirectional
//! one.
//!
//! [`path`] is the tracer. [`regeneration`] and [`wavefront`] walk the same paths in other orders,
//! [`lvc`] traces bidirectionally. [`first_hits`] finds what the camera sees, for filters and
//! layers.

pub mod first_hits;
pub mod lvc;
pub mod path;
pub mod regeneration;
pub mod wavefront;
