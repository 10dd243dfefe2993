//! How commands load scenes.

use super::camera::CameraArguments;
use super::choices::choice;
use super::output::say;
use super::progress::Waiting;
use clap::Args;
use raystream::scene::{Environment, Instancing, LoadOptions, Scene, SceneError, Sky, shipped};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// The options that say how scenes are loaded, what lights them besides and how they are seen.
#[derive(Args)]
pub struct LoadArguments {
    /// Memory in GiB that loading a scene may take, by an estimate; a scene that needs more is
    /// refused. A scene file and each MTL may have 1/128 of it, an OBJ, glTF or PLY a quarter, each
    /// texture an eighth.
    #[arg(long, value_name = "GIB", default_value_t = 8.0, value_parser = parse_memory)]
    max_memory: f64,
    /// See the scene through this camera of its glTF, by its name [default: the first;
    /// `raystream inspect` lists them].
    #[arg(long, value_name = "NAME")]
    camera: Option<String>,
    /// What becomes of shapes that stand in several places.
    #[arg(long, value_parser = choice::<Instancing>(), default_value_t)]
    instances: Instancing,
    /// Show a glTF at this time of its first animation: nodes, skins and morph targets.
    #[arg(long, value_name = "SECONDS", value_parser = parse_time)]
    pub at: Option<Duration>,
    /// Show a glTF in this variant of its materials, by its name [default: those that it has
    /// without one; `raystream inspect` lists them].
    #[arg(long, value_name = "NAME")]
    variant: Option<String>,
    #[command(flatten)]
    environment: EnvironmentArguments,
    #[command(flatten)]
    view: CameraArguments,
}

/// The options that light a scene from all around.
#[derive(Args)]
struct EnvironmentArguments {
    /// Light the scene from all around by a picture in longitude and latitude, a Radiance HDR or an
    /// EXR file. Its top is +y; its middle is seen towards -z.
    #[arg(long, value_name = "FILE", group = "around")]
    environment: Option<PathBuf>,
    /// Light the scene by a clear sky, whose sun stands so many degrees over the horizon, towards
    /// -z. Radiances are in kcd/m2: white in the sun has some 25, so that an
    /// --environment-strength of 0.04 suits most scenes.
    #[arg(
        long,
        value_name = "DEGREES",
        group = "around",
        allow_negative_numbers = true,
        value_parser = parse_elevation
    )]
    sky: Option<f32>,
    /// Turn the environment about +y, counter-clockwise as seen from above.
    #[arg(
        long,
        value_name = "DEGREES",
        default_value_t = 0.0,
        allow_negative_numbers = true,
        requires = "around",
        value_parser = parse_rotation
    )]
    environment_rotation: f32,
    /// Make the environment so many times as bright.
    #[arg(
        long,
        value_name = "FACTOR",
        default_value_t = 1.0,
        allow_negative_numbers = true,
        requires = "around",
        value_parser = parse_strength
    )]
    environment_strength: f32,
}

impl EnvironmentArguments {
    /// Gives the scene the environment that was asked for.
    fn light(&self, scene: &mut Scene, options: &LoadOptions) -> Result<(), SceneError> {
        let (environment, warnings) = match (&self.environment, self.sky) {
            (Some(path), _) => options.load_environment(path)?,
            (None, Some(elevation)) => (Sky::new(elevation).environment(), Vec::new()),
            (None, None) => return Ok(()),
        };
        scene.set_environment(Environment {
            rotation: self.environment_rotation,
            strength: self.environment_strength,
            ..environment
        });
        scene.warnings.extend(warnings);
        Ok(())
    }
}

impl LoadArguments {
    /// Has the paths among them start from `folder`.
    pub fn start_from(&mut self, folder: &Path) {
        if let Some(path) = &mut self.environment.environment {
            *path = folder.join(&*path);
        }
    }

    /// Loads a scene by its file or, if that is what `name` is, by the name of one that ships; `-`
    /// is standard input. Prints its warnings and, unless `quiet`, that it takes long.
    pub fn load_scene(&self, name: &Path, quiet: bool) -> Result<Scene, SceneError> {
        let scene = self.load_silently(name, quiet)?;
        for warning in &scene.warnings {
            say(&format!("warning: {warning}"));
        }
        if !scene.details.is_empty() {
            tracing::debug!("what is left out of the scene:");
        }
        for detail in &scene.details {
            tracing::debug!("{detail}");
        }
        Ok(scene)
    }

    /// Loads a scene as [`load_scene`](Self::load_scene) does, but prints no warnings.
    pub fn load_silently(&self, name: &Path, quiet: bool) -> Result<Scene, SceneError> {
        let options = LoadOptions {
            max_memory: (self.max_memory * GIB) as u64,
            instancing: self.instances,
            at: self.at,
            variant: self.variant.clone(),
        };
        let _waiting = Waiting::start(quiet, format!("loading {}", name.display()));
        let mut scene = match name.to_str() {
            Some("-") => options.read(&mut std::io::stdin().lock(), "<standard input>")?,
            Some(text) if is_name(text, name) => options.load_named(text)?,
            _ => options.load(name)?,
        };
        if let Some(camera) = &self.camera {
            scene.use_camera(camera)?;
        }
        self.view.change(&mut scene.camera);
        self.environment.light(&mut scene, &options)?;
        Ok(scene)
    }
}

const GIB: f64 = (1 << 30) as f64;

/// Whether a scene is called by the name of one that ships.
pub fn is_shipped(name: &Path) -> bool {
    shipped().iter().any(|scene| Path::new(scene.name) == name)
}

/// Whether a text is the name of a scene that ships, or of none: a file of such a name is a file.
fn is_name(text: &str, path: &Path) -> bool {
    let may_be_name = !text.contains(['/', '\\', '.']);
    may_be_name && (is_shipped(path) || !path.exists())
}

fn parse_elevation(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(degrees) if (0.0..=90.0).contains(&degrees) => Ok(degrees),
        _ => Err(format!("'{text}' is not an angle in degrees, from 0 to 90")),
    }
}

fn parse_rotation(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(degrees) if degrees.abs() <= 1e5 => Ok(degrees),
        _ => Err(format!("'{text}' is not an angle in degrees, from -100000 to 100000")),
    }
}

fn parse_strength(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(factor) if (0.0..=1e6).contains(&factor) => Ok(factor),
        _ => Err(format!("'{text}' is not a factor, from 0 to 1000000")),
    }
}

fn parse_time(text: &str) -> Result<Duration, String> {
    let seconds = text.parse::<f64>().ok();
    let time = seconds.and_then(|seconds| Duration::try_from_secs_f64(seconds).ok());
    time.ok_or_else(|| format!("'{text}' is not a time in seconds, such as 1.5"))
}

fn parse_memory(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(memory) if (0.01..=1e6).contains(&memory) => Ok(memory),
        _ => Err(format!("'{text}' is not an amount of memory in GiB, such as 8 or 0.5")),
    }
}
