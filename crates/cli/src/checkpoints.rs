//! Checkpoints of a render: the options, and who writes them.

use super::ending::CliError;
use super::interrupt;
use super::options::parse_seconds;
use super::output::say;
use super::progress::ProgressDisplay;
use super::tev::Audience;
use clap::Args;
use raystream::exec::Executor;
use raystream::film_file::{Difference, FilmFile, Header, Part};
use raystream::render::{
    AllocatorKind, IntegratorKind, Kept, Progress, RenderError, Renderer, Settings, Watch,
};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// The options that keep a render in a film file.
#[derive(Args)]
#[command(next_help_heading = "Checkpoints and parts")]
pub struct CheckpointArguments {
    /// Keep the render in this film file, from which `raystream resume` goes on: now and then, at
    /// the end, and when Ctrl-C or SIGTERM stops it.
    #[arg(long, value_name = "FILE")]
    pub checkpoint: Option<PathBuf>,
    /// How often to write it.
    #[arg(
        long,
        value_name = "SECONDS",
        default_value = "60",
        requires = "checkpoint",
        value_parser = parse_seconds
    )]
    pub checkpoint_every: Duration,
    /// Render one part of n of the samples, from 0/n to (n-1)/n: `raystream merge` makes one film
    /// of all.
    #[arg(long, value_name = "I/N", requires = "spp")]
    pub part: Option<Part>,
}

/// All settings but those that say when a render ends.
pub fn in_words(settings: &Settings) -> String {
    let mut settings = *settings;
    let split = settings.whole_sampling().split();
    settings.sampling.noise = None;
    settings.sampling.halves = false;
    format!("{settings:?}, {split:?}")
}

/// The settings of a part. Samples that do not depend on others are of one sequence; where light
/// paths are shared, or errors decide about samples, parts are independent renders.
pub fn settings_of_part(settings: Settings, part: Option<Part>) -> Settings {
    match part {
        Some(part) if !is_of_one_sequence(&settings) => {
            let seed = settings.seed.wrapping_add((part.index + 1).wrapping_mul(0x9e37_79b9));
            Settings { seed, ..settings }
        }
        _ => settings,
    }
}

/// Whether parts have samples of one sequence.
pub fn is_of_one_sequence(settings: &Settings) -> bool {
    settings.sampling.allocator == AllocatorKind::Uniform
        && settings.integrator != IntegratorKind::Lvc
}

/// Writes a film file now and then.
pub struct Keeper {
    path: PathBuf,
    every: Duration,
    header: Header,
    start: Instant,
    last: Instant,
}

impl Keeper {
    /// Of a render that begins now.
    pub fn new(path: &Path, every: Duration, header: Header) -> Self {
        let start = Instant::now();
        Self { path: path.to_owned(), every, header, start, last: start }
    }

    /// What to do with the file.
    pub fn advice(&self) -> String {
        let path = self.path.display();
        match self.header.part {
            Some(_) => format!("wrote {path}; `raystream merge` adds it to the other parts"),
            None => format!("wrote {path}; `raystream resume {path} --spp N` goes on"),
        }
    }

    /// Writes the film as it is.
    pub fn write<E: Executor>(&mut self, renderer: &Renderer<E>) -> Result<(), CliError> {
        let seconds = self.header.seconds + self.start.elapsed().as_secs_f64();
        let header = Header { seconds, ..self.header.clone() };
        let file = FilmFile { header, checkpoint: renderer.checkpoint()? };
        self.last = Instant::now();
        Ok(file.write(&self.path)?)
    }
}

/// Shows progress, asks for signals and keeps the film.
pub struct RenderWatch<'a> {
    pub display: &'a mut ProgressDisplay,
    pub keeper: Option<&'a mut Keeper>,
    /// What another device goes on from.
    pub kept: &'a mut Kept,
    /// Who sees pictures of it.
    pub audience: &'a mut Audience,
}

impl<E: Executor> Watch<E> for RenderWatch<'_> {
    fn is_interrupted(&self) -> bool {
        interrupt::is_interrupted()
    }

    fn keeps_checkpoints(&self) -> bool {
        self.keeper.is_some()
    }

    fn batch_ended(&mut self, progress: &Progress) {
        interrupt::has_picture();
        self.display.show(progress);
    }

    fn may_checkpoint(&mut self, renderer: &Renderer<E>) -> Result<(), RenderError> {
        self.kept.may_keep(renderer)?;
        self.audience.may_look(renderer)?;
        let Some(keeper) = &mut self.keeper else { return Ok(()) };
        if keeper.last.elapsed() < keeper.every {
            return Ok(());
        }
        // A disk may have room again by the next time.
        if let Err(error) = keeper.write(renderer) {
            let wait = keeper.every.as_secs_f64();
            say(&format!("warning: no checkpoint: {error}; trying again in {wait} s"));
        }
        Ok(())
    }
}

/// Fails unless a film can be gone on from with this header.
pub fn check_film(path: &Path, film: &Header, own: &Header) -> Result<(), CliError> {
    let merged = film.merged.len() as u32;
    if film.part.is_none() && film.merged.first().is_some_and(|part| part.count != merged) {
        return Err(format!(
            "{}: is merged of {merged} parts of {}; merge all of them before you go on",
            path.display(),
            film.merged[0].count
        )
        .into());
    }
    let Some(difference) = film.difference(own) else { return Ok(()) };
    let what = match difference {
        Difference::Kernels => {
            "was rendered by another version's kernels: go on with the version that began it"
        }
        Difference::Scene => {
            "is of another scene: its files have changed since; restore them, or render anew"
        }
        Difference::Settings => {
            "was rendered with other settings: --noise asks for samples in halves, which it may \
             lack; render anew with --halves or --noise"
        }
        Difference::Parts => "is of another part: go on with each part by itself",
    };
    Err(format!("{}: {what}", path.display()).into())
}
