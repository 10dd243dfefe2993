//! Adaptive against uniform sampling: error over time, where the time goes, and what it gains.
//!
//! [`measure`] renders a scene in every [`Configuration`] and records error and time at [`checkpoints`]; [`write_scene`]
//! sets the curves against that of uniform sampling, at equal error and at equal time, and writes tables, plots and
//! pictures. Errors are against a [`Reference`] with seeds of its own.

mod check;
mod configuration;
mod curve;
mod errors;
mod identity;
mod interpolation;
mod pictures;
mod reference;
mod render;
mod report;
mod rounds;
mod speedup;
mod tables;

pub use configuration::Configuration;
pub use curve::{Point, checkpoints};
pub use errors::{Errors, TRIM};
pub use identity::Identity;
pub use reference::{REFERENCE_SEEDS, Reference};
pub use report::write_scene;
pub use rounds::{Breakdown, Rate, Round, UniformRates};

use super::{BenchError, KEEP_WARM, WARM_UP, warm_up};
use crate::exec::Executor;
use crate::render::{PreparedScene, Renderer, Sampling, Settings};
use render::{record, rehearse};

/// What to measure.
#[derive(Clone, Debug)]
pub struct Plan {
    /// What to set against each other; uniform sampling first.
    pub configurations: Vec<Configuration>,
    /// What the configurations leave open.
    pub base: Sampling,
    /// Samples per pixel at which to measure, rising; all of `levels` among them.
    pub checkpoints: Vec<u32>,
    /// Samples per pixel of uniform sampling whose error and time the others are compared at; rising, at least one.
    pub levels: Vec<u32>,
    /// Renders of each configuration, with seeds one after the other; at least 1.
    pub repetitions: u32,
}

impl Plan {
    /// The settings of a repetition.
    fn settings(&self, settings: &Settings, configuration: Configuration, repetition: u32) -> Settings {
        let seed = settings.seed.wrapping_add(repetition);
        Settings { seed, sampling: configuration.sampling(self.base), ..*settings }
    }
}

/// What was measured of one configuration.
pub struct Measured {
    /// Which.
    pub configuration: Configuration,
    /// Error over time.
    pub curve: Vec<Point>,
    /// The rounds of the first repetition.
    pub rounds: Vec<Round>,
}

/// What was measured of a scene.
pub struct Measurement {
    /// One for each of the plan's configurations, in their order.
    pub configurations: Vec<Measured>,
    /// How fast uniform rounds as long as the measured ones trace.
    pub uniform_rates: UniformRates,
    /// What is to be known of the figures, a sentence each.
    pub warnings: Vec<String>,
}

/// Measures a scene in all configurations of `plan`. `say` is told what happens.
///
/// # Errors
/// [`BenchError::Wrong`] if the mean of a uniform render differs from that of the reference by more than its standard
/// errors allow. Adaptive sampling has a bias of its own: there it is a warning.
pub fn measure<E: Executor>(
    executor: &E,
    scene: &PreparedScene,
    settings: &Settings,
    plan: &Plan,
    reference: &Reference,
    say: &mut dyn FnMut(&str),
) -> Result<Measurement, BenchError> {
    for &configuration in &plan.configurations {
        rehearse(executor, scene, &plan.settings(settings, configuration, 0))?;
    }
    let mut other = Renderer::new(executor, scene, &Settings { sampling: Sampling::UNIFORM, ..*settings })?;
    let mut render_other = |time| warm_up(time, || other.round(1, &mut |_| ()).map(drop));
    render_other(WARM_UP)?;
    let mut curves = vec![Vec::new(); plan.configurations.len()];
    let mut rounds = vec![Vec::new(); plan.configurations.len()];
    // By turns, so that a device that slows down does so for all.
    for repetition in 0..plan.repetitions {
        for (index, &configuration) in plan.configurations.iter().enumerate() {
            let settings = plan.settings(settings, configuration, repetition);
            let mut renderer = Renderer::new(executor, scene, &settings)?;
            render_other(KEEP_WARM)?;
            let recorded = record(&mut renderer, &settings, &plan.checkpoints, reference, repetition == 0)?;
            let Some(end) = recorded.points.last() else { continue };
            say(&format!(
                "{}, {} of {}: {:.2} samples per pixel in {:.2} s, RMSE {:.3e}",
                configuration.name(),
                repetition + 1,
                plan.repetitions,
                end.samples,
                end.wall.as_secs_f64(),
                end.errors.rmse
            ));
            if configuration.is_uniform() {
                let off = check::mean_difference(&recorded.last, end.samples, reference);
                // NaN must not pass.
                if off.is_nan() || off > check::LIMIT {
                    return Err(BenchError::Wrong(format!(
                        "the mean of the uniform render with seed {} is {:.5} times the reference's, {off:.1} standard errors off",
                        settings.seed, end.errors.mean_ratio
                    )));
                }
            }
            if repetition == 0 {
                rounds[index] = recorded.rounds;
            }
            curves[index].push(recorded.points);
        }
    }
    say("tracing uniform rounds of the same lengths");
    render_other(KEEP_WARM)?;
    let all_rounds: Vec<Round> = rounds.iter().flatten().copied().collect();
    let uniform_rates = UniformRates::measure(executor, scene, settings, &all_rounds)?;
    let configurations: Vec<Measured> = plan
        .configurations
        .iter()
        .zip(curves.iter().zip(rounds))
        .map(|(&configuration, (curves, rounds))| Measured { configuration, curve: curve::aggregate(curves), rounds })
        .collect();
    let warnings = configurations.iter().filter_map(bias_warning).collect();
    Ok(Measurement { configurations, uniform_rates, warnings })
}

/// A sentence on a mean that is further off than adaptive sampling explains.
fn bias_warning(measured: &Measured) -> Option<String> {
    let ratio = measured.curve.last()?.errors.mean_ratio;
    let biased = !measured.configuration.is_uniform() && (ratio - 1.0).abs() > check::ADAPTIVE_BIAS;
    biased.then(|| {
        format!(
            "{}: the mean is {ratio:.4} times the reference's at the end, more than {} % off",
            measured.configuration.name(),
            100.0 * check::ADAPTIVE_BIAS
        )
    })
}
