//! Adaptive against uniform sampling, and integrators against each other: error over time, where
//! the time goes, and what is gained.
//!
//! [`measure`] renders a scene in every [`Configuration`] and records error and time at
//! [`checkpoints`]; [`write_scene`] sets the curves against that of uniform sampling with the first
//! integrator, and those of each other integrator against uniform sampling with it, at equal error
//! and at equal time, and writes tables, plots and pictures. Errors are against a [`Reference`]
//! with seeds of its own.

mod check;
mod configuration;
mod curve;
mod errors;
mod gains;
mod identity;
mod interpolation;
mod metric;
mod pictures;
mod reference;
mod render;
mod repeated;
mod report;
mod rounds;
mod speedup;
mod tables;

pub(crate) use check::{gray, variance};
pub use configuration::Configuration;
pub use curve::{Point, checkpoints};
pub(crate) use errors::squared_errors;
pub use errors::{Errors, TRIM};
pub use identity::Identity;
pub use reference::{REFERENCE_SEEDS, Reference};
pub(crate) use render::render_timed;
pub use report::write_scene;
pub use rounds::{Breakdown, Rate, Round, UniformRates};

use super::{BenchError, KEEP_WARM, WARM_UP, each_once, warm_up};
use check::Spread;
use raystream::exec::Executor;
use raystream::render::{IntegratorKind, PreparedScene, Renderer, Sampling, Settings};
use render::{record, rehearse};
use repeated::Repeated;
use std::collections::BTreeMap;

/// What to measure.
#[derive(Clone, Debug)]
pub struct Plan {
    /// What to set against each other, see [`Configuration::combinations`]: uniform sampling with
    /// the first integrator comes first, and with each of the others before what is measured
    /// against it.
    pub configurations: Vec<Configuration>,
    /// What the configurations leave open.
    pub base: Sampling,
    /// Samples per pixel at which to measure, rising; all of `levels` among them.
    pub checkpoints: Vec<u32>,
    /// Samples per pixel of uniform sampling whose error and time the others are compared at;
    /// rising, at least one.
    pub levels: Vec<u32>,
    /// Renders of each configuration, with seeds one after the other; at least 1.
    pub repetitions: u32,
}

impl Plan {
    /// The settings of a repetition.
    fn settings(
        &self,
        settings: &Settings,
        configuration: Configuration,
        repetition: u32,
    ) -> Settings {
        let seed = settings.seed.wrapping_add(repetition);
        configuration.settings(&Settings { seed, ..*settings }, self.base)
    }

    /// The integrators, each once.
    fn integrators(&self) -> Vec<IntegratorKind> {
        each_once(self.configurations.iter().map(|configuration| configuration.integrator))
    }
}

/// What was measured of one configuration.
pub struct Measured {
    /// Which.
    pub configuration: Configuration,
    /// What it is called; with the integrator, if there are several.
    pub name: String,
    /// Error over time.
    pub curve: Vec<Point>,
    /// The rounds of the first repetition.
    pub rounds: Vec<Round>,
}

/// What was measured of a scene.
pub struct Measurement {
    /// One for each of the plan's configurations, in their order.
    pub configurations: Vec<Measured>,
    /// How fast uniform rounds as long as the measured ones trace, by integrator.
    pub uniform_rates: BTreeMap<IntegratorKind, UniformRates>,
    /// How far the means of uniform renders are off, a sentence each.
    pub means: Vec<String>,
    /// What is to be known of the figures, a sentence each.
    pub warnings: Vec<String>,
}

impl Measurement {
    /// How fast uniform rounds with the integrator of `measured` trace.
    pub fn uniform_rates(&self, measured: &Measured) -> Option<&UniformRates> {
        self.uniform_rates.get(&measured.configuration.integrator)
    }
}

/// Measures a scene in all configurations of `plan`. `say` is told what happens.
///
/// # Errors
/// [`BenchError::Wrong`] if the mean of a uniform render differs from that of the reference by more
/// than its standard errors allow. With the integrator `lvc`, whose samples share light paths, the
/// standard error is that of the spread of some rounds, which are rendered for that alone. Adaptive
/// sampling has a bias of its own: there it is a warning.
pub fn measure<E: Executor>(
    executor: &E,
    scene: &PreparedScene,
    settings: &Settings,
    plan: &Plan,
    reference: &Reference,
    say: &mut dyn FnMut(&str),
) -> Result<Measurement, BenchError> {
    let integrators = plan.integrators();
    let uniform = |integrator| Settings { integrator, sampling: Sampling::UNIFORM, ..*settings };
    let by_lvc =
        integrators.iter().chain([&reference.integrator]).any(|&i| i == IntegratorKind::Lvc);
    let spread = if by_lvc {
        Spread::measure(executor, scene, &uniform(IntegratorKind::Lvc))?
    } else {
        None
    };
    for &configuration in &plan.configurations {
        rehearse(executor, scene, &plan.settings(settings, configuration, 0))?;
    }
    let first = integrators.first().copied().unwrap_or(settings.integrator);
    let mut other = Renderer::new(executor, scene, &uniform(first))?;
    let mut render_other = |time| warm_up(time, || other.uniform_round(1).finish().map(drop));
    render_other(WARM_UP)?;
    let mut repeated = Repeated::none_yet(&plan.configurations);
    // By turns, so that a device that slows down does so for all.
    for repetition in 0..plan.repetitions {
        for repeated in &mut repeated {
            let settings = plan.settings(settings, repeated.configuration, repetition);
            let recorded = record(
                executor,
                scene,
                &settings,
                &plan.checkpoints,
                reference,
                repetition == 0,
                &mut || render_other(KEEP_WARM),
            )?;
            say(&repeated.progress(&recorded, plan.repetitions));
            repeated.check_mean(&recorded, settings.seed, reference, spread)?;
            repeated.add(recorded);
        }
    }
    say("tracing uniform rounds of the same lengths");
    render_other(KEEP_WARM)?;
    let mut uniform_rates = BTreeMap::new();
    for integrator in integrators {
        let own = repeated.iter().filter(|r| r.configuration.integrator == integrator);
        let own: Vec<Round> = own.flat_map(|r| &r.rounds).copied().collect();
        let rates = UniformRates::measure(executor, scene, &uniform(integrator), &own)?;
        uniform_rates.insert(integrator, rates);
    }
    let means = repeated.iter().filter_map(Repeated::mean_sentence).collect();
    let configurations: Vec<_> = repeated.into_iter().map(Repeated::measured).collect();
    let warnings = configurations.iter().filter_map(bias_warning).collect();
    Ok(Measurement { configurations, uniform_rates, means, warnings })
}

/// A sentence on a mean that is further off than adaptive sampling explains.
fn bias_warning(measured: &Measured) -> Option<String> {
    let ratio = measured.curve.last()?.errors.mean_ratio;
    let biased = !measured.configuration.is_uniform() && (ratio - 1.0).abs() > check::ADAPTIVE_BIAS;
    biased.then(|| {
        format!(
            "{}: the mean is {ratio:.4} times the reference's at the end, more than {} % off",
            measured.name,
            100.0 * check::ADAPTIVE_BIAS
        )
    })
}
