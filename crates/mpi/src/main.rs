//! The `raystream-mpi` binary: renders by several processes that `mpirun` starts.
//!
//! All run the same command. The first one has the film, the errors and the streams, and the others
//! trace for it, as other devices of one process do (`render/team` of the library). One thread of
//! each process calls MPI ([`office`]); the program runs in another.

#![warn(
    clippy::print_stderr,
    clippy::print_stdout,
    reason = "they panic where the reader has gone away, as in `| head`"
)]

mod office;
mod post;
mod processes;
mod transfer;

use clap::{CommandFactory, FromArgMatches, Parser};
use mpi::Threading;
use office::{Closed, Office};
use post::Mail;
use processes::MpiProcesses;
use raystream_cli::{
    CliError, Ending, FAILED, Given, Processes, ProgramArguments, RenderCommand, catch_signals,
    exit_status, ignore_signals, quiet_drivers, say, silence, with_hint,
};
use std::process::ExitCode;
use std::thread;

/// Renders by several processes, on one machine or several: `mpirun -n 4 raystream-mpi render ...`.
///
/// All processes are given the same command line. Each loads the scene and opens the devices that
/// --device names; the first one keeps the film and writes the pictures. The film is that of one
/// process, bit for bit, where all devices are of one kind. What else Raystream can do, the program
/// `raystream` does.
#[derive(Parser)]
#[command(name = "raystream-mpi", version, max_term_width = 100)]
struct Arguments {
    #[command(subcommand)]
    command: RenderCommand,
    #[command(flatten)]
    program: ProgramArguments,
}

fn main() -> ExitCode {
    // SAFETY: this is the first that the program does, in its only thread.
    unsafe { quiet_drivers() };
    let Some((universe, threading)) = mpi::initialize_with_threading(Threading::Funneled) else {
        say("error: MPI has been started before; this is a bug of raystream-mpi");
        return ExitCode::from(FAILED);
    };
    if threading < Threading::Funneled {
        say("error: this MPI allows no threads beside its own; use one that has been built with \
             support of threads");
        return ExitCode::from(FAILED);
    }
    let (mut office, post, greetings) = Office::open(universe.world());
    let host = mpi::environment::processor_name().unwrap_or_else(|_| "an unnamed machine".into());
    let processes = MpiProcesses::new(post.clone(), greetings, host);
    thread::spawn(move || post.ask(Mail::Close(program(&processes))));
    match office.work() {
        Closed::Together(status) => {
            drop(universe);
            ExitCode::from(status)
        }
        Closed::WithoutSome(status) => {
            // MPI would wait at its end for those that are lost.
            std::mem::forget(universe);
            ExitCode::from(status)
        }
        Closed::Abandoned => {
            std::mem::forget(universe);
            tracing::error!("the first process is gone");
            ExitCode::from(FAILED)
        }
    }
}

/// The program of this process. Returns its exit status.
fn program(processes: &MpiProcesses) -> u8 {
    let is_helper = processes.is_helper();
    if is_helper {
        silence();
    }
    let parsed = Arguments::command().try_get_matches();
    let parsed = parsed
        .and_then(|matches| Ok((Arguments::from_arg_matches(&matches)?, Given::of(&matches))));
    let (arguments, given) = match parsed {
        Ok(parsed) => parsed,
        Err(error) => {
            // The first process says it for all.
            if !is_helper {
                let _ = error.print();
            }
            return error.exit_code() as u8;
        }
    };
    arguments.program.start_logging();
    let ended = run(arguments, &given, processes);
    if is_helper && let Err(error) = &ended {
        processes.refuse(with_hint(error.as_ref()));
    }
    exit_status(ended)
}

fn run(arguments: Arguments, given: &Given, processes: &MpiProcesses) -> Result<Ending, CliError> {
    arguments.program.start_threads()?;
    // The first process ends a render for all. `mpirun` passes signals on to every one.
    if processes.is_helper() {
        ignore_signals()?;
    } else {
        catch_signals()?;
    }
    arguments.command.run(given, processes)
}
