//! The command line: all of the program `raystream`, and what `raystream-mpi` and the Python
//! package share with it.

#![warn(
    clippy::print_stderr,
    clippy::print_stdout,
    reason = "they panic where the reader has gone away, as in `| head`"
)]

mod agreement;
mod bench;
mod calls;
mod camera;
mod checkpoints;
mod choices;
mod command;
mod compare;
mod convergence;
mod denoise;
mod devices;
mod diff_devices;
mod effects;
mod ending;
mod entries;
mod frames;
#[cfg(test)]
mod fuzz;
mod hints;
mod inspect;
mod integrators;
mod interrupt;
mod job;
mod keywords;
mod loading;
mod merge;
mod options;
mod output;
mod picture;
mod processes;
mod program;
mod progress;
mod render;
mod rendered;
mod resume;
mod sampling;
mod scenes;
mod tev;
mod view;

pub use self::calls::{Call, ReadyCall};
pub use self::effects::Given;
pub use self::ending::{CliError, Ending, FAILED, exit_status};
pub use self::hints::with_hint;
pub use self::interrupt::{catch as catch_signals, ignore as ignore_signals};
pub use self::keywords::{CallOption, call_options, in_keywords};
pub use self::merge::merged;
pub use self::output::{say, silence};
pub use self::processes::{Alone, Helper, Identity, Processes};
pub use self::program::{ProgramArguments, quiet_drivers};
pub use self::render::RenderArguments;
pub use self::rendered::Rendered;
pub use self::resume::ResumeArguments;

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use std::process::ExitCode;

/// An adaptive path tracer whose kernels are written once, in Rust, and run on the GPU and on the
/// CPU.
#[derive(Parser)]
#[command(name = "raystream", version, max_term_width = 100)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
    #[command(flatten)]
    program: ProgramArguments,
}

/// The commands that render.
#[derive(Subcommand)]
pub enum RenderCommand {
    /// Render a scene to a picture.
    Render(Box<RenderArguments>),
    /// Go on with a render that was kept in a film file.
    Resume(ResumeArguments),
}

#[derive(Subcommand)]
enum Command {
    #[command(flatten)]
    Rendering(RenderCommand),
    /// Make a picture of a film file.
    Picture(picture::PictureArguments),
    /// Make one film file of those of a render's parts.
    Merge(merge::MergeArguments),
    /// Compare two pictures: RMSE, relMSE, SSIM, ratio of the means.
    Compare(compare::CompareArguments),
    /// Take noise out of a picture that was rendered before, here or by another renderer.
    Denoise(denoise::DenoiseArguments),
    /// Say what a scene's file holds, and what of it a picture will not show.
    Inspect(inspect::InspectArguments),
    /// Look at a render in a window while it runs.
    #[command(disable_help_flag = true)]
    View(view::ViewArguments),
    /// List the devices that can render.
    Devices(devices::DevicesArguments),
    /// Render on two devices at once, and say after which kernel they differ, if they do: exit
    /// status 1.
    DiffDevices(Box<diff_devices::DiffDevicesArguments>),
    /// List the scenes that ship with Raystream.
    Scenes,
    /// Measure speed.
    #[command(subcommand)]
    Bench(Box<bench::BenchCommand>),
}

/// The program `raystream`.
pub fn main() -> ExitCode {
    // SAFETY: the program does this first, in its only thread.
    unsafe { quiet_drivers() };
    let matches = Arguments::command().get_matches();
    let arguments = Arguments::from_arg_matches(&matches).unwrap_or_else(|error| error.exit());
    arguments.program.start_logging();
    ExitCode::from(exit_status(run(arguments, &Given::of(&matches))))
}

fn run(arguments: Arguments, given: &Given) -> Result<Ending, CliError> {
    arguments.program.start_threads()?;
    interrupt::catch()?;
    match arguments.command {
        Command::Rendering(command) => command.run(given, &Alone),
        Command::Picture(arguments) => picture::run(&arguments, given),
        Command::Merge(arguments) => merge::run(&arguments),
        Command::Compare(arguments) => compare::run(&arguments, given),
        Command::Denoise(arguments) => denoise::run(&arguments, given),
        Command::Inspect(arguments) => inspect::run(&arguments),
        Command::Devices(arguments) => devices::run(&arguments),
        Command::DiffDevices(arguments) => diff_devices::run_command(&arguments, given),
        Command::View(arguments) => view::run(&arguments),
        Command::Scenes => scenes::run(),
        Command::Bench(command) => bench::run(&command, given),
    }
}

impl RenderCommand {
    /// Renders, together with other `processes`; `given` are the options on the command line.
    ///
    /// # Errors
    /// If anything is wrong with the arguments, a file, a device or the other processes.
    pub fn run(self, given: &Given, processes: &dyn Processes) -> Result<Ending, CliError> {
        match self {
            Self::Render(arguments) => render::run(*arguments, given, processes),
            Self::Resume(arguments) => resume::run(&arguments, parse_render, processes),
        }
    }
}

/// Reads the words of a command that renders, without the program's name.
fn parse_render(words: &[String]) -> Result<(RenderArguments, Given), String> {
    let words = std::iter::once("raystream").chain(words.iter().map(String::as_str));
    let matches = Arguments::command().try_get_matches_from(words);
    let matches = matches.map_err(|error| error.to_string())?;
    match Arguments::from_arg_matches(&matches).map_err(|error| error.to_string())?.command {
        Command::Rendering(RenderCommand::Render(arguments)) => {
            Ok((*arguments, Given::of(&matches)))
        }
        _ => Err("it renders nothing".to_owned()),
    }
}
