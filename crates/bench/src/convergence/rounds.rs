//! What a round's time went into, and how fast uniform rounds of the same length trace.

use crate::{BenchError, median};
use raystream::exec::Executor;
use raystream::render::{Part, PreparedScene, Renderer, Sampling, Settings, Timings};
use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

/// One round.
#[derive(Clone, Copy, Debug)]
pub struct Round {
    /// Paths that it traced.
    pub paths: u64,
    /// Rays that it traced.
    pub rays: u64,
    /// Where its time went.
    pub timings: Timings,
    /// Its time by the clock on the wall.
    pub wall: Duration,
}

/// How fast uniform rounds of some length trace.
#[derive(Clone, Copy, Debug)]
pub struct Rate {
    /// Paths per second of tracing.
    pub paths: f64,
    /// Rays per second of tracing.
    pub rays: f64,
}

/// Tracing rates of uniform rounds by their samples per pixel.
pub struct UniformRates {
    pixels: u64,
    rates: BTreeMap<u32, Rate>,
}

/// Longer rounds than this many paths are worked off in several batches and trace no faster.
const LONGEST: u64 = 1 << 23;
/// Timed repetitions of a length.
const REPETITIONS: usize = 3;

impl UniformRates {
    /// Measures the lengths of `rounds`.
    pub fn measure<E: Executor>(
        executor: &E,
        scene: &PreparedScene,
        settings: &Settings,
        rounds: &[Round],
    ) -> Result<Self, BenchError> {
        let mut renderer =
            Renderer::new(executor, scene, &Settings { sampling: Sampling::UNIFORM, ..*settings })?;
        let pixels = u64::from(renderer.pixels());
        let lengths: BTreeSet<u32> =
            rounds.iter().map(|round| length(round.paths, pixels)).collect();
        let mut trace = |samples: u32| -> Result<(u64, u64, Duration), BenchError> {
            let (first, rays) = (renderer.paths(), renderer.rays()?);
            let goal = first + u64::from(samples) * pixels;
            let mut tracing = Duration::ZERO;
            while renderer.paths() < goal {
                tracing += renderer.step(goal - renderer.paths())?.tracing();
            }
            Ok((renderer.paths() - first, renderer.rays()? - rays, tracing))
        };
        // The size of a batch settles.
        if let Some(&longest) = lengths.last() {
            trace(longest)?;
        }
        let mut rates = BTreeMap::new();
        for samples in lengths {
            let runs = (0..REPETITIONS).map(|_| trace(samples)).collect::<Result<Vec<_>, _>>()?;
            let seconds = median(runs.iter().map(|run| run.2).collect()).as_secs_f64().max(1e-9);
            let rays = runs.iter().map(|run| run.1 as f64).sum::<f64>() / REPETITIONS as f64;
            rates.insert(samples, Rate { paths: runs[0].0 as f64 / seconds, rays: rays / seconds });
        }
        Ok(Self { pixels, rates })
    }

    /// The rate of a uniform round about as long as one of `paths` paths, if that was measured.
    pub fn of_length(&self, paths: u64) -> Option<Rate> {
        self.rates.get(&length(paths, self.pixels)).copied()
    }
}

/// Samples per pixel of a uniform round of about `paths` paths.
fn length(paths: u64, pixels: u64) -> u32 {
    let samples = (paths.min(LONGEST) as f64 / pixels as f64).round();
    (samples as u32).max(1)
}

/// Where the time of all rounds of a configuration went.
#[derive(Clone, Copy, Debug)]
pub struct Breakdown {
    /// Rounds that were added up.
    pub rounds: usize,
    /// Their paths.
    pub paths: u64,
    /// Their rays.
    pub rays: u64,
    /// Where their time went.
    pub timings: Timings,
    /// Tracing rate in paths, over that of a uniform round of the same length: the median over the
    /// rounds, which a device that slows down for a while does not change.
    pub paths_ratio: Option<f64>,
    /// The same in rays.
    pub rays_ratio: Option<f64>,
    /// Generation and accumulation together over tracing, likewise.
    pub overhead: Option<f64>,
}

impl Breakdown {
    /// Adds up `rounds` without the first, which is uniform for all, unless there is no other.
    pub fn of(rounds: &[Round], uniform: &UniformRates) -> Self {
        let rounds = if rounds.len() > 1 { &rounds[1..] } else { rounds };
        let mut timings = Timings::default();
        let (mut paths, mut rays) = (0, 0);
        for round in rounds {
            timings += round.timings;
            paths += round.paths;
            rays += round.rays;
        }
        // The seconds that a round takes to trace, if its time can be told from none.
        let seconds = |round: &Round| {
            Some(round.timings.tracing().as_secs_f64()).filter(|&seconds| seconds > 0.0)
        };
        Self {
            rounds: rounds.len(),
            paths,
            rays,
            timings,
            paths_ratio: median_of(rounds, |round| {
                Some(round.paths as f64 / seconds(round)? / uniform.of_length(round.paths)?.paths)
            }),
            rays_ratio: median_of(rounds, |round| {
                Some(round.rays as f64 / seconds(round)? / uniform.of_length(round.paths)?.rays)
            }),
            overhead: median_of(rounds, |round| {
                Some(
                    (round.timings.generation() + round.timings.accumulation()).as_secs_f64()
                        / seconds(round)?,
                )
            }),
        }
    }
}

/// The median of `value` over `rounds`; none if one has none.
fn median_of(rounds: &[Round], value: impl Fn(&Round) -> Option<f64>) -> Option<f64> {
    let mut values = rounds.iter().map(value).collect::<Option<Vec<_>>>()?;
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

/// `count` per second in millions, where the time can be told from none.
pub fn millions_per_second(count: u64, time: Duration) -> Option<f64> {
    (time > Duration::ZERO).then(|| count as f64 / time.as_secs_f64() / 1e6)
}

/// The parts of a round in the order in which they follow each other, with their names.
pub fn parts(timings: &Timings) -> [(&'static str, Duration); 5] {
    std::array::from_fn(|index| Part::ALL[index]).map(|part| (part.name(), timings[part]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn round(paths: u64, rays: u64, tracing: f64) -> Round {
        let mut timings = Timings::default();
        timings[Part::Tracing] = Duration::from_secs_f64(tracing);
        Round { paths, rays, timings, wall: timings.tracing() }
    }

    #[test]
    fn lengths_are_whole_samples_and_bounded() {
        assert_eq!(length(1, 100), 1);
        assert_eq!(length(251, 100), 3);
        assert_eq!(length(u64::MAX, 1 << 20), 8);
        assert_eq!(length(u64::MAX, 1 << 30), 1);
    }

    #[test]
    fn one_slow_round_changes_no_ratio() {
        // Uniform rounds of 1 and 2 samples: 100 and 200 paths per second, ten rays a path.
        let rates =
            [(1, Rate { paths: 100.0, rays: 1000.0 }), (2, Rate { paths: 200.0, rays: 2000.0 })];
        let uniform = UniformRates { pixels: 100, rates: rates.into() };
        let rounds = [
            round(500, 1, 9.0),
            round(100, 2000, 2.0),
            round(100, 2000, 2.0),
            round(200, 4000, 2.0),
            round(200, 4000, 50.0),
        ];
        let breakdown = Breakdown::of(&rounds, &uniform);
        assert_eq!((breakdown.rounds, breakdown.paths, breakdown.rays), (4, 600, 12_000));
        assert_eq!(breakdown.paths_ratio, Some(0.5));
        assert_eq!(breakdown.rays_ratio, Some(1.0));
        assert_eq!(breakdown.overhead, Some(0.0));
        assert_eq!(
            Breakdown::of(&rounds[..1], &uniform).paths_ratio,
            None,
            "that length was not measured"
        );
    }
}
