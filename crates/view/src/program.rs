//! The program: its options, and how it ends.

use crate::choices::{Choices, Stops};
use crate::desk::{Desk, Order};
use crate::layers::Layer;
use crate::measure::measure;
use crate::stage::SceneChoice;
use crate::thread::RenderThread;
use crate::viewer::Viewer;
use crate::watch::Watch;
use crate::window::{Screenshot, Window};
use clap::Parser;
use eframe::egui;
use raystream::image::{Display, ToneMap};
use raystream::render::{AllocatorKind, Estimator, FilterKind, IntegratorKind};
use raystream::scene::{DEFAULT_SCENE, FilmSize};
use raystream_figures::tev::{DEFAULT_ADDRESS, Tev, parse_address};
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::{Arc, PoisonError};
use std::time::Duration;

/// Look at a render while it runs: layers, errors, pixels, two methods side by side.
#[derive(Clone, Debug, Parser)]
#[command(name = "raystream-view", version, max_term_width = 100)]
pub struct Arguments {
    /// A scene file, a glTF, an OBJ or a PLY, or the name of a scene that ships.
    #[arg(default_value = DEFAULT_SCENE)]
    pub scene: PathBuf,
    /// Where to render: auto (the best GPU, else the CPU), cpu, gpu, or a part of a device's name.
    #[arg(long, default_value = "auto")]
    pub device: String,
    /// Picture size in pixels [default: the scene's].
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    pub size: Option<FilmSize>,
    /// See the scene through this camera of its glTF, by its name.
    #[arg(long, value_name = "NAME")]
    pub camera: Option<String>,
    /// Light the scene by a clear sky, whose sun stands so many degrees over the horizon.
    #[arg(long, value_name = "DEGREES", value_parser = parse_elevation)]
    pub sky: Option<f32>,
    /// Who decides which pixels get how many samples.
    #[arg(long, default_value_t)]
    pub allocator: AllocatorKind,
    /// What the error of a pixel is taken to be.
    #[arg(long, default_value_t)]
    pub estimator: Estimator,
    /// Have errors be relative to the brightness of their pixel.
    #[arg(long)]
    pub relative: bool,
    /// How to compute a path's contribution.
    #[arg(long, default_value_t)]
    pub integrator: IntegratorKind,
    /// Take the noise out of the picture, by this filter [with no value: auto].
    #[arg(long, value_name = "FILTER", num_args = 0..=1, default_missing_value = "auto")]
    pub denoise: Option<FilterKind>,
    /// Renders with different seeds are independent of each other.
    #[arg(long, default_value_t = 0)]
    pub seed: u32,
    /// Render a second time beside it, with every pixel sampled alike, at equal time.
    #[arg(long)]
    pub compare: bool,
    /// What is shown at first: beauty, denoised, samples, error, albedo, normal or depth.
    #[arg(long, default_value = "beauty", value_parser = parse_layer)]
    pub layer: Layer,
    /// Keep this pixel in the inspector, with the path of one of its samples.
    #[arg(long, value_name = "X,Y", value_parser = parse_pixel)]
    pub pixel: Option<[u32; 2]>,
    /// Brightness in stops: +1 doubles.
    #[arg(long, default_value_t = 0.0, value_name = "STOPS", allow_negative_numbers = true,
        value_parser = parse_exposure)]
    pub exposure: f32,
    /// How what is brighter than white is shown: soft, clip or aces.
    #[arg(long, default_value_t)]
    pub tone_map: ToneMap,
    /// Stop at so many samples per pixel.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub spp: Option<u32>,
    /// Stop after so many seconds of rendering.
    #[arg(long, value_name = "SECONDS", value_parser = parse_seconds)]
    pub time: Option<Duration>,
    /// Stop at this relative error of the picture, 0.02 for 2 %.
    #[arg(long, value_name = "ERROR", value_parser = parse_noise)]
    pub noise: Option<f32>,
    /// Load the scene and render it again when one of its files changes.
    #[arg(long)]
    pub watch: bool,
    /// Send the picture to tev, which listens there [with no value: 127.0.0.1:14158].
    #[arg(long, value_name = "HOST:PORT", num_args = 0..=1,
        default_missing_value = DEFAULT_ADDRESS, value_parser = parse_address)]
    pub tev: Option<String>,
    /// Size of the window in points.
    #[arg(long, value_name = "WxH", default_value = "1280x800", value_parser = parse_size)]
    pub window: FilmSize,
    /// Write a picture of the window to this PNG, and close it.
    #[arg(long, value_name = "FILE")]
    pub screenshot: Option<PathBuf>,
    /// Take the screenshot so many seconds after the first picture.
    #[arg(long, value_name = "SECONDS", default_value = "2", requires = "screenshot",
        value_parser = parse_seconds)]
    pub after: Duration,
    /// Open no window: move the camera for so many seconds, let it rest for as long, and print how
    /// long frames take.
    #[arg(long, value_name = "SECONDS", value_parser = parse_seconds)]
    pub measure: Option<Duration>,
}

impl Arguments {
    /// Which scene is meant.
    pub fn scene(&self) -> SceneChoice {
        SceneChoice {
            name: self.scene.clone(),
            camera: self.camera.clone(),
            sky: self.sky,
            size: self.size,
        }
    }

    /// What is rendered at first.
    pub fn order(&self) -> Order {
        let choices = Choices {
            allocator: self.allocator,
            estimator: self.estimator,
            relative: self.relative,
            filter: self.denoise,
            integrator: self.integrator,
            seed: self.seed,
        };
        let stops = Stops { samples: self.spp, time: self.time, noise: self.noise };
        Order { sides: vec![choices], stops, ..Order::new(&self.device) }
    }

    /// A viewer that follows what it is told at `desk`.
    pub fn viewer(&self, desk: Arc<Desk>) -> Viewer {
        let mut viewer = Viewer::new(desk, self.scene(), self.order());
        viewer.compare(self.compare);
        viewer.show(self.layer);
        viewer.pinned = self.pixel;
        viewer.set_display(Display { exposure: self.exposure, tone_map: self.tone_map });
        viewer
    }

    /// Has a viewer watch files and show pictures elsewhere, as was asked for; `wake` is called when
    /// a file has changed.
    ///
    /// # Errors
    /// If files cannot be watched, or tev does not listen.
    pub fn connect(
        &self,
        viewer: &mut Viewer,
        wake: impl Fn() + Send + 'static,
    ) -> Result<(), String> {
        if self.watch {
            let watch = Watch::new(wake);
            viewer.watch = Some(watch.map_err(|error| format!("cannot watch files: {error}"))?);
        }
        if let Some(address) = &self.tev {
            let name = self.scene.display().to_string();
            viewer.tev = Some(Tev::connect(address, &name).map_err(|error| error.to_string())?);
        }
        Ok(())
    }
}

/// Exit status of a run that failed.
const FAILED: u8 = 2;

/// The program `raystream-view`.
pub fn main() -> ExitCode {
    let arguments = Arguments::parse();
    match run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            // Where nobody reads errors any more, there is nobody to tell.
            use std::io::Write;
            let _ = writeln!(std::io::stderr(), "error: {message}");
            ExitCode::from(FAILED)
        }
    }
}

/// Opens the window, and returns when it has closed; or measures.
fn run(arguments: &Arguments) -> Result<(), String> {
    if let Some(time) = arguments.measure {
        use std::io::Write;
        let report = measure(arguments, time)?.report();
        // Where nobody reads it any more, there is nobody to tell.
        let _ = writeln!(std::io::stdout(), "{report}");
        return Ok(());
    }
    open(arguments)
}

/// Opens the window, and returns when it has closed.
fn open(arguments: &Arguments) -> Result<(), String> {
    let (screenshot, outcome) =
        arguments.screenshot.clone().map(|path| Screenshot::new(path, arguments.after)).unzip();
    let size = [arguments.window.width as f32, arguments.window.height as f32];
    let title = format!("{} - Raystream", arguments.scene.display());
    let options = eframe::NativeOptions {
        viewport: egui::ViewportBuilder::default().with_inner_size(size).with_title(title),
        renderer: eframe::Renderer::Wgpu,
        ..eframe::NativeOptions::default()
    };
    let opened = eframe::run_native(
        "raystream-view",
        options,
        Box::new(|creation| {
            let ctx = creation.egui_ctx.clone();
            let on_change = ctx.clone();
            let desk = Arc::new(Desk::new(move || ctx.request_repaint()));
            let thread = RenderThread::start(Arc::clone(&desk), arguments.scene())?;
            let mut viewer = arguments.viewer(desk);
            arguments.connect(&mut viewer, move || on_change.request_repaint())?;
            let window = Window::new(viewer, screenshot);
            Ok(Box::new(window.with_thread(thread)))
        }),
    );
    opened.map_err(|error| {
        format!(
            "the window cannot be opened: {error}. It needs a screen (X11 or Wayland, Windows, \
             macOS) and Vulkan, Metal or DirectX 12; `raystream render` needs no screen"
        )
    })?;
    match outcome {
        None => Ok(()),
        Some(outcome) => {
            let outcome = outcome.lock().unwrap_or_else(PoisonError::into_inner).take();
            outcome.unwrap_or_else(|| Err("the window closed before its screenshot".to_owned()))
        }
    }
}

fn parse_size(text: &str) -> Result<FilmSize, String> {
    let sides = text.split_once(['x', 'X']);
    let number = |side: &str| side.trim().parse::<i64>().ok();
    match sides.and_then(|(width, height)| Some((number(width)?, number(height)?))) {
        Some((width, height)) => FilmSize::new(width, height),
        None => Err(format!("'{text}' is not a size such as 800x600")),
    }
}

fn parse_pixel(text: &str) -> Result<[u32; 2], String> {
    let sides = text.split_once(',').map(|(x, y)| [x, y].map(|side| side.trim().parse().ok()));
    match sides {
        Some([Some(x), Some(y)]) => Ok([x, y]),
        _ => {
            Err(format!("'{text}' is not a pixel such as 12,34, counted from 0,0 at the top left"))
        }
    }
}

fn parse_layer(text: &str) -> Result<Layer, String> {
    let known = || Layer::ALL.map(|layer| layer.name().to_lowercase()).join(", ");
    Layer::named(text).ok_or_else(|| format!("there is no '{text}'; there are: {}", known()))
}

fn parse_elevation(text: &str) -> Result<f32, String> {
    within(text, 0.0..=90.0).ok_or(format!("'{text}' is not an angle in degrees, from 0 to 90"))
}

fn parse_exposure(text: &str) -> Result<f32, String> {
    within(text, -100.0..=100.0).ok_or(format!("'{text}' is not a number of stops, as -1.5"))
}

fn parse_noise(text: &str) -> Result<f32, String> {
    within(text, 1e-6..=1e3).ok_or(format!("'{text}' is not a relative error, such as 0.02"))
}

fn parse_seconds(text: &str) -> Result<Duration, String> {
    let seconds = text.parse::<f64>().ok().filter(|seconds| (0.0..=1e9).contains(seconds));
    let time = seconds.and_then(|seconds| Duration::try_from_secs_f64(seconds).ok());
    time.ok_or_else(|| format!("'{text}' is not a time in seconds, such as 1.5"))
}

fn within(text: &str, range: std::ops::RangeInclusive<f32>) -> Option<f32> {
    text.parse::<f32>().ok().filter(|number| range.contains(number))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(words: &[&str]) -> Result<Arguments, String> {
        let words = ["raystream-view"].iter().chain(words);
        Arguments::try_parse_from(words).map_err(|error| error.to_string())
    }

    #[test]
    fn without_options_there_is_the_default_scene() {
        let arguments = parse(&[]).unwrap();
        assert_eq!(
            arguments.scene(),
            SceneChoice { name: "cornell_ball".into(), ..Default::default() }
        );
        assert_eq!(arguments.order(), Order::new("auto"));
    }

    #[test]
    fn options_are_what_is_rendered() {
        let arguments = parse(&[
            "a.json",
            "--device",
            "cpu",
            "--size",
            "80x60",
            "--allocator",
            "paper",
            "--estimator",
            "halves",
            "--relative",
            "--integrator",
            "lvc",
            "--denoise",
            "nlm",
            "--seed",
            "3",
            "--spp",
            "9",
            "--time",
            "1.5",
            "--noise",
            "0.1",
            "--compare",
            "--layer",
            "Error",
            "--pixel",
            "7,8",
        ])
        .unwrap();
        let order = arguments.order();
        assert_eq!(order.device, "cpu");
        assert_eq!(order.stops.time, Some(Duration::from_millis(1500)));
        assert_eq!((order.stops.samples, order.stops.noise), (Some(9), Some(0.1)));
        let choices = order.sides[0];
        assert_eq!((choices.allocator, choices.seed), (AllocatorKind::Paper, 3));
        assert_eq!(choices.filter, Some(FilterKind::Nlm));
        let viewer = arguments.viewer(Arc::new(Desk::new(|| ())));
        assert!(viewer.compares());
        assert_eq!((viewer.layer(), viewer.pinned), (Layer::Error, Some([7, 8])));
        assert_eq!(parse(&["--denoise"]).unwrap().denoise, Some(FilterKind::Auto));
    }

    #[test]
    fn tev_that_does_not_listen_is_named() {
        let arguments = parse(&["--tev", "127.0.0.1:1", "--watch"]).unwrap();
        let mut viewer = arguments.viewer(Arc::new(Desk::new(|| ())));
        let error = arguments.connect(&mut viewer, || ()).unwrap_err();
        assert!(error.contains("127.0.0.1:1"), "{error}");
        assert!(viewer.watch.is_some());
        assert_eq!(parse(&["--tev"]).unwrap().tev.as_deref(), Some(DEFAULT_ADDRESS));
    }

    #[test]
    fn bad_options_are_named() {
        for (words, what) in [
            (&["--size", "80"][..], "80x60"),
            (&["--size", "0x9"], "width"),
            (&["--layer", "none"], "beauty"),
            (&["--allocator", "none"], "uniform"),
            (&["--noise", "0"], "relative error"),
            (&["--noise", "nan"], "relative error"),
            (&["--time=-1"], "seconds"),
            (&["--sky", "91"], "degrees"),
            (&["--exposure", "inf"], "stops"),
            (&["--spp", "0"], "0"),
            (&["--pixel", "12"], "12,34"),
            (&["--pixel", "12,-3"], "12,34"),
            (&["--after", "1"], "--screenshot"),
        ] {
            let error = parse(words).unwrap_err();
            assert!(error.contains(what) || error.contains("800x600"), "{words:?}: {error}");
        }
    }
}
