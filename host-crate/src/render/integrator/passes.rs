//! How many iterations a pool of paths is taken through, without knowing how long paths are.

use std::ops::Range;

/// Iterations that are made at most for the paths that start last. Few are as long, so the rest is
/// left to one launch that walks each to its end.
const LONGEST_TAIL: u32 = 24;
/// Iterations that are made at most, on average, to replace all paths of the pool once by new ones.
const REPLACEMENT: u32 = 8;

/// Iterations over a pool that take a range of slots from their first to their last segments.
///
/// Where paths are regenerated, the pool is full as long as there are slots. Of `D` iterations each
/// path sees its end, so within every `D` all of the pool are replaced, and with `ceil(slots /
/// pool)` pools full of slots `D * ceil(slots / pool)` iterations are always enough. For long paths
/// these would be thousands of launches for a few that are as long. Then there are fewer, and one
/// launch more that finishes what is left.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Pass {
    /// Slots whose paths are walked.
    pub slots: Range<u32>,
    /// Lanes of every launch.
    pub lanes: u32,
    /// Numbers of the iterations.
    pub iterations: Range<u32>,
    /// Whether a launch must finish what is left.
    pub leaves_paths: bool,
}

impl Pass {
    /// The passes over `slots` slots of paths of at most `max_depth` segments.
    pub fn all(slots: u32, capacity: u32, regenerates: bool, max_depth: u32) -> Vec<Self> {
        let longest = if regenerates { slots } else { capacity };
        let mut passes: Vec<Self> = Vec::new();
        let mut start = 0;
        while start < slots {
            let end = slots.min(start.saturating_add(longest));
            let lanes = (end - start).min(capacity);
            let replacements = (end - start).div_ceil(lanes) - 1;
            let enough = max_depth.saturating_mul(1 + replacements);
            let made =
                enough.min(max_depth.min(LONGEST_TAIL) + replacements * max_depth.min(REPLACEMENT));
            let first = passes.last().map_or(0, |pass| pass.iterations.end);
            let iterations = first..first + made;
            passes.push(Self { slots: start..end, lanes, iterations, leaves_paths: made < enough });
            start = end;
        }
        passes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn compaction_takes_pool_after_pool_and_streaming_all_at_once() {
        let pass =
            |slots, lanes, iterations| Pass { slots, lanes, iterations, leaves_paths: false };
        assert_eq!(Pass::all(64, 64, false, 3), [pass(0..64, 64, 0..3)]);
        assert_eq!(Pass::all(100, 64, false, 8), [pass(0..64, 64, 0..8), pass(64..100, 36, 8..16)]);
        assert_eq!(Pass::all(100, 64, true, 8), [pass(0..100, 64, 0..16)]);
        assert_eq!(Pass::all(10, 64, true, 8), [pass(0..10, 10, 0..8)]);
        assert_eq!(Pass::all(10, 64, true, 1), [pass(0..10, 10, 0..1)]);
    }

    #[test]
    fn few_iterations_for_long_paths() {
        for (regenerates, iterations) in [(false, 4 * 24), (true, 24 + 3 * 8)] {
            for max_depth in [1000, u32::MAX] {
                let passes = Pass::all(256, 64, regenerates, max_depth);
                assert_eq!(passes.last().unwrap().iterations.end, iterations);
                assert!(passes.iter().all(|pass| pass.leaves_paths));
            }
        }
    }
}
