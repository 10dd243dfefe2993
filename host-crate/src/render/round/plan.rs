//! Which round comes next: decided without a device.

use crate::render::allocator::sampling::{AllocatorKind, Sampling};

/// What bounds a round.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Pixels of the film.
    pub pixels: u32,
    /// Slots of the longest stream.
    pub slots: u32,
    /// Samples of each pixel that may share what the integrator makes for a round, at least 1;
    /// none where all samples are independent of each other.
    pub samples_that_share: Option<u32>,
    /// Slots of a batch, by the speed of the device.
    pub batch: u32,
}

/// What a render has done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Done {
    /// Paths traced.
    pub paths: u64,
    /// Rounds begun.
    pub rounds: u32,
}

/// A round to be run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RoundPlan {
    /// How samples are spent.
    pub kind: RoundKind,
    /// Number of the round, from 0 on.
    pub number: u32,
}

/// How a round spends its samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RoundKind {
    /// The same number for every pixel.
    Uniform {
        /// That number.
        samples: u32,
    },
    /// As the allocator makes of the errors.
    Adaptive {
        /// Paths to trace, at least 1.
        paths: u64,
    },
}

/// The next round, of at most `paths_left` paths (but always one sample of each pixel first):
/// uniform ones until every pixel has [`Sampling::initial_samples`], then what the allocator makes
/// of the errors.
pub fn plan(sampling: &Sampling, limits: &Limits, done: Done, paths_left: u64) -> RoundPlan {
    let pixels = u64::from(limits.pixels);
    let most = limits.samples_that_share.unwrap_or(u32::MAX);
    let samples_left = ((paths_left / pixels).clamp(1, u64::from(u32::MAX)) as u32).min(most);
    let samples = (done.paths / pixels) as u32;
    let kind = if sampling.allocator == AllocatorKind::Uniform {
        // Where the length of rounds shows in the film, it must not follow from time.
        let one_batch = (u64::from(limits.batch) / pixels).max(1) as u32;
        let longest = if limits.samples_that_share.is_some() { u32::MAX } else { one_batch };
        RoundKind::Uniform { samples: samples_left.min(longest) }
    } else if samples < sampling.initial_samples {
        RoundKind::Uniform { samples: (sampling.initial_samples - samples).min(samples_left) }
    } else {
        let paths = samples_of_round(sampling, limits, done) * f64::from(limits.pixels);
        RoundKind::Adaptive { paths: (paths as u64).clamp(1, paths_left) }
    };
    RoundPlan { kind, number: done.rounds }
}

/// Samples of the coming adaptive round, on average over the pixels.
pub fn samples_of_round(sampling: &Sampling, limits: &Limits, done: Done) -> f64 {
    let pixels = f64::from(limits.pixels);
    let most = limits.samples_that_share.unwrap_or(u32::MAX);
    let largest = (f64::from(limits.slots) / pixels).min(f64::from(most));
    sampling.samples_of_round(done.paths as f64 / pixels).min(largest)
}

#[cfg(test)]
mod tests {
    use super::RoundKind::{Adaptive, Uniform};
    use super::*;

    const LIMITS: Limits =
        Limits { pixels: 100, slots: 10_000, samples_that_share: None, batch: 1000 };
    const ADAPTIVE: Sampling = Sampling { allocator: AllocatorKind::Runs, ..Sampling::UNIFORM };
    const ENDLESS: u64 = u64::MAX;

    fn kind(sampling: Sampling, limits: Limits, paths: u64, paths_left: u64) -> RoundKind {
        plan(&sampling, &limits, Done { paths, rounds: 0 }, paths_left).kind
    }

    #[test]
    fn uniform_rounds_are_a_batch_long_and_end_with_the_budget() {
        let uniform = |limits, left| kind(Sampling::UNIFORM, limits, 0, left);
        assert_eq!(uniform(LIMITS, ENDLESS), Uniform { samples: 10 });
        assert_eq!(uniform(LIMITS, 700), Uniform { samples: 7 });
        assert_eq!(uniform(LIMITS, 1), Uniform { samples: 1 }, "always a sample of each pixel");
        assert_eq!(uniform(Limits { batch: 1, ..LIMITS }, ENDLESS), Uniform { samples: 1 });
    }

    #[test]
    fn the_speed_of_the_device_does_not_show_where_samples_share() {
        for batch in [1, 100, 1 << 20] {
            let limits = Limits { samples_that_share: Some(30), batch, ..LIMITS };
            assert_eq!(kind(Sampling::UNIFORM, limits, 0, ENDLESS), Uniform { samples: 30 });
            assert_eq!(kind(Sampling::UNIFORM, limits, 0, 2000), Uniform { samples: 20 });
        }
    }

    #[test]
    fn adaptive_rounds_follow_the_initial_samples() {
        assert_eq!(kind(ADAPTIVE, LIMITS, 0, ENDLESS), Uniform { samples: 5 });
        assert_eq!(kind(ADAPTIVE, LIMITS, 499, ENDLESS), Uniform { samples: 1 });
        assert_eq!(kind(ADAPTIVE, LIMITS, 0, 300), Uniform { samples: 3 });
        let shared = Limits { samples_that_share: Some(2), ..LIMITS };
        assert_eq!(kind(ADAPTIVE, shared, 0, ENDLESS), Uniform { samples: 2 });
        // Half of what pixels have.
        assert_eq!(kind(ADAPTIVE, LIMITS, 500, ENDLESS), Adaptive { paths: 250 });
        assert_eq!(kind(ADAPTIVE, LIMITS, 500, 20), Adaptive { paths: 20 });
        assert_eq!(kind(ADAPTIVE, shared, 5000, ENDLESS), Adaptive { paths: 200 });
    }

    #[test]
    fn an_adaptive_round_fits_the_stream_and_is_never_empty() {
        assert_eq!(kind(ADAPTIVE, LIMITS, 1 << 40, ENDLESS), Adaptive { paths: 10_000 });
        let small = Sampling { round_budget: Some(1e-9), ..ADAPTIVE };
        assert_eq!(kind(small, LIMITS, 500, ENDLESS), Adaptive { paths: 1 });
    }

    #[test]
    fn rounds_are_numbered() {
        let number = |rounds| plan(&ADAPTIVE, &LIMITS, Done { paths: 0, rounds }, 1).number;
        assert_eq!([number(0), number(7)], [0, 7]);
    }
}
