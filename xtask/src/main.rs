//! Raystream's developer commands.
//!
//! `cargo shaders` compiles the kernels to the SPIR-V module that the renderer embeds. The module
//! is checked in, so that building the renderer takes nothing but stable Rust; whoever changes a
//! kernel runs this and commits the result.
#![deny(missing_docs)]

mod compiler;
mod digest;
mod module;
mod pipelines;
mod shaders;

use clap::{Parser, Subcommand};
use shaders::Outcome;
use std::process::ExitCode;

/// Raystream's developer commands.
#[derive(Parser)]
#[command(name = "cargo xtask")]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Compile shader-crate to host-crate/shaders/kernels.spv.
    ///
    /// The compiler is the one that RUST_GPU_TOOLCHAIN (a rustup toolchain) and RUSTC_CODEGEN_SPIRV
    /// (path of the backend's library) name. When they are not set, it is installed first, from the
    /// internet.
    Shaders {
        /// Write nothing; compile, compare with the checked-in files and exit with status 1 when
        /// they differ.
        #[arg(long)]
        check: bool,
        /// Have the kernels check every index, and end a thread that is wrong: for finding bugs,
        /// not to be committed.
        #[arg(long, conflicts_with = "check")]
        bounds_checks: bool,
    },
    /// Print what the first GPU's Vulkan driver makes of each kernel: registers, spills, ...
    Pipelines {
        /// The SPIR-V module.
        #[arg(default_value = digest::MODULE)]
        module: std::path::PathBuf,
    },
}

fn main() -> ExitCode {
    let outcome = match Arguments::parse().command {
        Command::Shaders { check: true, .. } => shaders::check(),
        Command::Shaders { bounds_checks, .. } => shaders::write(bounds_checks),
        Command::Pipelines { module } => {
            pipelines::print(&module).map(|()| Outcome::UpToDate("as the driver says".into()))
        }
    };
    match outcome {
        Ok(Outcome::UpToDate(message)) => {
            eprintln!("{message}");
            ExitCode::SUCCESS
        }
        Ok(Outcome::Stale(message)) => {
            eprintln!("error: {message}");
            ExitCode::from(1)
        }
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::from(2)
        }
    }
}
