//! `raystream resume`

use super::checkpoints::CheckpointArguments;
use super::command;
use super::effects::Given;
use super::ending::{CliError, Ending};
use super::options::parse_seconds;
use super::processes::Processes;
use super::render::{self, RenderArguments, Resumed};
use super::sampling::parse_noise;
use clap::Args;
use raystream::film_file::{self, FilmFile};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// The options of `raystream resume`.
#[derive(Args)]
pub struct ResumeArguments {
    /// The film file that `raystream render --checkpoint` has written. It is kept up to date.
    film: PathBuf,
    /// Where to write the picture; may be given several times [default: where the render was to].
    #[arg(short, long, value_name = "FILE")]
    output: Vec<PathBuf>,
    /// Samples per pixel in all, those that the film has included. Of this, --time and --noise
    /// what comes first counts; given one of them, none counts that was given before.
    #[arg(
        long,
        value_name = "N",
        value_parser = clap::value_parser!(u32).range(1..=render::MAX_SAMPLES)
    )]
    spp: Option<u32>,
    /// Go on for this time.
    #[arg(long, value_name = "SECONDS", value_parser = parse_seconds)]
    time: Option<Duration>,
    /// Stop when the picture's estimated relative error is at most this.
    #[arg(long, value_name = "ERROR", value_parser = parse_noise)]
    noise: Option<f32>,
    /// Where to render; see `raystream render --help` [default: as before].
    #[arg(long, value_name = "DEVICE")]
    device: Option<String>,
    /// How often to write the film file [default: as before].
    #[arg(long, value_name = "SECONDS", value_parser = parse_seconds)]
    checkpoint_every: Option<Duration>,
    /// Say nothing but warnings and errors.
    #[arg(short, long)]
    quiet: bool,
}

/// The subcommand that began the render.
const RENDER: &str = "render";

/// Reads the words of a command that renders.
pub type Parse = fn(&[String]) -> Result<(RenderArguments, Given), String>;

/// Goes on with a render.
pub fn run(
    arguments: &ResumeArguments,
    parse: Parse,
    processes: &dyn Processes,
) -> Result<Ending, CliError> {
    let film = FilmFile::read(&arguments.film)?;
    let path = absolute(&arguments.film)?;
    let outputs = arguments.output.iter().map(|output| absolute(output));
    let outputs = outputs.collect::<Result<Vec<_>, _>>()?;
    let command = arguments.command(&film);
    enter(&command.folder, &path)?;
    let (mut render, given) = parse(&command.arguments).map_err(|what| {
        format!("{}: its command line is not this version's: {what}", path.display())
    })?;
    let CheckpointArguments { checkpoint, checkpoint_every, .. } = &mut render.checkpoints;
    *checkpoint = Some(path);
    *checkpoint_every = arguments.checkpoint_every.unwrap_or(*checkpoint_every);
    render.quiet |= arguments.quiet;
    if !outputs.is_empty() {
        render.output = outputs;
    }
    render::go_on(&render, &given, Some(&Resumed { command, film }), processes)
}

impl ResumeArguments {
    /// How the render of `film` goes on.
    pub(crate) fn command(&self, film: &FilmFile) -> film_file::Command {
        let mut command = film.header.command.clone();
        let seconds = |more: Duration| film.header.seconds + more.as_secs_f64();
        let stops = [
            ("--spp", self.spp.map(|samples| samples.to_string())),
            ("--time", self.time.map(|more| seconds(more).to_string())),
            ("--noise", self.noise.map(|error| error.to_string())),
        ];
        if stops.iter().any(|(_, value)| value.is_some()) {
            for (name, value) in stops {
                command::remove_option(&mut command, name);
                if let Some(value) = value {
                    command::set_option(&mut command, RENDER, name, &value);
                }
            }
        }
        if let Some(device) = &self.device {
            command::set_option(&mut command, RENDER, "--device", device);
        }
        command
    }
}

fn absolute(path: &Path) -> Result<PathBuf, CliError> {
    std::path::absolute(path).map_err(|error| format!("{}: {error}", path.display()).into())
}

/// Makes the folder that the paths of a render start from the working folder.
fn enter(folder: &Path, film: &Path) -> Result<(), CliError> {
    std::env::set_current_dir(folder).map_err(|error| {
        format!(
            "{}: was begun in the folder {}, which cannot be entered: {error}; put it there again",
            film.display(),
            folder.display()
        )
        .into()
    })
}
