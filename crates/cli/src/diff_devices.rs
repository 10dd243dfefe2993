//! `raystream diff-devices`

use super::choices::choice;
use super::effects::{Facts, Given};
use super::ending::{CliError, Ending};
use super::interrupt;
use super::options::{OpenArguments, SettingsArguments};
use super::output::print_line;
use super::render::MAX_SAMPLES;
use super::sampling::SamplingArguments;
use clap::Args;
use clap::builder::NonEmptyStringValueParser;
use raystream::exec::{Device, Executor, Paired};
use raystream::render::{Budget, FilterKind, PreparedScene, RenderError, Renderer, Settings, run};
use raystream::scene::DEFAULT_SCENE;
use std::path::PathBuf;

/// Slots of the longest stream: all of the memory that a kernel may write is compared after each of
/// its launches, and pools of paths are as long as streams.
const STREAM_SLOTS: u32 = 1 << 16;

/// The options of `raystream diff-devices`.
#[derive(Args)]
pub struct DiffDevicesArguments {
    /// The scene, as `raystream render` takes it.
    #[arg(default_value = DEFAULT_SCENE)]
    scene: PathBuf,
    /// The two devices, with a comma between them, as `raystream render` takes them.
    #[arg(
        long,
        default_value = "cpu,gpu",
        value_name = "DEVICES",
        value_parser = NonEmptyStringValueParser::new()
    )]
    device: String,
    #[command(flatten)]
    open: OpenArguments,
    /// Samples per pixel on average over the pixels.
    #[arg(
        long,
        default_value_t = 16,
        value_name = "N",
        value_parser = clap::value_parser!(u32).range(1..=MAX_SAMPLES)
    )]
    spp: u32,
    #[command(flatten)]
    sampling: SamplingArguments,
    #[command(flatten)]
    settings: SettingsArguments,
    /// Compare the kernels of a filter, too, at the end.
    #[arg(long, value_name = "FILTER", value_parser = choice::<FilterKind>())]
    denoise: Option<FilterKind>,
}

/// Renders on two devices at once, and says of each kernel where they part.
pub fn run_command(arguments: &DiffDevicesArguments, given: &Given) -> Result<Ending, CliError> {
    let scene = arguments.settings.load_scene(&arguments.scene, true)?;
    let (first, others) = Device::open_all(&arguments.device, arguments.open.options())?;
    let Ok([second]) = <[Device; 1]>::try_from(others) else {
        return Err(format!(
            "--device {}: name two devices with a comma between them, such as cpu,gpu",
            arguments.device
        )
        .into());
    };
    let settings = Settings {
        sampling: arguments.sampling.sampling(),
        denoise: arguments.denoise,
        stream_slots: Some(STREAM_SLOTS),
        ..arguments.settings.settings(&scene)
    };
    let facts = Facts::of_render(&settings, &scene, &first);
    let on_gpu = facts.on_gpu || Facts::of_device(&second).on_gpu;
    given.warn(&Facts { on_gpu, ..facts });
    let prepared = arguments.settings.prepare(scene, true)?;
    let names = [first.description(), second.description()];
    let pair = Paired::new(first, second);
    let paths = render(&pair, &prepared, &settings, arguments.spp)?;
    let partings = pair.partings();
    for parting in &partings {
        print_line(&parting.to_string())?;
    }
    if !partings.is_empty() {
        return Ok(Ending::Different);
    }
    let ([first, second], launches) = (names, pair.launches());
    print_line(&format!(
        "{first} and {second} are the same, byte for byte, after each of {launches} launches and \
         {paths} paths"
    ))?;
    Ok(Ending::Done)
}

/// Renders, to the last layer of the film, and returns how many paths it took.
fn render(
    executor: &impl Executor,
    scene: &PreparedScene,
    settings: &Settings,
    samples: u32,
) -> Result<u64, RenderError> {
    let mut renderer = Renderer::new(executor, scene, settings)?;
    run(&mut renderer, Budget::samples(samples), &interrupt::is_interrupted, &mut |_| ())?;
    renderer.finish_features()?;
    renderer.film()?;
    Ok(renderer.paths())
}
