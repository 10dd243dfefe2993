//! Raystream's developer commands.
//!
//! `cargo shaders` compiles the kernels to the SPIR-V module that the renderer embeds. The module
//! is checked in, so that building the renderer takes nothing but stable Rust; whoever changes a
//! kernel runs this and commits the result.
//!
//! `cargo xtask renders` lists digests of what a program renders: whoever changes code and means to
//! change no picture compares the lists from before and after.
//!
//! `cargo xtask shapes` makes the shapes of scenes.

mod compiler;
mod digest;
mod module;
mod pipelines;
mod renders;
mod shaders;
mod shapes;

use clap::{Parser, Subcommand};
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
    /// List digests of what a program renders, to find out whether a change to the code changed any
    /// picture.
    ///
    /// Renders every shipped scene with every integrator, allocator and device, small and with few
    /// samples, and prints a line for each: SHA-256 of the pixels of all layers, scene, integrator,
    /// allocator, device. The large scenes are left out unless SCENES_DIR says where their geometry
    /// is. The allocator `atomic`, whose sums depend on the order of threads, renders everything
    /// twice, with a single thread where the device is one that lets it; where the two differ, the
    /// list has `varies`, and comparisons leave it undecided. A GPU's digests hold for its model
    /// and driver.
    ///
    /// Example: `cargo xtask renders --binary before/raystream > renders.txt`, then `cargo xtask
    /// renders --binary after/raystream --against renders.txt`.
    Renders(renders::Arguments),
    /// Write the shapes that scenes of the project's own making are put together from, to
    /// scenes/shapes.
    Shapes {
        /// Write nothing; compare with the files that are there and exit with status 1 when they
        /// differ.
        #[arg(long)]
        check: bool,
    },
}

/// How a command ended that did not fail, with what to tell the user.
enum Outcome {
    /// All is as it should be.
    Good(String),
    /// Something is not: exit status 1.
    Bad(String),
}

fn main() -> ExitCode {
    let outcome = match Arguments::parse().command {
        Command::Shaders { check: true, .. } => shaders::check(),
        Command::Shaders { bounds_checks, .. } => shaders::write(bounds_checks),
        Command::Pipelines { module } => pipelines::print(&module)
            .map(|()| Outcome::Good("That is what the driver says.".into())),
        Command::Renders(arguments) => renders::run(&arguments),
        Command::Shapes { check } => shapes::run(check),
    };
    match outcome {
        Ok(Outcome::Good(message)) => {
            eprintln!("{message}");
            ExitCode::SUCCESS
        }
        Ok(Outcome::Bad(message)) => {
            eprintln!("error: {message}");
            ExitCode::from(1)
        }
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::from(2)
        }
    }
}
