//! From a slot to its contribution: one path tracer, walked in several orders, and a bidirectional
//! one.
//!
//! [`path`] is the tracer, [`nee`] its sampling of lights, [`params`] what all paths share.
//! [`megakernel`], [`regeneration`] and [`wavefront`] walk the same paths in different orders,
//! [`lvc`] traces bidirectionally. [`first_hits`] finds what the camera sees, for filters and
//! layers.

pub mod first_hits;
pub mod lvc;
pub mod megakernel;
pub mod nee;
pub mod params;
pub mod path;
pub mod regeneration;
pub mod wavefront;
