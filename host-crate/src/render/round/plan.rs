//! Which round comes next: decided without a device.

use crate::render::settings::sampling::{AllocatorKind, Sampling};

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
    /// Samples that every pixel has got alike.
    pub uniform: u32,
    /// Rounds begun.
    pub rounds: u32,
}

/// A round to be run. At least one of its parts is not empty.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RoundPlan {
    /// Number of the round, from 0 on.
    pub number: u32,
    /// Samples of every pixel.
    pub uniform: u32,
    /// Paths beside these, which go where the allocator makes them go by the errors.
    pub adaptive: u64,
}

/// The next round, of at most `paths_left` paths (but always one sample of each pixel first):
/// uniform ones until every pixel has [`Sampling::initial_samples`], then what the allocator makes
/// of the errors beside the [`control_share`](Sampling::control_share). The last round of a budget
/// that has a share is a short one without: it repairs what chance has brought in the one before.
pub fn plan(sampling: &Sampling, limits: &Limits, done: Done, paths_left: u64) -> RoundPlan {
    let pixels = u64::from(limits.pixels);
    let most = limits.samples_that_share.unwrap_or(u32::MAX);
    let samples_left = ((paths_left / pixels).clamp(1, u64::from(u32::MAX)) as u32).min(most);
    let samples = (done.paths / pixels) as u32;
    let uniform = |uniform| RoundPlan { number: done.rounds, uniform, adaptive: 0 };
    if sampling.allocator == AllocatorKind::Uniform {
        // Where the length of rounds shows in the film, it must not follow from time.
        let one_batch = (u64::from(limits.batch) / pixels).max(1) as u32;
        let longest = if limits.samples_that_share.is_some() { u32::MAX } else { one_batch };
        return uniform(samples_left.min(longest));
    }
    if samples < sampling.initial_samples {
        return uniform((sampling.initial_samples - samples).min(samples_left));
    }
    let paths = samples_of_round(sampling, limits, done) * f64::from(limits.pixels);
    let paths = (paths as u64).clamp(1, paths_left);
    let repairs = paths_of_repairs(sampling, limits, done, paths_left);
    if paths_left <= repairs + repairs / 2 {
        return RoundPlan { number: done.rounds, uniform: 0, adaptive: paths_left };
    }
    let paths = paths.min(paths_left.saturating_sub(repairs)).max(1);
    let due = control_due(sampling, pixels, done, paths);
    // Rounds shorter than the picture leave their share to one of its own now and then.
    if due > 0 && paths < pixels && pixels <= paths_left {
        return uniform(1);
    }
    let control = due.min(paths / pixels);
    RoundPlan { adaptive: paths - control * pixels, ..uniform(control as u32) }
}

/// Paths of the last round: a bright path that has just fallen on a pixel is the largest error that
/// there is, until the next round samples the pixel again. 0 for no such round.
fn paths_of_repairs(sampling: &Sampling, limits: &Limits, done: Done, paths_left: u64) -> u64 {
    /// All paths by those of such a round: few enough to bring few such paths of its own.
    const PART: u64 = 32;
    let fits = u64::from(limits.slots / 2);
    match done.paths.checked_add(paths_left) {
        Some(all) if sampling.control_share() > 0 => (all / PART).min(fits),
        _ => 0,
    }
}

/// Samples of each pixel that the control film should get in a round of `paths` paths.
fn control_due(sampling: &Sampling, pixels: u64, done: Done, paths: u64) -> u64 {
    let initial = u64::from(sampling.initial_samples);
    let adaptive = (done.paths + paths).saturating_sub(initial * pixels);
    let share = u128::from(sampling.control_share()) * u128::from(adaptive);
    let due = initial + (share / (256 * u128::from(pixels))) as u64;
    if share == 0 { 0 } else { due.saturating_sub(u64::from(done.uniform)) }
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
    use super::*;

    const LIMITS: Limits =
        Limits { pixels: 100, slots: 10_000, samples_that_share: None, batch: 1000 };
    const ADAPTIVE: Sampling = Sampling { allocator: AllocatorKind::Paper, ..Sampling::UNIFORM };
    const CONTROLLED: Sampling = Sampling { allocator: AllocatorKind::Runs, ..Sampling::UNIFORM };
    const ENDLESS: u64 = u64::MAX;

    /// The parts of the next round.
    fn parts(sampling: Sampling, limits: Limits, paths: u64, paths_left: u64) -> (u32, u64) {
        let done = Done { paths, ..Done::default() };
        let plan = plan(&sampling, &limits, done, paths_left);
        (plan.uniform, plan.adaptive)
    }

    #[test]
    fn uniform_rounds_are_a_batch_long_and_end_with_the_budget() {
        let uniform = |limits, left| parts(Sampling::UNIFORM, limits, 0, left);
        assert_eq!(uniform(LIMITS, ENDLESS), (10, 0));
        assert_eq!(uniform(LIMITS, 700), (7, 0));
        assert_eq!(uniform(LIMITS, 1), (1, 0), "always a sample of each pixel");
        assert_eq!(uniform(Limits { batch: 1, ..LIMITS }, ENDLESS), (1, 0));
    }

    #[test]
    fn the_speed_of_the_device_does_not_show_where_samples_share() {
        for batch in [1, 100, 1 << 20] {
            let limits = Limits { samples_that_share: Some(30), batch, ..LIMITS };
            assert_eq!(parts(Sampling::UNIFORM, limits, 0, ENDLESS), (30, 0));
            assert_eq!(parts(Sampling::UNIFORM, limits, 0, 2000), (20, 0));
        }
    }

    #[test]
    fn adaptive_rounds_follow_the_initial_samples() {
        assert_eq!(parts(ADAPTIVE, LIMITS, 0, ENDLESS), (5, 0));
        assert_eq!(parts(ADAPTIVE, LIMITS, 499, ENDLESS), (1, 0));
        assert_eq!(parts(ADAPTIVE, LIMITS, 0, 300), (3, 0));
        let shared = Limits { samples_that_share: Some(2), ..LIMITS };
        assert_eq!(parts(ADAPTIVE, shared, 0, ENDLESS), (2, 0));
        // Half of what pixels have.
        assert_eq!(parts(ADAPTIVE, LIMITS, 500, ENDLESS), (0, 250));
        assert_eq!(parts(ADAPTIVE, LIMITS, 500, 20), (0, 20));
        assert_eq!(parts(ADAPTIVE, shared, 5000, ENDLESS), (0, 200));
    }

    #[test]
    fn an_adaptive_round_fits_the_stream_and_is_never_empty() {
        assert_eq!(parts(ADAPTIVE, LIMITS, 1 << 40, ENDLESS), (0, 10_000));
        let small = Sampling { round_budget: Some(1e-9), ..ADAPTIVE };
        assert_eq!(parts(small, LIMITS, 500, ENDLESS), (0, 1));
    }

    /// Renders `total` paths by plan; the samples that every pixel has got alike.
    fn control_samples(sampling: Sampling, total: u64) -> u32 {
        let mut done = Done::default();
        while done.paths < total {
            let plan = plan(&sampling, &LIMITS, done, total - done.paths);
            let paths = u64::from(plan.uniform) * 100 + plan.adaptive;
            assert!(paths > 0 && done.paths + paths <= total, "the budget is met");
            done = Done {
                paths: done.paths + paths,
                uniform: done.uniform + plan.uniform,
                rounds: done.rounds + 1,
            };
        }
        done.uniform
    }

    #[test]
    fn the_control_film_gets_its_share_in_whole_samples() {
        assert_eq!(parts(CONTROLLED, LIMITS, 0, ENDLESS), (5, 0));
        for (samples, control) in [(5, 5), (9, 5), (11, 6), (64, 16), (256, 53), (4096, 810)] {
            assert_eq!(control_samples(CONTROLLED, 100 * samples), control, "of {samples}");
        }
        assert_eq!(control_samples(ADAPTIVE, 6400), 5, "without a control film");
    }

    #[test]
    fn the_last_round_of_a_budget_repairs() {
        let next = |paths, uniform, left| {
            let done = Done { paths, uniform, rounds: 3 };
            let plan = plan(&CONTROLLED, &LIMITS, done, left);
            (plan.uniform, plan.adaptive)
        };
        // Of 64 samples 2 are left to it, with which no control sample comes.
        assert_eq!(next(4000, 12, 2400), (4, 1800), "what is left but for the repairs");
        assert_eq!(next(6200, 12, 200), (0, 200));
        assert_eq!(next(6200, 12, ENDLESS), (16, 4600), "who knows no end repairs nothing");
        // It fits into the stream however long the render is.
        assert_eq!(next(1 << 30, 2_200_000, 6000), (0, 6000));
    }

    #[test]
    fn short_rounds_leave_the_share_to_rounds_of_its_own() {
        let short = Sampling { round_budget: Some(0.3), ..CONTROLLED };
        assert_eq!(control_samples(short, 6400), 16);
        // The last round is too short for a sample of every pixel.
        assert_eq!(control_samples(short, 1010), 5);
    }

    #[test]
    fn rounds_are_numbered() {
        let done = |rounds| Done { rounds, ..Done::default() };
        let number = |rounds| plan(&ADAPTIVE, &LIMITS, done(rounds), 1).number;
        assert_eq!([number(0), number(7)], [0, 7]);
    }
}
