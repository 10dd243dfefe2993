//! How long paths may be.

/// How long paths may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PathLimits {
    /// Longest path in segments, at least 1: 1 sees only what emits, 2 direct light as well.
    pub max_depth: u32,
    /// Segment after which Russian roulette may end a path, at least 1.
    pub roulette_depth: u32,
}

impl Default for PathLimits {
    /// Paths of up to 8 segments, with roulette after the fifth.
    fn default() -> Self {
        Self { max_depth: 8, roulette_depth: 5 }
    }
}
