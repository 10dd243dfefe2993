//! `raystream render`

use super::choices::choice;
use super::effects::{Facts, Given};
use super::ending::{CliError, Ending};
use super::hints::with_hint;
use super::interrupt;
use super::options::{DeviceArguments, DisplayArguments, SettingsArguments, parse_seconds};
use super::output::{self, is_png, is_same_file, rate};
use super::progress::ProgressDisplay;
use super::sampling::{SamplingArguments, describe};
use clap::Args;
use glam::Vec3;
use raystream::exec::device::Device;
use raystream::film::Film;
use raystream::image;
use raystream::render::estimator::EstimateBuffers;
use raystream::render::{
    Budget, FilterKind, Outcome, PreparedScene, RenderError, Renderer, Settings, Stop,
    run as render,
};
use raystream::scene::{DEFAULT_SCENE, FilmSize};
use raystream_figures::{FigureError, png_layer_paths, write_png_layers};
use std::path::PathBuf;
use std::time::Duration;

/// The options of `raystream render`.
#[derive(Args)]
pub struct RenderArguments {
    /// A scene file, a glTF (.gltf, .glb), a PLY, the name of a scene that ships (see `raystream
    /// scenes`), or - for a scene on standard input, whose paths start from the working folder.
    #[arg(default_value = DEFAULT_SCENE)]
    scene: PathBuf,
    /// Where to write the picture; .exr for all layers in full precision, .png for a look. May be
    /// given several times [default: the scene's name with .png].
    #[arg(short, long, value_name = "FILE")]
    output: Vec<PathBuf>,
    /// Samples per pixel on average over the pixels [default: 64, or as many as --time or --noise
    /// take].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=MAX_SAMPLES))]
    spp: Option<u32>,
    /// Stop after this time; what comes first of this, --spp and --noise counts.
    #[arg(long, value_name = "SECONDS", value_parser = parse_seconds)]
    time: Option<Duration>,
    #[command(flatten)]
    sampling: SamplingArguments,
    #[command(flatten)]
    settings: SettingsArguments,
    #[command(flatten)]
    device: DeviceArguments,
    /// Take noise out of the picture with a filter [default filter: auto]. An EXR has the
    /// result as the layer `denoised` beside everything else, a PNG shows it, and --noise means the
    /// error that is left in it.
    #[arg(
        long,
        value_name = "FILTER",
        num_args = 0..=1,
        default_missing_value = FilterKind::Auto.name(),
        value_parser = choice::<FilterKind>()
    )]
    denoise: Option<FilterKind>,
    #[command(flatten)]
    display: DisplayArguments,
    /// Beside each .png picture, write its layers as pictures too: picture.samples.png (samples per
    /// pixel), picture.error.png (estimated error) and picture.filtered.png, where errors are
    /// estimated, picture.albedo.png, picture.normal.png and picture.depth.png.
    #[arg(long)]
    png_layers: bool,
    /// Say nothing but warnings and errors.
    #[arg(short, long)]
    quiet: bool,
}

/// Samples per pixel go up to this: beyond, sample counts in an f32 are not exact.
const MAX_SAMPLES: i64 = 1 << 24;
/// Characters of the default file name; 4 bytes each at most, and file names have up to 255.
const MAX_STEM: usize = 60;
/// Samples per pixel where nothing is asked for.
const DEFAULT_SAMPLES: u32 = 64;

/// What to say of a picture without any light.
const BLACK: &str = "the picture is black: no path met light that shines towards it. A quad shines \
    on the side of cross(u, v), an emissive material on the front of its triangles; a lamp may be \
    turned away, or behind a wall, or the camera may be enclosed.";

/// Renders a scene and writes the pictures.
pub fn run(arguments: &RenderArguments, given: &Given) -> Result<Ending, CliError> {
    interrupt::begin_render();
    let scene = arguments.settings.load_scene(&arguments.scene, arguments.quiet)?;
    let outputs = arguments.outputs(&scene.name);
    output::check_outputs(&outputs, None)?;
    if arguments.png_layers {
        check_layers(&outputs)?;
    }
    let device = arguments.device.open()?;
    let mut settings = Settings {
        sampling: arguments.sampling.sampling(),
        denoise: arguments.denoise,
        ..arguments.settings.settings(&scene)
    };
    given.warn(&Facts {
        filters: settings.denoise.into_iter().collect(),
        integrators: vec![settings.integrator],
        samplings: vec![settings.sampling],
        projection: Some(scene.camera.projection),
        writes_png: outputs.iter().any(|path| is_png(path)),
        ..Facts::of_device(&device)
    });
    let (triangles, FilmSize { width, height }) = (scene.triangle_count(), settings.size);
    let on = device.description();
    arguments
        .say(&format!("{}: {triangles} triangles, {width}x{height} pixels, on {on}", scene.name));
    let name = scene.name.clone();
    let prepared = arguments.settings.prepare(scene, arguments.quiet)?;

    let budget = arguments.budget(&settings);
    arguments.fall_back_on_large_films(&device, &mut settings);
    let mut display = ProgressDisplay::new(arguments.quiet);
    let (film, outcome) = render_film(&device, &prepared, &settings, budget, &mut display)?;
    arguments.say(&summary(&outcome, &film));
    for line in shortcomings(&outcome, &film, settings.sampling.noise) {
        output::say(&line);
    }
    if outcome.paths > 0 && film.radiance.iter().all(|pixel| pixel.sum() == Vec3::ZERO) {
        output::say(&format!("warning: {BLACK}"));
    }
    if let Some(filter) = settings.denoise {
        arguments.say(&format!("filtered the picture ({filter})"));
    }
    let header = arguments.header(name, &device, &settings, &film, &outcome);
    arguments.write(&outputs, &film, &header)?;
    Ok(if outcome.interrupted() { Ending::Interrupted } else { Ending::Done })
}

impl RenderArguments {
    /// Says a line, unless nothing but warnings and errors is wanted.
    fn say(&self, line: &str) {
        if !self.quiet {
            output::say(line);
        }
    }

    /// What pictures say of the render of the scene `name`: keys and values.
    fn header(
        &self,
        name: String,
        device: &Device,
        settings: &Settings,
        film: &Film,
        outcome: &Outcome,
    ) -> Vec<(String, String)> {
        let mut header = vec![
            ("scene".to_owned(), name),
            ("device".to_owned(), device.description()),
            ("samples".to_owned(), average_samples(outcome, film).to_string()),
            ("seconds".to_owned(), format!("{:.3}", outcome.elapsed.as_secs_f64())),
            ("stop".to_owned(), stop_name(outcome.stop).to_owned()),
            ("version".to_owned(), env!("CARGO_PKG_VERSION").to_owned()),
        ];
        if let Some(noise) = outcome.noise {
            header.push(("estimated_error".to_owned(), noise.relative_error.to_string()));
        }
        header.extend(self.settings.describe(settings));
        header.extend(describe(&settings.sampling));
        header.extend(settings.denoise.map(|filter| ("denoise".to_owned(), filter.to_string())));
        header
    }

    /// Where the pictures go.
    fn outputs(&self, scene: &str) -> Vec<PathBuf> {
        if self.output.is_empty() {
            vec![PathBuf::from(format!("{}.png", file_stem(scene)))]
        } else {
            self.output.clone()
        }
    }

    fn budget(&self, settings: &Settings) -> Budget {
        let has_no_other_end = self.time.is_none() && settings.sampling.noise.is_none();
        Budget {
            samples: self.spp.or_else(|| has_no_other_end.then_some(DEFAULT_SAMPLES)),
            time: self.time,
        }
    }

    /// Samples uniformly where errors cannot be estimated and nobody asked for it.
    fn fall_back_on_large_films(&self, device: &Device, settings: &mut Settings) {
        if let Some(sampling) = self.sampling.fallback()
            && let Err(error) = EstimateBuffers::check(device, settings.size)
        {
            output::say(&format!(
                "warning: {}; sampling every pixel equally instead (--allocator uniform)",
                with_hint(&error)
            ));
            settings.sampling = sampling;
        }
    }

    /// Writes the pictures, and the layers beside them.
    fn write(
        &self,
        outputs: &[PathBuf],
        film: &Film,
        header: &[(String, String)],
    ) -> Result<(), FigureError> {
        let display = self.display.display();
        // Where one cannot be written (a disk is full), the others still save the render.
        let mut written = Ok(());
        for path in outputs {
            let picture = image::write_film_as(path, film, header, &display);
            if picture.is_ok() {
                self.say(&format!("wrote {}", path.display()));
            }
            written = written.and(picture.map_err(FigureError::from));
            if self.png_layers && is_png(path) {
                let layers = write_png_layers(path, film, &display);
                for path in layers.iter().flatten() {
                    self.say(&format!("wrote {}", path.display()));
                }
                written = written.and(layers.map(|_| ()));
            }
        }
        written
    }
}

fn render_film(
    device: &Device,
    scene: &PreparedScene,
    settings: &Settings,
    budget: Budget,
    display: &mut ProgressDisplay,
) -> Result<(Film, Outcome), RenderError> {
    let mut renderer = Renderer::new(device, scene, settings)?;
    let outcome = render(&mut renderer, budget, &interrupt::is_interrupted, &mut |progress| {
        interrupt::has_picture();
        display.show(progress);
    });
    display.finish();
    renderer.finish_features()?;
    Ok((renderer.film()?, outcome?))
}

fn summary(outcome: &Outcome, film: &Film) -> String {
    let seconds = outcome.elapsed.as_secs_f64().max(1e-9);
    let error = outcome.noise.map_or_else(String::new, |noise| {
        format!(", estimated error {:.2} %", 100.0 * noise.relative_error)
    });
    format!(
        "{}{} samples per pixel in {seconds:.2} s: {}samples/s, {}rays/s{error}",
        if outcome.interrupted() { "interrupted after " } else { "" },
        average_samples(outcome, film),
        rate(outcome.paths as f64 / seconds),
        rate(outcome.rays as f64 / seconds)
    )
}

/// What the picture lacks of what was asked for, a sentence each.
fn shortcomings(outcome: &Outcome, film: &Film, wanted: Option<f32>) -> Vec<String> {
    let mut lines = Vec::new();
    let unseen = film.radiance.iter().filter(|pixel| pixel.samples() == 0).count();
    if unseen > 0 {
        lines.push(format!(
            "warning: {unseen} of {} pixels have no sample and are black: the render ended before \
             its first look at them; give it more --time or a smaller --size",
            film.radiance.len()
        ));
    }
    if let (Some(wanted), Some(noise)) = (wanted, outcome.noise)
        && outcome.stop != Stop::Noise
    {
        let first = match outcome.stop {
            Stop::Samples => "--spp came first",
            Stop::Time => "--time came first",
            Stop::Noise | Stop::Interrupted => "it was interrupted",
        };
        lines.push(format!(
            "warning: the error that --noise asks for, {:.2} %, was not reached: {first}; {} of {} \
             pixels are above it",
            100.0 * wanted,
            noise.unconverged,
            film.radiance.len()
        ));
    }
    lines
}

/// What a picture's header calls the end of its render.
fn stop_name(stop: Stop) -> &'static str {
    match stop {
        Stop::Samples => "samples",
        Stop::Time => "time",
        Stop::Noise => "noise",
        Stop::Interrupted => "interrupted",
    }
}

/// Samples per pixel; an average, to two digits after the point.
fn average_samples(outcome: &Outcome, film: &Film) -> f64 {
    (outcome.paths as f64 / film.radiance.len() as f64 * 100.0).round() / 100.0
}

/// As [`output::check_outputs`], of the layers beside the pictures.
fn check_layers(pictures: &[PathBuf]) -> Result<(), CliError> {
    let layers: Vec<PathBuf> = pictures
        .iter()
        .filter(|path| is_png(path))
        .flat_map(|path| png_layer_paths(path, true))
        .collect();
    if layers.is_empty() {
        return Err(
            "--png-layers: no -o names a .png picture to write layers beside; add -o picture.png"
                .into(),
        );
    }
    for (index, path) in layers.iter().enumerate() {
        image::check_writable(path)?;
        if layers[..index].iter().chain(pictures).any(|other| is_same_file(other, path)) {
            return Err(format!(
                "{}: would be written twice, at least once as a layer (--png-layers); give -o \
                 other names",
                path.display()
            )
            .into());
        }
    }
    Ok(())
}

/// A scene's name as a file name, of a length that every file system takes.
pub fn file_stem(name: &str) -> String {
    let stem: String = name
        .chars()
        .take(MAX_STEM)
        .map(|c| if c.is_alphanumeric() || "-_. ".contains(c) { c } else { '_' })
        .collect();
    let stem = stem.trim_matches(['.', ' ']);
    if stem.is_empty() { "picture".into() } else { stem.into() }
}
