//! Renders for programs that have no command line: options by name, and no word on a terminal.
//!
//! An option is called as on the command line, with `_` for `-`, and means the same: it is read by
//! the same parser.

use super::effects::{Facts, Given};
use super::ending::CliError;
use super::job::Job;
use super::keywords::{call_options, check_names, in_keywords, said, word};
use super::loading::is_shipped;
use super::render::{RenderArguments, Resumed, kinds};
use super::{Arguments, Command as Subcommand, RenderCommand, parse_render};
use clap::Parser;
use raystream::exec::Device;
use raystream::film_file::{Command, FilmFile, Header};
use raystream::render::{Budget, PreparedScene, Renderer, Settings};
use raystream::scene::{Scene, SceneError};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A render that has been asked for.
pub struct Call {
    arguments: RenderArguments,
    given: Given,
}

impl Call {
    /// The render of `scene`, a file or a scene that ships, with options and their values; a flag
    /// has none. The render could be called again from the command line, in this working folder.
    ///
    /// # Errors
    /// What is wrong with an option, in words.
    pub fn new(scene: &str, options: &[(String, Option<String>)]) -> Result<Self, String> {
        check_names(options, &call_options())?;
        let mut arguments = vec!["render".to_owned()];
        arguments.extend(options.iter().map(|(name, value)| word(name, value.as_deref())));
        arguments.extend(["--".to_owned(), scene.to_owned()]);
        let folder = std::env::current_dir().unwrap_or_default();
        Self::of_command(Command { folder, arguments })
    }

    /// The render that goes on from a film, with options of `raystream resume`.
    ///
    /// # Errors
    /// What is wrong with an option, in words.
    pub fn resume(film: &FilmFile, options: &[(String, Option<String>)]) -> Result<Self, String> {
        let known = ["spp", "time", "noise", "device"];
        let known: Vec<_> =
            call_options().into_iter().filter(|o| known.contains(&o.name.as_str())).collect();
        check_names(options, &known)?;
        let mut words = vec!["raystream".to_owned(), "resume".to_owned()];
        words.extend(options.iter().map(|(name, value)| word(name, value.as_deref())));
        words.push("film".to_owned());
        let parsed = Arguments::try_parse_from(words).map_err(|error| said(&error.to_string()))?;
        let Subcommand::Rendering(RenderCommand::Resume(resumed)) = parsed.command else {
            return Err("it renders nothing".to_owned());
        };
        let mut call = Self::of_command(resumed.command(film))?;
        call.arguments.start_from(&film.header.command.folder);
        Ok(call)
    }

    fn of_command(command: Command) -> Result<Self, String> {
        let (mut arguments, given) =
            parse_render(&command.arguments).map_err(|error| said(&error))?;
        arguments.called = Some(command);
        Ok(Self { arguments, given })
    }

    /// The file or name of the scene.
    pub fn scene(&self) -> &Path {
        &self.arguments.scene
    }

    /// Loads the scene; what is to be known of it is in its warnings.
    ///
    /// # Errors
    /// If it cannot be loaded.
    pub fn load(&self) -> Result<Scene, SceneError> {
        self.arguments.settings.load_silently(&self.arguments.scene)
    }

    /// Builds the scene's hierarchy, lights and tables, as the options say.
    ///
    /// # Errors
    /// If the scene's parts do not fit together.
    pub fn prepare(&self, scene: &Scene) -> Result<PreparedScene, CliError> {
        Ok(PreparedScene::new(scene, self.arguments.settings.bvh())?)
    }

    /// How carefully the hierarchy is built, in a word.
    pub fn hierarchy(&self) -> &'static str {
        self.arguments.settings.bvh().name()
    }

    /// What opens the devices, in words: calls with the same have the same devices.
    pub fn devices(&self) -> String {
        self.arguments.device.in_words()
    }

    /// Opens the devices: the first, which has the film, and the others.
    ///
    /// # Errors
    /// If there is no such device, or it does not work.
    pub fn open(&self) -> Result<(Device, Vec<Device>), CliError> {
        Ok(self.arguments.device.open_all()?)
    }

    /// The render of a scene on these devices, from the beginning or from a film of the file
    /// `from`.
    pub fn ready(
        self,
        scene: &Scene,
        prepared: Arc<PreparedScene>,
        (device, others): (Device, Vec<Device>),
        from: Option<(PathBuf, FilmFile)>,
    ) -> ReadyCall {
        let Self { arguments, given } = self;
        let mut settings = arguments.all_settings(scene);
        let mut warnings = given.without_effect(&Facts::of_render(&settings, scene, &device));
        warnings.extend(arguments.fall_back_on_large_films(&device, &mut settings));
        let warnings = warnings.iter().map(|what| in_keywords(what)).collect();
        let resumed = from.map(|(path, film)| {
            let command = arguments.called.clone().unwrap_or_else(|| film.header.command.clone());
            (path, Resumed { command, film })
        });
        let kinds = kinds(&device, &others);
        let name = scene.name.clone();
        ReadyCall { arguments, prepared, device, others, kinds, settings, name, resumed, warnings }
    }
}

/// A render with all that it takes.
pub struct ReadyCall {
    arguments: RenderArguments,
    prepared: Arc<PreparedScene>,
    device: Device,
    others: Vec<Device>,
    kinds: BTreeSet<String>,
    settings: Settings,
    name: String,
    resumed: Option<(PathBuf, Resumed)>,
    warnings: Vec<String>,
}

impl ReadyCall {
    /// What the caller should know, a sentence each.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// What is rendered, and how.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// The device that has the film.
    pub fn device(&self) -> &Device {
        &self.device
    }

    fn job(&self) -> Job<'_> {
        Job {
            arguments: &self.arguments,
            from: self.resumed.as_ref().map(|(_, resumed)| resumed),
            device: &self.device,
            others: &self.others,
            on: String::new(),
            kinds: self.kinds.clone(),
            prepared: &self.prepared,
            settings: self.settings,
            name: self.name.clone(),
        }
    }

    /// Begins the render, or goes on with it: the renderer, and when it is to end.
    ///
    /// # Errors
    /// If a device fails, or the film is of another render.
    pub fn begin(&mut self) -> Result<(Renderer, Budget), CliError> {
        if let Some((path, _)) = &self.resumed {
            let (_, warning) = self.job().header(path)?;
            self.warnings.extend(warning);
        }
        let begun = (self.job().renderer()?, self.job().budget()?);
        if let Some((_, resumed)) = &mut self.resumed {
            // It is on the device now.
            resumed.film.checkpoint.radiance = Vec::new();
            resumed.film.checkpoint.features = Vec::new();
        }
        Ok(begun)
    }

    /// What a film file of the render says of it after `seconds` more.
    ///
    /// # Errors
    /// If it goes on from a film of another render.
    pub fn header(&self, seconds: f64) -> Result<Header, CliError> {
        let job = self.job();
        let path = self.resumed.as_ref().map_or(Path::new(""), |(path, _)| path);
        let (header, _) = job.header(path)?;
        Ok(Header { seconds: job.seconds_before() + seconds, ..header })
    }
}

impl RenderArguments {
    /// Has the paths that are read start from `folder`.
    fn start_from(&mut self, folder: &Path) {
        if !is_shipped(&self.scene) {
            self.scene = folder.join(&self.scene);
        }
        self.settings.loading().start_from(folder);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn given(options: &[(&str, &str)]) -> Vec<(String, Option<String>)> {
        let owned = |(name, value): &(&str, &str)| {
            ((*name).to_owned(), (!value.is_empty()).then(|| (*value).to_owned()))
        };
        options.iter().map(owned).collect()
    }

    #[test]
    fn what_is_wrong_is_said_in_a_line() {
        let wrong = |options: &[(&str, &str)]| Call::new("tea", &given(options)).err().unwrap();
        for (option, value, parts) in [
            ("integrator", "x", &["'x'", "'integrator'", "megakernel", "lvc"][..]),
            ("spp", "0", &["'0'", "'spp'", "1..=16777216"]),
            ("noise", "NaN", &["'NaN' is not a relative error"]),
            ("sppx", "1", &["no option 'sppx'", "allocator", "spp, time"]),
            ("output", "a.png", &["no option 'output'"]),
        ] {
            let said = wrong(&[(option, value)]);
            for part in parts {
                assert!(said.contains(part), "{part}: {said}");
            }
            assert!(!said.contains("--") && !said.contains('\n'), "{said}");
        }
        let said = wrong(&[("focus", "1"), ("panorama", "")]);
        assert!(said.contains("cannot be used with") && !said.contains('\n'), "{said}");
    }

    #[test]
    fn calls_load_and_are_ready() {
        let options =
            given(&[("size", "8x6"), ("spp", "2"), ("allocator", "uniform"), ("relative", "")]);
        let call = Call::new("cornell_ball", &options).unwrap();
        let scene = call.load().unwrap();
        let prepared = Arc::new(call.prepare(&scene).unwrap());
        let devices = (Device::open("cpu").unwrap(), Vec::new());
        let mut ready = call.ready(&scene, prepared, devices, None);
        assert_eq!(ready.settings().size.width, 8);
        assert!(ready.warnings()[0].starts_with("relative has no effect with allocator uniform"));
        let (renderer, budget) = ready.begin().unwrap();
        assert_eq!((renderer.pixels(), budget.samples), (48, Some(2)));
        let header = ready.header(1.5).unwrap();
        assert_eq!(header.command.arguments.last().unwrap(), "cornell_ball");
        assert_eq!(header.seconds, 1.5);
    }
}
