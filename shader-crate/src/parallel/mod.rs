//! Primitives whose lanes cooperate: prefix sums and stream compaction.

pub mod compaction;
pub mod prefix;
