//! `raystream bench integrators`

use super::choices::choice;
use super::effects::{Facts, Given};
use super::ending::{CliError, Ending};
use super::entries::{self, Entry, Loaded, parse_entry};
use super::options::{DeviceArguments, SettingsArguments, parse_seconds};
use super::output::say;
use clap::Args;
use raystream::exec::device::Device;
use raystream::render::IntegratorKind;
use raystream_bench::integrators::{GROUP, Plan, measure, write_scene};
use raystream_bench::{About, Folder, SceneReport, each_once};
use std::path::PathBuf;
use std::time::Duration;

/// The options of `raystream bench integrators`.
#[derive(Args)]
pub struct IntegratorsArguments {
    /// Scene files, or names of scenes that ship; each may end in @WIDTHxHEIGHT, the size of its
    /// picture.
    #[arg(default_value = "cornell_ball", value_parser = parse_entry)]
    scenes: Vec<Entry>,
    /// Integrators to measure, separated by commas; megakernel, with which the others are compared,
    /// is measured in any case [default: all that walk the same paths, or the one that --integrator
    /// names].
    #[arg(
        long,
        value_parser = choice::<IntegratorKind>(),
        value_delimiter = ',',
        value_name = "LIST",
        conflicts_with = "integrator"
    )]
    integrators: Vec<IntegratorKind>,
    /// How long to render with each integrator.
    #[arg(long, default_value = "3", value_name = "SECONDS", value_parser = parse_seconds)]
    time: Duration,
    /// Renders with each integrator, by turns; the median counts.
    #[arg(
        long,
        value_name = "K",
        default_value_t = 3,
        value_parser = clap::value_parser!(u32).range(1..=100)
    )]
    repetitions: u32,
    /// Slots of the stream that is compared slot for slot and whose paths are counted by
    /// iterations.
    #[arg(
        long,
        value_name = "N",
        default_value_t = 1 << 21,
        value_parser = clap::value_parser!(u32).range(1..=1 << 22)
    )]
    stream: u32,
    /// Folder for the results: report.md, and a folder with tables and a plot for each scene.
    #[arg(short, long, value_name = "DIR", default_value = "integrators")]
    output: PathBuf,
    /// Do not say what happens meanwhile.
    #[arg(short, long)]
    quiet: bool,
    #[command(flatten)]
    settings: SettingsArguments,
    #[command(flatten)]
    device: DeviceArguments,
}

/// Measures all scenes.
pub fn run(arguments: &IntegratorsArguments, given: &Given) -> Result<Ending, CliError> {
    let scenes = entries::load(&arguments.scenes, &arguments.settings, arguments.quiet)?;
    let output = Folder::create(&arguments.output)?;
    let device = arguments.device.open()?;
    let integrators = arguments.integrators(arguments.settings.integrator());
    given.warn(&Facts { integrators, ..Facts::of_device(&device) });
    let path = entries::report(&introduction(), scenes, &output, |loaded| {
        arguments.bench(&device, loaded, &output)
    })?;
    arguments.tell(&format!("wrote {}", path.display()));
    Ok(Ending::Done)
}

fn introduction() -> String {
    format!(
        "# Integrators

Speeds are by the clock on the wall, but for those of tracing alone, which are by the device's;
medians of the repetitions. *z* is the difference of mean radiance from the megakernel's in standard
errors; *identical slots* are those of one stream whose contribution is the megakernel's, bit for
bit. The plots show the paths that are under way in each iteration over that stream, in which each
advances by a segment: counted on the device for compaction and streaming; for megakernel and
regeneration they follow from the lengths of the paths, with groups of {GROUP} lanes that are held
until the longest of their paths has ended, or with as many threads as a large device can hold.
"
    )
}

impl IntegratorsArguments {
    /// The integrators to measure, megakernel first.
    fn integrators(&self, chosen: IntegratorKind) -> Vec<IntegratorKind> {
        let mut others = self.integrators.clone();
        if others.is_empty() && chosen == IntegratorKind::default() {
            // That of light vertices walks other paths: nothing of it is the megakernel's but the
            // mean.
            others = IntegratorKind::ALL
                .iter()
                .copied()
                .filter(|&kind| !matches!(kind, IntegratorKind::Auto | IntegratorKind::Lvc))
                .collect();
        } else if others.is_empty() {
            others.push(chosen);
        }
        others.insert(0, IntegratorKind::Megakernel);
        each_once(others)
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
        output: &Folder,
    ) -> Result<SceneReport, CliError> {
        let Loaded { label, scene, settings } = loaded;
        let folder = output.folder(&label)?;
        self.tell(&format!(
            "{label}: {} triangles, on {}",
            scene.triangle_count(),
            device.description()
        ));
        let plan = [
            ("seconds", self.time.as_secs_f64().to_string()),
            ("repetitions", self.repetitions.to_string()),
        ];
        let facts = entries::facts(
            device,
            &scene,
            settings.size,
            plan,
            self.settings.describe(&settings),
            None,
        );
        let plan = Plan {
            integrators: self.integrators(settings.integrator),
            time: self.time,
            repetitions: self.repetitions,
            stream: self.stream,
        };
        let prepared = self.settings.prepare(scene, self.quiet)?;
        let measured = measure(device, &prepared, &settings, &plan, &mut |line| {
            self.tell(&format!("    {line}"));
        })?;
        Ok(write_scene(&measured, plan.stream, &About { label, facts }, &folder)?)
    }
}
