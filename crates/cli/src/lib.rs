//! The `raystream` binary: the command line.

#![warn(
    clippy::print_stderr,
    clippy::print_stdout,
    reason = "they panic where the reader has gone away, as in `| head`"
)]

mod agreement;
mod bench;
mod camera;
mod checkpoints;
mod choices;
mod command;
mod compare;
mod convergence;
mod denoise;
mod devices;
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
mod loading;
mod merge;
mod options;
mod output;
mod picture;
mod progress;
mod render;
mod resume;
mod sampling;
mod scenes;

use self::effects::Given;
use self::ending::{CliError, Ending, FAILED, INTERRUPTED};
use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use std::process::ExitCode;

/// An adaptive path tracer whose kernels are written once, in Rust, and run on the GPU and on the
/// CPU.
#[derive(Parser)]
#[command(name = "raystream", version, max_term_width = 100)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
    /// Say more: -v what happens, -vv what the libraries say.
    #[arg(short, long, global = true, action = clap::ArgAction::Count)]
    verbose: u8,
    /// Threads of the CPU to use [default: one for each core].
    #[arg(
        long,
        global = true,
        value_name = "N",
        value_parser = clap::value_parser!(u32).range(1..=4096)
    )]
    threads: Option<u32>,
}

#[derive(Subcommand)]
enum Command {
    /// Render a scene to a picture.
    Render(render::RenderArguments),
    /// Go on with a render that was kept in a film file.
    Resume(resume::ResumeArguments),
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
    /// List the devices that can render.
    Devices(devices::DevicesArguments),
    /// List the scenes that ship with Raystream.
    Scenes,
    /// Measure speed.
    #[command(subcommand)]
    Bench(bench::BenchCommand),
}

fn main() -> ExitCode {
    silence_device_selection();
    let matches = Arguments::command().get_matches();
    let arguments = Arguments::from_arg_matches(&matches).unwrap_or_else(|error| error.exit());
    start_logging(arguments.verbose);
    report_panics();
    match run(arguments, &Given::of(&matches)) {
        Ok(Ending::Done) => ExitCode::SUCCESS,
        Ok(Ending::Interrupted) => ExitCode::from(INTERRUPTED),
        Err(error) => {
            output::say(&format!("error: {}", hints::with_hint(error.as_ref())));
            ExitCode::from(FAILED)
        }
    }
}

fn run(arguments: Arguments, given: &Given) -> Result<Ending, CliError> {
    if let Some(threads) = arguments.threads {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads as usize);
        pool.build_global().map_err(|error| {
            format!("--threads {threads}: cannot be started: {error}; give a smaller number")
        })?;
    }
    interrupt::catch()?;
    match arguments.command {
        Command::Render(arguments) => render::run(arguments, given),
        Command::Resume(arguments) => resume::run(&arguments, parse_render),
        Command::Picture(arguments) => picture::run(&arguments, given),
        Command::Merge(arguments) => merge::run(&arguments),
        Command::Compare(arguments) => compare::run(&arguments, given),
        Command::Denoise(arguments) => denoise::run(&arguments, given),
        Command::Inspect(arguments) => inspect::run(&arguments),
        Command::Devices(arguments) => devices::run(&arguments),
        Command::Scenes => scenes::run(),
        Command::Bench(command) => bench::run(&command, given),
    }
}

/// Reads the words of a command that renders, without the program's name.
fn parse_render(words: &[String]) -> Result<(render::RenderArguments, Given), String> {
    let words = std::iter::once("raystream").chain(words.iter().map(String::as_str));
    let matches = Arguments::command().try_get_matches_from(words);
    let matches = matches.map_err(|error| error.to_string())?;
    match Arguments::from_arg_matches(&matches).map_err(|error| error.to_string())?.command {
        Command::Render(arguments) => Ok((arguments, Given::of(&matches))),
        _ => Err("it renders nothing".to_owned()),
    }
}

/// Without a desktop, the layer of Mesa that picks the desktop's GPU complains on stderr at every
/// start of Vulkan: leaves it out.
fn silence_device_selection() {
    let has_desktop = ["DISPLAY", "WAYLAND_DISPLAY", "XDG_RUNTIME_DIR"]
        .iter()
        .any(|name| std::env::var_os(name).is_some());
    if !has_desktop {
        // SAFETY: `main` calls this first, while the process has no other thread that could read
        // the environment.
        unsafe { std::env::set_var("NODEVICE_SELECT", "1") };
    }
}

/// Sends the program's and the libraries' messages to stderr; warnings and errors always, more by
/// `verbose`. The variable `RUST_LOG` overrides.
fn start_logging(verbose: u8) {
    use tracing_subscriber::filter::EnvFilter;
    let default = match verbose {
        0 => "warn",
        1 => "raystream=debug,warn",
        _ => "debug",
    };
    let filter = EnvFilter::try_from_default_env().unwrap_or_else(|_| EnvFilter::new(default));
    // Fails only where a test harness has set a subscriber of its own, which then stays.
    let _ = tracing_subscriber::fmt()
        .with_env_filter(filter)
        .with_writer(std::io::stderr)
        .with_ansi(std::io::IsTerminal::is_terminal(&std::io::stderr()))
        .without_time()
        .with_target(false)
        // By default it reports a closed stderr on stderr, and panics.
        .log_internal_errors(false)
        .try_init();
}

/// A panic is a bug: say so in one line, and where, and end with the status of an error.
fn report_panics() {
    std::panic::set_hook(Box::new(|panic| {
        let message = panic.payload_as_str().unwrap_or("unknown");
        let place = panic.location().map_or_else(String::new, |location| format!(" at {location}"));
        output::say(&format!(
            "error: a bug in raystream: {message}{place}; please report it with the command that \
             you ran"
        ));
        std::process::exit(i32::from(FAILED));
    }));
}
