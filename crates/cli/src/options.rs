//! Options that several commands share, and how their values are read.

use super::choices::choice;
use super::loading::LoadArguments;
use super::output::say;
use super::progress::Waiting;
use clap::builder::NonEmptyStringValueParser;
use clap::{Args, ValueEnum};
use raystream::exec::ExecError;
use raystream::exec::device::Device;
use raystream::exec::devices::OpenOptions;
use raystream::image::{Display, ToneMap};
use raystream::render::{
    BidirectionalTechniques, BvhQuality, IntegratorKind, LightCacheSettings, PixelFilter,
    PixelFilterShape, PreparedScene, RenderError, Sampling, Settings,
};
use raystream::scene::{FilmSize, Scene, SceneError};
use raystream_shaders::integrator::lvc::MAX_CONNECTIONS;
use raystream_shaders::scene::ray::OFFSET_ROUNDINGS;
use std::path::Path;
use std::time::{Duration, Instant};

/// The options that choose a device.
#[derive(Args)]
pub struct DeviceArguments {
    /// Where to render: auto (the best GPU, else the CPU), cpu, gpu, or a part of a device's name;
    /// gpu:2 or NAME:2 is the second that fits. cpu:avx512, cpu:avx2, cpu:simd128 and cpu:scalar
    /// trace rays by these instructions, to the same bits [cpu: the best]. A render takes several,
    /// with commas between them, or all (every GPU).
    #[arg(
        long,
        default_value = "auto",
        value_name = "DEVICE",
        value_parser = NonEmptyStringValueParser::new()
    )]
    device: String,
    #[command(flatten)]
    open: OpenArguments,
}

/// The options that say how devices are opened.
#[derive(Args)]
pub struct OpenArguments {
    /// Have naga translate the kernels, also where the driver takes SPIR-V.
    #[arg(long)]
    naga: bool,
    /// Have GPUs compute what the CPU does, bit for bit: nothing is fused, and quotients, roots and
    /// other functions are the project's own. It takes them longer.
    #[arg(long)]
    exact: bool,
    /// Run under the driver's validation layers, where they are installed (-vv says), and print
    /// their messages.
    #[arg(long)]
    validation: bool,
}

impl OpenArguments {
    /// What was asked for.
    pub fn options(&self) -> OpenOptions {
        OpenOptions::default()
            .with_naga(self.naga)
            .with_exact(self.exact)
            .with_validation(self.validation)
    }
}

impl DeviceArguments {
    /// All that they say.
    pub fn in_words(&self) -> String {
        format!("{} {:?}", self.device, self.open.options())
    }

    /// Opens the device that was asked for.
    pub fn open(&self) -> Result<Device, ExecError> {
        Device::open_with(&self.device, self.open.options())
    }

    /// Opens the devices that were asked for: the first, which has the film, and the others.
    pub fn open_all(&self) -> Result<(Device, Vec<Device>), ExecError> {
        Device::open_all(&self.device, self.open.options())
    }
}

/// The options that say how a PNG shows a picture.
#[derive(Args)]
pub struct DisplayArguments {
    /// Brightness of a PNG in stops: +1 doubles.
    #[arg(
        long,
        default_value_t = 0.0,
        value_name = "STOPS",
        allow_negative_numbers = true,
        value_parser = parse_exposure
    )]
    exposure: f32,
    /// How a PNG shows what is brighter than its white.
    #[arg(long, value_parser = choice::<ToneMap>(), default_value_t)]
    tone_map: ToneMap,
}

impl DisplayArguments {
    /// What was asked for.
    pub fn display(&self) -> Display {
        Display { exposure: self.exposure, tone_map: self.tone_map }
    }
}

/// The options that say what is computed.
#[derive(Args)]
pub struct SettingsArguments {
    /// Picture size in pixels [default: the scene's].
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    size: Option<FilmSize>,
    /// Renders with different seeds, from 0 to 4294967295, are independent of each other.
    #[arg(long, default_value_t = 0)]
    seed: u32,
    /// Where random numbers come from.
    #[arg(long, value_enum, default_value_t = Sampler::Sobol)]
    sampler: Sampler,
    /// Longest path in segments: 1 sees only what emits, 2 direct light as well [default: the
    /// scene's].
    #[arg(long, value_name = "D", value_parser = clap::value_parser!(u32).range(1..))]
    max_depth: Option<u32>,
    /// Segment after which Russian roulette may end any path, not dim ones alone; above the longest
    /// path's for no roulette [default: the scene's].
    #[arg(long, value_name = "R", value_parser = clap::value_parser!(u32).range(1..))]
    rr_depth: Option<u32>,
    /// How to compute a path's contribution.
    #[arg(long, value_parser = choice::<IntegratorKind>(), default_value_t)]
    integrator: IntegratorKind,
    /// Light paths of each round of the integrator lvc [default: by a pilot run, as many as leave
    /// about four vertices for each pixel (one with --no-light-tracing), up to 2^20 vertices].
    #[arg(
        long,
        value_name = "N",
        value_parser = clap::value_parser!(u32).range(1..=MAX_LIGHT_PATHS)
    )]
    light_paths: Option<u32>,
    /// Connections of each vertex of an eye path to light vertices, in the integrator lvc [default:
    /// by a pilot run, as many as a light path has vertices, 1 or 2].
    #[arg(
        long,
        value_name = "M",
        value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_CONNECTIONS))
    )]
    connections: Option<u32>,
    /// Leave out light tracing in the integrator lvc: light vertices do not connect to the camera,
    /// and caustics are left to paths from there.
    #[arg(long)]
    no_light_tracing: bool,
    /// How light that falls beside a pixel's centre counts: box is the pixel itself, the others are
    /// smoother.
    #[arg(long, value_parser = choice::<PixelFilterShape>(), default_value_t)]
    pixel_filter: PixelFilterShape,
    /// Width of the pixel filter in pixels, from side to side [default: 1 for box, 2 for tent, 3
    /// for gaussian and blackman-harris].
    #[arg(long, value_name = "PIXELS", value_parser = parse_filter_width)]
    pixel_filter_width: Option<f32>,
    /// How far rays start from surfaces, in roundings (2^-24) of the largest coordinate there.
    /// Details smaller than that cast no shadow; other renderers take some 1500.
    #[arg(
        long,
        default_value_t = OFFSET_ROUNDINGS,
        value_name = "N",
        value_parser = parse_ray_offset
    )]
    ray_offset: f32,
    /// How carefully to build the acceleration structure: fast suits previews of large scenes.
    #[arg(long, value_parser = choice::<BvhQuality>(), default_value_t)]
    bvh: BvhQuality,
    #[command(flatten)]
    load: LoadArguments,
}

/// Light paths of a round, at most: as many as a stream has slots.
const MAX_LIGHT_PATHS: i64 = 1 << 22;

/// Where random numbers come from.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum Sampler {
    /// Owen-scrambled Sobol points.
    Sobol,
    /// Independent random numbers.
    Independent,
}

impl SettingsArguments {
    /// The seed.
    pub fn seed(&self) -> u32 {
        self.seed
    }

    /// Shows a glTF at a time of its animation, if one is given.
    pub fn show_at(&mut self, time: Option<Duration>) {
        self.load.at = time.or(self.load.at);
    }

    /// Makes it another one.
    pub fn set_seed(&mut self, seed: u32) {
        self.seed = seed;
    }

    /// The integrator.
    pub fn integrator(&self) -> IntegratorKind {
        self.integrator
    }

    /// How the hierarchy is built.
    pub fn bvh(&self) -> BvhQuality {
        self.bvh
    }

    /// How scenes are loaded.
    pub fn loading(&mut self) -> &mut LoadArguments {
        &mut self.load
    }

    /// Loads a scene without a word; see [`LoadArguments::load_silently`].
    pub fn load_silently(&self, name: &Path) -> Result<Scene, SceneError> {
        self.load.load_silently(name, true)
    }

    /// Loads a scene; see [`LoadArguments::load_scene`].
    pub fn load_scene(&self, name: &Path, quiet: bool) -> Result<Scene, SceneError> {
        self.load.load_scene(name, quiet)
    }

    /// The settings for `scene`.
    pub fn settings(&self, scene: &Scene) -> Settings {
        let own = Settings::for_scene(scene);
        Settings {
            size: self.size.unwrap_or(own.size),
            seed: self.seed,
            independent_sampler: matches!(self.sampler, Sampler::Independent),
            max_depth: self.max_depth.unwrap_or(own.max_depth),
            roulette_depth: self.rr_depth.unwrap_or(own.roulette_depth),
            pixel_filter: PixelFilter {
                shape: self.pixel_filter,
                width: self.pixel_filter_width.unwrap_or(self.pixel_filter.usual_width()),
            },
            ray_offset: self.ray_offset,
            sampling: Sampling::UNIFORM,
            integrator: self.integrator,
            light_cache: LightCacheSettings {
                light_paths: self.light_paths,
                connections: self.connections,
                techniques: if self.no_light_tracing {
                    BidirectionalTechniques::WithoutLightTracing
                } else {
                    BidirectionalTechniques::All
                },
            },
            ..own
        }
    }

    /// Builds the scene's BVH and lights. Prints what is left out and, unless `quiet`, that it
    /// takes long.
    pub fn prepare(&self, scene: Scene, quiet: bool) -> Result<PreparedScene, RenderError> {
        let what = format!("building the hierarchy of {} triangles", scene.triangle_count());
        let started = Instant::now();
        let waiting = Waiting::start(quiet, what);
        let prepared = PreparedScene::new(&scene, self.bvh)?;
        drop(waiting);
        tracing::debug!("built the hierarchy in {:.2} s", started.elapsed().as_secs_f64());
        for warning in prepared.warnings() {
            say(&format!("warning: {}: {warning}", scene.name));
        }
        Ok(prepared)
    }

    /// The settings as pairs of name and value, for a picture's header.
    pub fn describe(&self, settings: &Settings) -> Vec<(String, String)> {
        let pair = |name: &str, value: String| (name.to_owned(), value);
        let mut pairs = vec![
            pair("seed", settings.seed.to_string()),
            pair("sampler", format!("{:?}", self.sampler).to_lowercase()),
            pair("max_depth", settings.max_depth.to_string()),
            pair("rr_depth", settings.roulette_depth.to_string()),
            pair("ray_offset", settings.ray_offset.to_string()),
            pair("pixel_filter", settings.pixel_filter.shape.to_string()),
            pair("pixel_filter_width", settings.pixel_filter.width.to_string()),
            pair("integrator", self.integrator.to_string()),
        ];
        if settings.integrator == IntegratorKind::Lvc {
            let number =
                |name, number: Option<u32>| number.map(|number| pair(name, number.to_string()));
            pairs.extend(number("light_paths", settings.light_cache.light_paths));
            pairs.extend(number("connections", settings.light_cache.connections));
            if self.no_light_tracing {
                pairs.push(pair("light_tracing", "off".to_owned()));
            }
        }
        pairs
    }
}

/// A size as `800x600`.
pub fn parse_size(text: &str) -> Result<FilmSize, String> {
    let wrong = || format!("'{text}' is not WIDTHxHEIGHT in pixels, such as 800x600");
    let (width, height) = text.split_once(['x', 'X']).ok_or_else(wrong)?;
    let width = width.parse().map_err(|_| wrong())?;
    let height = height.parse().map_err(|_| wrong())?;
    FilmSize::new(width, height).map_err(|error| format!("'{text}': {error}"))
}

fn parse_filter_width(text: &str) -> Result<f32, String> {
    const LEAST: f32 = 0.01;
    match text.parse::<f32>() {
        Ok(width) if (LEAST..=PixelFilter::MAX_WIDTH).contains(&width) => Ok(width),
        _ => Err(format!(
            "'{text}' is not a width in pixels, from {LEAST} to {}",
            PixelFilter::MAX_WIDTH
        )),
    }
}

fn parse_ray_offset(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(roundings) if (1.0..=1e5).contains(&roundings) => Ok(roundings),
        _ => Err(format!("'{text}' is not a number of roundings between 1 and 100000")),
    }
}

/// A time in seconds, above 0 and at most a year.
pub fn parse_seconds(text: &str) -> Result<Duration, String> {
    match text.parse::<f64>() {
        Ok(seconds) if seconds > 0.0 && seconds <= 3.2e7 => Ok(Duration::from_secs_f64(seconds)),
        _ => Err(format!(
            "'{text}' is not a time in seconds between 0 and a year, such as 30 or 2.5"
        )),
    }
}

fn parse_exposure(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(stops) if stops.abs() <= 100.0 => Ok(stops),
        _ => Err(format!("'{text}' is not a number of stops between -100 and 100")),
    }
}
