//! How long paths may be.

/// How long paths may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PathLimits {
    /// Longest path in segments, at least 1: 1 sees only what emits, 2 direct light as well.
    pub max_depth: u32,
    /// Segment after which Russian roulette may end any path, at least 1. Dim paths, with less
    /// than a quarter of their throughput left, it may end before; above `max_depth`, none.
    pub roulette_depth: u32,
}

impl Default for PathLimits {
    /// Paths of up to 8 segments, with roulette for all after the fifth.
    fn default() -> Self {
        Self { max_depth: 8, roulette_depth: 5 }
    }
}
