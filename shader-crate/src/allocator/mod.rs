//! From errors to a stream: how many samples each pixel gets in a round.

pub mod atomic;
pub mod deficits;
pub mod error_scale;
pub mod paper;
pub mod runs;
