//! `raystream bench`

use super::convergence::{self, ConvergenceArguments};
use super::effects::{Facts, Given};
use super::ending::{CliError, Ending};
use super::integrators::{self, IntegratorsArguments};
use super::options::{DeviceArguments, SettingsArguments, parse_seconds};
use super::output::print_line;
use super::sampling::SamplingArguments;
use clap::{Args, Subcommand};
use raystream::exec::device::Device;
use raystream::render::{PreparedScene, Settings};
use raystream::scene::FilmSize;
use raystream_bench::{bias, paths, rays};
use std::path::PathBuf;
use std::time::Duration;

/// What to measure.
#[derive(Subcommand)]
pub enum BenchCommand {
    /// Rays per second of the traversal: primary, diffuse-bounce and shadow rays, checked against
    /// brute force.
    Rays(RaysArguments),
    /// Paths per second of whole renders.
    Paths(PathsArguments),
    /// Integrators side by side: speed, memory, agreement, and how many paths are under way in each
    /// iteration.
    Integrators(IntegratorsArguments),
    /// Error over time of adaptive and of uniform sampling, with one integrator or several:
    /// speed-ups at equal error, errors at equal time, and where the time goes.
    Convergence(ConvergenceArguments),
    /// Bias: how far adaptive pictures are off on average, as wholes and by blocks of 40x30 pixels,
    /// over renders with many seeds.
    Bias(BiasArguments),
}

/// The options of `raystream bench rays`.
#[derive(Args)]
pub struct RaysArguments {
    #[command(flatten)]
    common: CommonArguments,
    /// Timed repetitions; the median counts.
    #[arg(long, default_value_t = 15, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    repetitions: u32,
    /// Rays of each kind to check against brute force.
    #[arg(long, default_value_t = 1024)]
    checks: u32,
}

/// The options of `raystream bench paths`.
#[derive(Args)]
pub struct PathsArguments {
    #[command(flatten)]
    common: CommonArguments,
    /// How long to render each scene.
    #[arg(long, default_value = "3", value_name = "SECONDS", value_parser = parse_seconds)]
    time: Duration,
}

/// The options of `raystream bench bias`.
#[derive(Args)]
pub struct BiasArguments {
    #[command(flatten)]
    common: CommonArguments,
    #[command(flatten)]
    sampling: SamplingArguments,
    /// Samples per pixel, on average over the pixels, of the pictures: one row each.
    #[arg(
        long,
        value_delimiter = ',',
        value_name = "LIST",
        default_values_t = [16, 64, 256],
        value_parser = clap::value_parser!(u32).range(1..=1 << 20)
    )]
    spp: Vec<u32>,
    /// Renders of each row, with the seeds from --seed on.
    #[arg(
        long,
        default_value_t = 16,
        value_name = "N",
        value_parser = clap::value_parser!(u32).range(2..=100_000)
    )]
    renders: u32,
    /// Samples per pixel of the truth, which is sampled uniformly.
    #[arg(
        long,
        default_value_t = 16_384,
        value_name = "N",
        value_parser = clap::value_parser!(u32).range(16..=1 << 24)
    )]
    truth_spp: u32,
}

#[derive(Args)]
struct CommonArguments {
    /// Scene files, or names of scenes that ship.
    #[arg(default_value = "cornell_ball")]
    scenes: Vec<PathBuf>,
    #[command(flatten)]
    settings: SettingsArguments,
    #[command(flatten)]
    device: DeviceArguments,
}

/// The size at which rays are measured unless another is asked for.
const RAYS_SIZE: FilmSize = FilmSize { width: 1920, height: 1080 };

/// Runs a measurement.
pub fn run(command: &BenchCommand, given: &Given) -> Result<Ending, CliError> {
    match command {
        BenchCommand::Convergence(arguments) => return convergence::run(arguments, given),
        BenchCommand::Integrators(arguments) => return integrators::run(arguments, given),
        BenchCommand::Rays(arguments) => {
            let facts = Facts { traces_paths: false, ..Facts::default() };
            arguments.common.for_each_scene(
                Some(RAYS_SIZE),
                given,
                facts,
                |device, scene, settings| bench_rays(arguments, device, scene, settings),
            )
        }
        BenchCommand::Bias(arguments) => {
            let samplings = vec![arguments.sampling.sampling()];
            let facts = Facts { samplings, ..Facts::default() };
            arguments.common.for_each_scene(None, given, facts, |device, scene, settings| {
                bench_bias(arguments, device, scene, settings)
            })
        }
        BenchCommand::Paths(arguments) => {
            let facts = Facts::default();
            arguments.common.for_each_scene(None, given, facts, |device, scene, settings| {
                bench_paths(arguments.time, device, scene, settings)
            })
        }
    }?;
    Ok(Ending::Done)
}

impl CommonArguments {
    fn for_each_scene(
        &self,
        size: Option<FilmSize>,
        given: &Given,
        facts: Facts,
        measure: impl Fn(&Device, &PreparedScene, &Settings) -> Result<(), CliError>,
    ) -> Result<(), CliError> {
        let device = self.device.open()?;
        let integrators = vec![self.settings.integrator()];
        given.warn(&Facts { integrators, on_gpu: Facts::of_device(&device).on_gpu, ..facts });
        for name in &self.scenes {
            let mut scene = self.settings.load_scene(name, false)?;
            scene.film = size.unwrap_or(scene.film);
            let settings = self.settings.settings(&scene);
            print_line(&format!(
                "{}, {} triangles, {}x{}, max_depth {}, on {}",
                scene.name,
                scene.triangle_count(),
                settings.size.width,
                settings.size.height,
                settings.max_depth,
                device.description()
            ))?;
            measure(&device, &self.settings.prepare(scene, false)?, &settings)?;
        }
        Ok(())
    }
}

fn bench_rays(
    arguments: &RaysArguments,
    device: &Device,
    scene: &PreparedScene,
    settings: &Settings,
) -> Result<(), CliError> {
    let options =
        rays::Options { repetitions: arguments.repetitions, checks: arguments.checks as usize };
    for speed in rays::measure(device, scene, settings, options)? {
        print_line(&format!(
            "    {:<15} {:9.2} Mrays/s, {:5.1} % hit ({} rays checked, {} ties)",
            speed.kind,
            speed.mrays_per_second,
            100.0 * speed.hits,
            speed.checked,
            speed.ties
        ))?;
    }
    Ok(())
}

/// Standard errors beyond which a block is counted.
const BLOCK_LIMIT: f64 = 4.0;
/// Blocks that are shown of each row.
const BLOCKS_SHOWN: usize = 3;

fn bench_bias(
    arguments: &BiasArguments,
    device: &Device,
    scene: &PreparedScene,
    settings: &Settings,
) -> Result<(), CliError> {
    let settings = Settings { sampling: arguments.sampling.sampling(), ..*settings };
    let options = bias::Options { renders: arguments.renders, truth_samples: arguments.truth_spp };
    for bias in bias::measure(device, scene, &settings, &arguments.spp, options)? {
        let percent = |e: bias::Estimate| {
            format!(
                "{:+.3} +- {:.3} % ({:.1} SE)",
                100.0 * e.mean,
                100.0 * e.error,
                e.standard_errors()
            )
        };
        let beyond = |b: &&bias::BlockBias| b.bias.standard_errors() > BLOCK_LIMIT;
        print_line(&format!(
            "    {:>5} spp: {}, plain {}; {} of {} blocks beyond {BLOCK_LIMIT} SE; RMSE {:.5}, \
             plain {:.5}, in {:.1} ms",
            bias.samples,
            percent(bias.whole),
            percent(bias.plain),
            bias.blocks.iter().filter(beyond).count(),
            bias.blocks.len(),
            bias.rmse,
            bias.plain_rmse,
            1e3 * bias.seconds
        ))?;
        if let Some(ratio) = bias.calibration.ratio() {
            let tenth = |ratio: Option<f64>| ratio.map_or("-".to_owned(), |r| format!("{r:.2}"));
            print_line(&format!(
                "        estimated by true error: {ratio:.2}; of tenths of the pixels, the calmest \
                 first: {}",
                bias.calibration.ratios().map(tenth).join(" ")
            ))?;
        }
        for block in bias.blocks.iter().take(BLOCKS_SHOWN) {
            print_line(&format!(
                "        block at ({}, {}): {}",
                block.x,
                block.y,
                percent(block.bias)
            ))?;
        }
    }
    Ok(())
}

fn bench_paths(
    time: Duration,
    device: &Device,
    scene: &PreparedScene,
    settings: &Settings,
) -> Result<(), CliError> {
    let speed = paths::measure(device, scene, settings, time)?;
    let timings = speed.outcome.timings;
    let share = |part: Duration| 100.0 * part.as_secs_f64() / speed.outcome.elapsed.as_secs_f64();
    print_line(&format!(
        "    {:.3} Mpaths/s, {:.2} Mrays/s, {:.2} rays a path, {} paths, mean {:.6}",
        speed.mpaths_per_second,
        speed.mrays_per_second,
        speed.rays_per_path,
        speed.outcome.paths,
        speed.mean
    ))?;
    print_line(&format!(
        "    tracing {:.1} %, generation {:.2} %, accumulation {:.2} % of {:.2} s",
        share(timings.tracing()),
        share(timings.generation()),
        share(timings.accumulation()),
        speed.outcome.elapsed.as_secs_f64()
    ))?;
    Ok(())
}
