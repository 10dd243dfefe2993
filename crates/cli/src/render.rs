//! `raystream render`

use super::checkpoints::CheckpointArguments;
use super::choices::choice;
use super::effects::{Facts, Given};
use super::ending::{CliError, Ending};
use super::frames::{self, Frames};
use super::hints::with_hint;
use super::interrupt;
use super::job::Job;
use super::options::{DeviceArguments, DisplayArguments, SettingsArguments, parse_seconds};
use super::output::{self, is_png, is_same_file};
use super::processes::Processes;
use super::sampling::SamplingArguments;
use super::tev::Audience;
use clap::Args;
use raystream::exec::Executor;
use raystream::exec::device::Device;
use raystream::film::Film;
use raystream::film_file::{Command, FilmFile};
use raystream::image;
use raystream::render::estimator::EstimateBuffers;
use raystream::render::{FilterKind, Settings};
use raystream::scene::{DEFAULT_SCENE, FilmSize, Scene};
use raystream_figures::tev::{DEFAULT_ADDRESS, Tev, parse_address};
use raystream_figures::{FigureError, png_layer_paths, write_png_layers};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// The options of `raystream render`.
#[derive(Args)]
pub struct RenderArguments {
    /// A scene file, a glTF (.gltf, .glb), an OBJ, a PLY, the name of a scene that ships (see
    /// `raystream scenes`), or - for a scene on standard input, whose paths start from the working
    /// folder.
    #[arg(default_value = DEFAULT_SCENE)]
    pub(crate) scene: PathBuf,
    /// Where to write the picture; .exr for all layers in full precision, .png for a look. May be
    /// given several times [default: the scene's name with .png].
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Vec<PathBuf>,
    /// Samples per pixel on average over the pixels [default: 64, or as many as --time or --noise
    /// take].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=MAX_SAMPLES))]
    pub(crate) spp: Option<u32>,
    /// Stop after this time; what comes first of this, --spp and --noise counts.
    #[arg(long, value_name = "SECONDS", value_parser = parse_seconds)]
    pub(crate) time: Option<Duration>,
    #[command(flatten)]
    sampling: SamplingArguments,
    #[command(flatten)]
    pub(crate) settings: SettingsArguments,
    #[command(flatten)]
    pub(crate) device: DeviceArguments,
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
    /// Send the picture to the viewer tev while it renders, and in the end, where tev listens there
    /// [with no value: 127.0.0.1:14158].
    #[arg(
        long,
        value_name = "HOST:PORT",
        num_args = 0..=1,
        default_missing_value = DEFAULT_ADDRESS,
        value_parser = parse_address
    )]
    tev: Option<String>,
    /// Say nothing but warnings and errors.
    #[arg(short, long)]
    pub(crate) quiet: bool,
    #[command(flatten)]
    pub(crate) checkpoints: CheckpointArguments,
    /// Render these frames one after the other: 1-240, or every tenth, 1-240x10. The number of a
    /// frame takes the place of #### in the names of the scene, the pictures and the film file, and
    /// is added to the seed.
    #[arg(long, value_name = "FRAMES")]
    frames: Option<Frames>,
    /// Frames of a second: show a glTF at the time of each frame in its first animation, frame 0 at
    /// its start.
    #[arg(
        long,
        value_name = "N",
        requires = "frames",
        conflicts_with = "at",
        value_parser = frames::parse_rate
    )]
    pub(crate) fps: Option<f64>,
    /// The frame that is being rendered.
    #[arg(skip)]
    pub(crate) frame: Option<u32>,
    /// How to call the render again, where that is not the command line of this process.
    #[arg(skip)]
    pub(crate) called: Option<Command>,
}

/// Samples per pixel go up to this: beyond, sample counts in an f32 are not exact.
pub const MAX_SAMPLES: i64 = 1 << 24;
/// Characters of the default file name; 4 bytes each at most, and file names have up to 255.
const MAX_STEM: usize = 60;
/// Samples per pixel where nothing is asked for.
pub const DEFAULT_SAMPLES: u32 = 64;

/// A render that goes on from a film file.
pub struct Resumed {
    /// How it goes on.
    pub command: Command,
    /// Where it is.
    pub film: FilmFile,
}

/// Renders a scene, or each frame of one, and writes the pictures.
pub fn run(
    mut arguments: RenderArguments,
    given: &Given,
    processes: &dyn Processes,
) -> Result<Ending, CliError> {
    let Some(frames) = arguments.frames.take() else {
        return go_on(&arguments, given, None, processes);
    };
    arguments.check_frames()?;
    let seed = arguments.settings.seed();
    let patterns: Vec<PathBuf> = arguments.paths().map(|path| path.clone()).collect();
    for frame in frames.numbers() {
        for (path, pattern) in arguments.paths().zip(&patterns) {
            *path = frames::fill_path(pattern, frame);
        }
        arguments.settings.set_seed(seed.wrapping_add(frame));
        arguments.settings.show_at(arguments.fps.map(|rate| frames::time(frame, rate)));
        arguments.frame = Some(frame);
        arguments.say(&format!("frame {frame}"));
        if let Ending::Interrupted = go_on(&arguments, given, None, processes)
            .map_err(|error| format!("frame {frame}: {}", with_hint(error.as_ref())))?
        {
            return Ok(Ending::Interrupted);
        }
    }
    Ok(Ending::Done)
}

/// The same, from where a render was left if there is one.
pub fn go_on(
    arguments: &RenderArguments,
    given: &Given,
    from: Option<&Resumed>,
    processes: &dyn Processes,
) -> Result<Ending, CliError> {
    interrupt::begin_render();
    if arguments.checkpoints.checkpoint.is_some() && arguments.scene == Path::new("-") {
        return Err(
            "--checkpoint: a scene on standard input is gone when the render goes on; put \
                    it into a file"
                .into(),
        );
    }
    let scene = arguments.settings.load_scene(&arguments.scene, arguments.quiet)?;
    let outputs = arguments.outputs(&scene.name);
    if !processes.is_helper() {
        arguments.check_files(&outputs)?;
    }
    let address = arguments.tev.as_ref().filter(|_| from.is_none() && !processes.is_helper());
    let tev = address.map(|address| Tev::connect(address, &scene.name)).transpose()?;
    let (device, others) = arguments.device.open_all()?;
    let mut settings = arguments.all_settings(&scene);
    let writes_png = outputs.iter().any(|path| is_png(path));
    given.warn(&Facts { writes_png, ..Facts::of_render(&settings, &scene, &device) });
    let (triangles, FilmSize { width, height }) = (scene.triangle_count(), settings.size);
    let on = description(&device, &others);
    arguments
        .say(&format!("{}: {triangles} triangles, {width}x{height} pixels, on {on}", scene.name));
    let name = scene.name.clone();
    let prepared = arguments.settings.prepare(scene, arguments.quiet)?;
    if let Some(what) = arguments.fall_back_on_large_films(&device, &mut settings) {
        output::say(&format!("warning: {what}"));
    }
    let kinds = kinds(&device, &others);
    let (prepared, device, others) = (&prepared, &device, others.as_slice());
    let mut job = Job { arguments, from, device, others, on, kinds, prepared, settings, name };
    if processes.is_helper() {
        processes.serve(&job.identity(), job.workers()?)?;
        return Ok(Ending::Done);
    }
    let helpers = processes.workers(&job.identity())?;
    job.name_helpers(&helpers);
    let mut audience = Audience::new(tev);
    let rendered = job.render(helpers, &mut audience)?;
    audience.see_the_end(&rendered.film);
    job.write(&outputs, rendered)
}

/// What to call devices that render together: of one kind, they make the film of one of them.
fn description(device: &Device, others: &[Device]) -> String {
    let all = std::iter::once(device).chain(others);
    let mut names: Vec<String> = all.map(Device::description).collect();
    names.dedup();
    names.join(", ")
}

/// What kinds of devices there are.
pub fn kinds(device: &Device, others: &[Device]) -> BTreeSet<String> {
    std::iter::once(device).chain(others).map(|device| device.name().to_owned()).collect()
}

impl RenderArguments {
    /// Says a line, unless nothing but warnings and errors is wanted.
    pub fn say(&self, line: &str) {
        if !self.quiet {
            output::say(line);
        }
    }

    /// The names that the number of a frame may be in.
    fn paths(&mut self) -> impl Iterator<Item = &mut PathBuf> {
        let others = self.output.iter_mut().chain(&mut self.checkpoints.checkpoint);
        std::iter::once(&mut self.scene).chain(others)
    }

    /// Fails where frames would overwrite each other.
    fn check_frames(&self) -> Result<(), CliError> {
        if self.output.is_empty() {
            return Err(
                "--frames: name the pictures with a place for the number of the frame, such \
                        as -o picture.####.exr"
                    .into(),
            );
        }
        let mut written = self.output.iter().chain(&self.checkpoints.checkpoint);
        match written.find(|path| !frames::has_place(path)) {
            Some(path) => Err(format!(
                "{}: every frame would be written there; --frames wants a place for its number, \
                 such as ####, in the name",
                path.display()
            )
            .into()),
            None => Ok(()),
        }
    }

    /// Fails where a file that is to be written could not be.
    fn check_files(&self, outputs: &[PathBuf]) -> Result<(), CliError> {
        output::check_outputs(outputs, None)?;
        if self.png_layers {
            check_layers(outputs)?;
        }
        let Some(film) = &self.checkpoints.checkpoint else { return Ok(()) };
        FilmFile::check_writable(film)?;
        match outputs.iter().find(|path| is_same_file(path, film)) {
            Some(path) => Err(format!(
                "{}: would be written as picture and as --checkpoint; name another file",
                path.display()
            )
            .into()),
            None => Ok(()),
        }
    }

    /// Where the pictures go.
    fn outputs(&self, scene: &str) -> Vec<PathBuf> {
        if self.output.is_empty() {
            vec![PathBuf::from(format!("{}.png", file_stem(scene)))]
        } else {
            self.output.clone()
        }
    }

    /// What is rendered of `scene`, and how.
    pub fn all_settings(&self, scene: &Scene) -> Settings {
        Settings {
            sampling: self.sampling.sampling(),
            denoise: self.denoise,
            ..self.settings.settings(scene)
        }
    }

    /// Samples uniformly where errors cannot be estimated and nobody asked for it; then says why.
    pub fn fall_back_on_large_films(
        &self,
        device: &Device,
        settings: &mut Settings,
    ) -> Option<String> {
        let sampling = self.sampling.fallback()?;
        let error = EstimateBuffers::check(device, settings.size).err()?;
        settings.sampling = sampling;
        let why = with_hint(&error);
        Some(format!("{why}; sampling every pixel equally instead (--allocator uniform)"))
    }

    /// Writes the pictures, and the layers beside them.
    pub fn write(
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
