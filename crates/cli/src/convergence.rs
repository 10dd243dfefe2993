//! `raystream bench convergence`

use super::choices::choice;
use super::effects::{Facts, Given};
use super::ending::{CliError, Ending};
use super::entries::{self, Entry, Loaded, parse_entry};
use super::options::{DeviceArguments, SettingsArguments};
use super::output::say;
use super::progress::ProgressDisplay;
use super::sampling::{EstimationArguments, RoundArguments};
use clap::{Args, ValueEnum};
use raystream::exec::device::Device;
use raystream::render::{
    AllocatorKind, Estimator, FilterKind, IntegratorKind, PreparedScene, Sampling, Settings,
};
use raystream::scene::Scene;
use raystream_bench::convergence::{
    Configuration, Identity, Plan, REFERENCE_SEEDS, Reference, checkpoints, measure, write_scene,
};
use raystream_bench::{About, Folder, SceneReport, each_once};
use std::path::{Path, PathBuf};

/// The options of `raystream bench convergence`.
#[derive(Args)]
pub struct ConvergenceArguments {
    /// Scene files, or names of scenes that ship; each may end in @WIDTHxHEIGHT, the size of its
    /// picture.
    #[arg(default_values = ["cornell_ball", "cornell_ball@600x600"], value_parser = parse_entry)]
    scenes: Vec<Entry>,
    /// Integrators to measure, separated by commas: all allocators, estimators and measures with
    /// each of them, and uniform sampling with the first is what all are compared with [default:
    /// the one that --integrator names].
    #[arg(
        long,
        value_parser = choice::<IntegratorKind>(),
        value_delimiter = ',',
        value_name = "LIST"
    )]
    integrators: Vec<IntegratorKind>,
    /// Who renders the reference [default: the integrator that --integrator names].
    #[arg(long, value_parser = choice::<IntegratorKind>(), value_name = "INTEGRATOR")]
    reference_integrator: Option<IntegratorKind>,
    /// Allocators to measure, separated by commas; uniform is measured in any case, once with each
    /// integrator.
    #[arg(
        long,
        value_parser = choice::<AllocatorKind>(),
        value_delimiter = ',',
        value_name = "LIST",
        default_values_t = ALLOCATORS
    )]
    allocators: Vec<AllocatorKind>,
    /// Error estimators to measure with each of them.
    #[arg(
        long,
        value_parser = choice::<Estimator>(),
        value_delimiter = ',',
        value_name = "LIST",
        default_value = "bilateral"
    )]
    estimators: Vec<Estimator>,
    /// Filters of the picture, separated by commas: everything is measured without a filter and
    /// with each of these, the time of filtering included.
    #[arg(
        long,
        value_parser = choice::<FilterKind>(),
        value_delimiter = ',',
        value_name = "LIST"
    )]
    filters: Vec<FilterKind>,
    /// Measures of the error to use with each of them.
    #[arg(
        long,
        value_enum,
        value_delimiter = ',',
        value_name = "LIST",
        default_value = "absolute"
    )]
    errors: Vec<ErrorMeasure>,
    /// Samples per pixel to render, on average over the pixels.
    #[arg(
        long,
        value_name = "N",
        default_value_t = 512,
        value_parser = clap::value_parser!(u32).range(1..=MAX_SAMPLES / REFERENCE_FACTOR)
    )]
    spp: u32,
    /// Samples per pixel of uniform sampling whose error and time the others are compared at,
    /// separated by commas [default: 64 and 256, as far as --spp goes].
    #[arg(
        long,
        value_delimiter = ',',
        value_name = "LIST",
        value_parser = clap::value_parser!(u32).range(1..)
    )]
    levels: Vec<u32>,
    /// Renders of each configuration, with the seeds from --seed on: errors are averaged, of times
    /// the median counts.
    #[arg(
        long,
        value_name = "K",
        default_value_t = 3,
        value_parser = clap::value_parser!(u32).range(1..=100)
    )]
    repetitions: u32,
    /// Samples per pixel of the reference [default: 64 times --spp].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(4..=MAX_SAMPLES))]
    reference_spp: Option<u32>,
    /// Folder to keep references in [default: raystream in the user's folder for caches, such as
    /// ~/.cache].
    #[arg(long, value_name = "DIR")]
    cache: Option<PathBuf>,
    /// Folder for the results: report.md, and a folder with tables, plots and pictures for each
    /// scene.
    #[arg(short, long, value_name = "DIR", default_value = "convergence")]
    output: PathBuf,
    /// Do not say what happens meanwhile.
    #[arg(short, long)]
    quiet: bool,
    #[command(flatten)]
    rounds: RoundArguments,
    #[command(flatten)]
    estimation: EstimationArguments,
    #[command(flatten)]
    settings: SettingsArguments,
    #[command(flatten)]
    device: DeviceArguments,
}

/// Beyond this many samples, their counts in an f32 are not exact.
const MAX_SAMPLES: i64 = 1 << 24;
/// Samples of the reference for each of a measured render, unless another number is asked for.
const REFERENCE_FACTOR: i64 = 64;
/// What is measured unless other allocators are named.
const ALLOCATORS: [AllocatorKind; 4] =
    [AllocatorKind::Uniform, AllocatorKind::Paper, AllocatorKind::Atomic, AllocatorKind::Runs];
/// Where to compare unless other levels are named.
const LEVELS: [u32; 2] = [64, 256];

/// What an error is measured by.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum ErrorMeasure {
    /// The error as it is.
    Absolute,
    /// By the brightness of its pixel.
    Relative,
}

/// Measures all scenes.
pub fn run(arguments: &ConvergenceArguments, given: &Given) -> Result<Ending, CliError> {
    let levels = arguments.levels()?;
    arguments.check_seed()?;
    let scenes = entries::load(&arguments.scenes, &arguments.settings, arguments.quiet)?;
    let cache = Folder::create(&arguments.cache_folder()?)?;
    let output = Folder::create(&arguments.output)?;
    let device = arguments.device.open()?;
    given.warn(&arguments.facts(&device));
    let plan = Plan {
        configurations: arguments.configurations(),
        base: arguments.rounds.sampling(&arguments.estimation),
        checkpoints: checkpoints(arguments.spp, &levels),
        levels,
        repetitions: arguments.repetitions,
    };
    let path = entries::report(INTRODUCTION, scenes, &output, |loaded| {
        arguments.bench(&device, loaded, &plan, &cache, &output)
    })?;
    arguments.tell(&format!("wrote {}", path.display()));
    Ok(Ending::Done)
}

const INTRODUCTION: &str = "# Error over time

Times are those of the rounds by the clock on the wall, the medians of the repetitions; errors are
averaged over them. *Trimmed* errors leave out the worst 0.1 % of the pixels. Between checkpoints
curves are interpolated in log-log scale, beyond their ends never. A table's columns are explained
above it; every figure is in the CSV files.
";

impl ConvergenceArguments {
    fn levels(&self) -> Result<Vec<u32>, String> {
        let mut levels = self.levels.clone();
        if levels.is_empty() {
            levels = LEVELS.iter().copied().filter(|&level| level <= self.spp).collect();
        }
        if levels.is_empty() {
            levels.push(self.spp);
        }
        levels.sort_unstable();
        levels.dedup();
        match levels.iter().find(|&&level| level > self.spp) {
            Some(level) => Err(format!(
                "--levels {level} is beyond the {} samples per pixel of --spp; raise --spp or \
                 leave the level out",
                self.spp
            )),
            None => Ok(levels),
        }
    }

    /// Fails if a measured render would be a part of the reference.
    fn check_seed(&self) -> Result<(), String> {
        let seed = self.settings.seed();
        if REFERENCE_SEEDS.iter().any(|reference| reference.wrapping_sub(seed) < self.repetitions) {
            return Err(format!(
                "--seed {seed}: the reference has one of the seeds from here on; choose a lower one"
            ));
        }
        Ok(())
    }

    fn configurations(&self) -> Vec<Configuration> {
        let relative: Vec<bool> =
            self.errors.iter().map(|&measure| measure == ErrorMeasure::Relative).collect();
        Configuration::combinations(
            &self.integrators(),
            &self.allocators,
            &self.estimators,
            &relative,
            &self.filters,
        )
    }

    /// The integrators to measure, each once, at least one.
    fn integrators(&self) -> Vec<IntegratorKind> {
        let integrators = each_once(self.integrators.iter().copied());
        if integrators.is_empty() { vec![self.settings.integrator()] } else { integrators }
    }

    fn reference_integrator(&self) -> IntegratorKind {
        self.reference_integrator.unwrap_or(self.settings.integrator())
    }

    /// What its options depend on.
    fn facts(&self, device: &Device) -> Facts {
        let mut integrators = self.integrators();
        integrators.push(self.reference_integrator());
        let combinations = self.allocators.iter().flat_map(|&allocator| {
            self.estimators.iter().map(move |&estimator| (allocator, estimator))
        });
        let samplings = combinations.map(|(allocator, estimator)| Sampling {
            allocator,
            estimator,
            ..Sampling::UNIFORM
        });
        Facts {
            filters: self.filters.clone(),
            integrators,
            samplings: samplings.collect(),
            uses_integrator: self.integrators.is_empty() || self.reference_integrator.is_none(),
            ..Facts::of_device(device)
        }
    }

    fn cache_folder(&self) -> Result<PathBuf, String> {
        use etcetera::BaseStrategy;
        match &self.cache {
            Some(folder) => Ok(folder.clone()),
            None => etcetera::choose_base_strategy()
                .map(|strategy| strategy.cache_dir().join("raystream"))
                .map_err(|error| {
                    format!("there is no folder for caches ({error}); name one with --cache")
                }),
        }
    }

    fn tell(&self, line: &str) {
        if !self.quiet {
            say(line);
        }
    }

    fn bench(
        &self,
        device: &Device,
        loaded: Loaded,
        plan: &Plan,
        cache: &Folder,
        output: &Folder,
    ) -> Result<SceneReport, CliError> {
        let Loaded { label, scene, settings } = loaded;
        let folder = output.folder(&label)?;
        self.tell(&format!(
            "{label}: {} triangles, on {}",
            scene.triangle_count(),
            device.description()
        ));
        let about = self.about(&label, &scene, &settings, device);
        let samples = self.reference_spp.unwrap_or(REFERENCE_FACTOR as u32 * self.spp);
        let reference_settings = Reference::settings(&settings, self.reference_integrator());
        let identity = Identity::new(&scene, &reference_settings, samples);
        let prepared = self.settings.prepare(scene, self.quiet)?;
        let path = cache.file(&format!("{label}-{samples}spp-{}.exr", identity.short()));
        let reference =
            self.reference(device, &prepared, &reference_settings, samples, &identity, &path)?;
        let measurement = measure(device, &prepared, &settings, plan, &reference, &mut |line| {
            self.tell(&format!("    {line}"));
        })?;
        self.tell("    pictures at equal time");
        Ok(write_scene(
            device,
            &prepared,
            &settings,
            plan,
            &reference,
            &measurement,
            &about,
            &folder,
        )?)
    }

    /// The reference from the cache or, if it is not there or no good, rendered and put there.
    fn reference(
        &self,
        device: &Device,
        scene: &PreparedScene,
        settings: &Settings,
        samples: u32,
        identity: &Identity,
        path: &Path,
    ) -> Result<Reference, CliError> {
        match Reference::load(path, identity, samples, settings.integrator) {
            Ok(Some(reference)) => {
                self.tell(&format!("    reference from {}", path.display()));
                return Ok(reference);
            }
            Ok(None) => {
                let by = settings.integrator.name();
                self.tell(&format!(
                    "    rendering the reference by {by} with {samples} samples per pixel"
                ));
            }
            Err(reason) => say(&format!(
                "    {} cannot be used, {reason}: rendering the reference again",
                path.display()
            )),
        }
        let mut display = ProgressDisplay::new(self.quiet);
        let reference = Reference::render(device, scene, settings, samples, &mut |progress| {
            display.show(progress);
        });
        display.finish();
        let reference = reference?;
        reference.store(path, identity)?;
        self.tell(&format!("    kept it as {}", path.display()));
        Ok(reference)
    }

    fn about(&self, label: &str, scene: &Scene, settings: &Settings, device: &Device) -> About {
        let integrators = self.integrators();
        let by_lvc = integrators
            .iter()
            .chain([&self.reference_integrator()])
            .any(|&i| i == IntegratorKind::Lvc);
        // The settings of the light cache are told where they count.
        let integrator = if by_lvc { IntegratorKind::Lvc } else { settings.integrator };
        let described = self.settings.describe(&Settings { integrator, ..*settings });
        let plan = [
            ("samples per pixel", self.spp.to_string()),
            ("repetitions", self.repetitions.to_string()),
        ];
        let listed: Vec<_> = integrators.iter().map(|kind| kind.name()).collect();
        let listed =
            (if listed.len() > 1 { "integrators" } else { "integrator" }, listed.join(", "));
        About {
            label: label.to_owned(),
            facts: entries::facts(device, scene, settings.size, plan, described, Some(listed)),
        }
    }
}
