//! A render: from a scene that is loaded to pictures that are written.

use super::checkpoints::{
    CheckpointArguments, Keeper, RenderWatch, check_film, in_words, is_of_one_sequence,
    settings_of_part,
};
use super::command;
use super::ending::{CliError, Ending};
use super::frames;
use super::output;
use super::processes::{Helper, Identity};
use super::progress::ProgressDisplay;
use super::render::{DEFAULT_SAMPLES, RenderArguments, Resumed};
use super::rendered::{Rendered, stop_name};
use super::sampling::describe;
use super::tev::Audience;
use raystream::exec::ExecError;
use raystream::exec::device::Device;
use raystream::film_file::{Command, Header, kernels_digest, scene_digest};
use raystream::render::{
    Budget, Checkpoint, Leg, LocalWorker, PreparedScene, Relay, RenderError, Renderer, Settings,
    Split, Worker, run_watched,
};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Paths and rays that a render has traced.
fn traced(state: Option<&Checkpoint>) -> (u64, u64) {
    let rays = |state: &Checkpoint| state.radiance.iter().map(|sums| u64::from(sums.rays)).sum();
    state.map_or((0, 0), |state| (state.progress.paths, rays(state)))
}

/// All that a render is made of.
pub struct Job<'a> {
    pub arguments: &'a RenderArguments,
    pub from: Option<&'a Resumed>,
    /// Who has the film.
    pub device: &'a Device,
    /// Who else traces.
    pub others: &'a [Device],
    /// What they are called.
    pub on: String,
    /// What kinds of devices they are: those of one kind make the same film.
    pub kinds: BTreeSet<String>,
    pub prepared: &'a PreparedScene,
    pub settings: Settings,
    /// Of the scene.
    pub name: String,
}

impl Job<'_> {
    /// The settings of the part that is rendered.
    fn settings(&self) -> Settings {
        settings_of_part(self.settings, self.arguments.checkpoints.part)
    }

    /// What processes that render it together must have in common.
    pub fn identity(&self) -> Identity {
        Identity {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            kernels: kernels_digest(),
            scene: scene_digest(self.prepared),
            settings: in_words(&self.settings()),
        }
    }

    /// All devices as workers, for a render of another process.
    pub fn workers(&self) -> Result<Vec<Box<dyn Worker>>, ExecError> {
        let devices = std::iter::once(self.device).chain(self.others);
        devices.map(|device| self.worker(device)).collect()
    }

    fn worker(&self, device: &Device) -> Result<Box<dyn Worker>, ExecError> {
        let worker = LocalWorker::new(device.clone(), self.prepared, &self.settings())?;
        Ok(Box::new(worker))
    }

    /// Says who else renders, and counts the kinds of devices that this process has not.
    pub fn name_helpers(&mut self, helpers: &[Helper]) {
        let kinds: BTreeSet<String> = helpers.iter().map(|helper| helper.device.clone()).collect();
        if !helpers.is_empty() {
            let (count, kinds) = (helpers.len(), Vec::from_iter(kinds.clone()).join(", "));
            self.arguments.say(&format!("and on {count} of other processes: {kinds}"));
        }
        for kind in kinds {
            if self.kinds.insert(kind.clone()) {
                self.on = format!("{}, {kind}", self.on);
            }
        }
    }

    /// The render as it begins or goes on, with workers on all devices of this process.
    pub fn renderer(&self) -> Result<Renderer, RenderError> {
        self.renderer_on(self.device, self.others, self.state_before())
    }

    /// The same with the film on `device`, and `from` a state that it was left in.
    fn renderer_on(
        &self,
        device: &Device,
        others: &[Device],
        from: Option<&Checkpoint>,
    ) -> Result<Renderer, RenderError> {
        let part = self.arguments.checkpoints.part;
        let settings = self.settings();
        let mut renderer = Renderer::new(device.clone(), self.prepared, &settings)?;
        for other in others {
            renderer.add_worker(self.worker(other)?);
        }
        if let Some(state) = from {
            renderer.restore(state)?;
        } else if let Some(part) = part.filter(|_| is_of_one_sequence(&settings)) {
            renderer.skip_samples(part.of(self.arguments.spp.unwrap_or_default()).start)?;
        }
        Ok(renderer)
    }

    /// What it goes on from.
    fn state_before(&self) -> Option<&Checkpoint> {
        self.from.map(|resumed| &resumed.film.checkpoint)
    }

    /// Renders, on the next device where one is lost.
    pub fn render(
        &self,
        helpers: Vec<Helper>,
        audience: &mut Audience,
    ) -> Result<Rendered, CliError> {
        if let Some(state) = self.state_before() {
            let pixels = f64::from(state.size.width) * f64::from(state.size.height);
            let samples = state.progress.paths as f64 / pixels;
            self.arguments.say(&format!("going on from {samples:.2} samples per pixel"));
        }
        let (mut keeper, budget) = (self.keeper()?, self.budget()?);
        let devices = std::iter::once(self.device).chain(self.others).cloned().collect();
        let mut relay = Relay::new(devices, self.state_before());
        // Those of other processes end with the device that they trace for.
        let mut helpers = helpers.into_iter();
        let (paths_before, rays_before) = traced(self.state_before());
        let start = Instant::now();
        let rendered = relay.run(|leg| {
            let lost = start.elapsed();
            let time = budget.time.map(|time| time.saturating_sub(lost));
            let (paths, rays) = traced(leg.from);
            let mut renderer = self.renderer_on(leg.device, leg.others, leg.from)?;
            helpers.by_ref().for_each(|helper| renderer.add_worker(helper.worker));
            let budget = Budget { time, ..budget };
            let mut rendered = self.render_by(renderer, budget, keeper.as_mut(), audience, leg)?;
            rendered.outcome.elapsed += lost;
            rendered.outcome.paths += paths - paths_before;
            rendered.outcome.rays += rays - rays_before;
            Ok(rendered)
        });
        Ok(rendered?)
    }

    /// Renders until the budget is spent or the renderer's device is lost.
    fn render_by(
        &self,
        mut renderer: Renderer,
        budget: Budget,
        mut keeper: Option<&mut Keeper>,
        audience: &mut Audience,
        leg: Leg<'_, Device>,
    ) -> Result<Rendered, RenderError> {
        let mut display = ProgressDisplay::new(self.arguments.quiet);
        let keeper_of_watch = keeper.as_deref_mut();
        let mut watch = RenderWatch {
            display: &mut display,
            keeper: keeper_of_watch,
            kept: leg.kept,
            audience,
        };
        let outcome = run_watched(&mut renderer, budget, &mut watch)?;
        display.finish();
        // Before the features get what a picture deserves: rounds to come must not see that.
        let kept = keeper.map_or(Ok(()), |keeper| {
            keeper.write(&renderer)?;
            self.arguments.say(&keeper.advice());
            Ok(())
        });
        renderer.finish_features()?;
        let noise = renderer.noise()?;
        Ok(Rendered { film: renderer.film()?, outcome, noise, kept })
    }

    /// Who keeps the film, if that was asked for.
    fn keeper(&self) -> Result<Option<Keeper>, CliError> {
        let CheckpointArguments { checkpoint, checkpoint_every, .. } = &self.arguments.checkpoints;
        let Some(path) = checkpoint else { return Ok(None) };
        let (header, warning) = self.header(path)?;
        if let Some(what) = warning {
            output::say(&format!("warning: {what}"));
        }
        Ok(Some(Keeper::new(path, *checkpoint_every, header)))
    }

    /// What a film file says of the render, and what to know where it goes on from `path`.
    pub fn header(&self, path: &Path) -> Result<(Header, Option<String>), CliError> {
        let film = self.from.map(|from| &from.film.header);
        let settings = &self.settings;
        let header = Header {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            kernels: kernels_digest(),
            scene: self.name.clone(),
            scene_digest: scene_digest(self.prepared),
            settings: in_words(settings),
            device: Vec::from_iter(self.kinds.clone()).join(", "),
            part: self.arguments.checkpoints.part,
            merged: film.map(|film| film.merged.clone()).unwrap_or_default(),
            command: self.command()?,
            seconds: self.seconds_before(),
            camera: self.prepared.parameters(settings).camera,
            has_control: settings.whole_sampling().split() == Split::Control,
        };
        let Some(film) = film else { return Ok((header, None)) };
        check_film(path, film, &header)?;
        let warning = (film.device != header.device).then(|| {
            format!(
                "begun on {}: the picture will be right, but not the same to the last bit as from \
                 one device",
                film.device
            )
        });
        Ok((header, warning))
    }

    /// How to call the render again.
    fn command(&self) -> Result<Command, CliError> {
        if let Some(from) = self.from {
            return Ok(from.command.clone());
        }
        if let Some(command) = &self.arguments.called {
            return Ok(command.clone());
        }
        let mut command = command::of_this_process()?;
        if let Some(frame) = self.arguments.frame {
            command::remove_option(&mut command, "--frames");
            if let Some(rate) = self.arguments.fps {
                let time = frames::time(frame, rate).as_secs_f64().to_string();
                command::remove_option(&mut command, "--fps");
                command::set_option(&mut command, "render", "--at", &time);
            }
            let seed = self.settings.seed.to_string();
            command::set_option(&mut command, "render", "--seed", &seed);
            for argument in &mut command.arguments {
                *argument = frames::fill(argument, frame);
            }
        }
        Ok(command)
    }

    /// Says how it went, and writes the pictures.
    pub fn write(&self, outputs: &[PathBuf], rendered: Rendered) -> Result<Ending, CliError> {
        let arguments = self.arguments;
        arguments.say(&rendered.summary());
        for warning in rendered.shortcomings(self.settings.sampling.noise) {
            output::say(&format!("warning: {warning}"));
        }
        if let Some(filter) = self.settings.denoise {
            arguments.say(&format!("filtered the picture ({filter})"));
        }
        arguments.write(outputs, &rendered.film, &self.picture_header(&rendered))?;
        rendered.kept?;
        Ok(if rendered.outcome.interrupted() { Ending::Interrupted } else { Ending::Done })
    }

    /// Seconds that the render took before.
    pub fn seconds_before(&self) -> f64 {
        self.from.map_or(0.0, |from| from.film.header.seconds)
    }

    /// When the render ends.
    pub fn budget(&self) -> Result<Budget, CliError> {
        let RenderArguments { time, spp, checkpoints, .. } = self.arguments;
        let has_no_other_end = time.is_none() && self.settings.sampling.noise.is_none();
        let samples = spp.or_else(|| has_no_other_end.then_some(DEFAULT_SAMPLES));
        let before = Duration::try_from_secs_f64(self.seconds_before()).unwrap_or_default();
        let time = time.map(|time| time.saturating_sub(before));
        let Some(part) = checkpoints.part else { return Ok(Budget { samples, time }) };
        let of_part = part.of(samples.unwrap_or_default()).len() as u32;
        if of_part == 0 {
            return Err(format!(
                "--part {part}: there are fewer samples per pixel than parts; give a larger --spp \
                 or fewer parts"
            )
            .into());
        }
        Ok(Budget { samples: Some(of_part), time })
    }

    /// What pictures say of the render: keys and values.
    fn picture_header(&self, rendered: &Rendered) -> Vec<(String, String)> {
        let Rendered { film, outcome, noise, .. } = rendered;
        let settings = &self.settings;
        let seconds = self.seconds_before() + outcome.elapsed.as_secs_f64();
        let mut header = vec![
            ("scene".to_owned(), self.name.clone()),
            ("device".to_owned(), self.on.clone()),
            ("samples".to_owned(), output::average_samples(film).to_string()),
            ("seconds".to_owned(), format!("{seconds:.3}")),
            ("stop".to_owned(), stop_name(outcome.stop).to_owned()),
            ("version".to_owned(), env!("CARGO_PKG_VERSION").to_owned()),
        ];
        if let Some(noise) = noise {
            header.push(("estimated_error".to_owned(), noise.relative_error.to_string()));
        }
        header.extend(self.arguments.settings.describe(settings));
        header.extend(describe(&settings.sampling));
        header.extend(settings.denoise.map(|filter| ("denoise".to_owned(), filter.to_string())));
        header.extend(self.arguments.checkpoints.part.map(|p| ("part".to_owned(), p.to_string())));
        header
    }
}
