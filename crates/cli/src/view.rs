//! `raystream view`: opens the window, which is a program of its own.

use super::ending::{CliError, Ending};
use clap::Args;
use std::env::consts::EXE_SUFFIX;
use std::ffi::OsString;
use std::io::ErrorKind;
use std::path::PathBuf;
use std::process::Command;

/// What the window's program is told.
#[derive(Args)]
pub struct ViewArguments {
    /// A scene, and options of the program raystream-view: `raystream view --help` lists them.
    #[arg(trailing_var_arg = true, allow_hyphen_values = true, value_name = "SCENE AND OPTIONS")]
    arguments: Vec<OsString>,
}

/// The window's program: that beside this one, or else that in PATH.
fn program() -> PathBuf {
    let name = format!("raystream-view{EXE_SUFFIX}");
    let beside = std::env::current_exe().ok().map(|own| own.with_file_name(&name));
    beside.filter(|path| path.is_file()).unwrap_or_else(|| PathBuf::from(name))
}

/// Opens the window, and returns when it has closed.
pub fn run(arguments: &ViewArguments) -> Result<Ending, CliError> {
    let program = program();
    // As many as this program was told to use.
    let threads = rayon::current_num_threads().to_string();
    let mut window = Command::new(&program);
    match window.args(&arguments.arguments).env("RAYON_NUM_THREADS", threads).status() {
        Ok(status) if status.success() => Ok(Ending::Done),
        // It has said why.
        Ok(status) => Err(format!("the window's program failed ({status})").into()),
        Err(error) if error.kind() == ErrorKind::NotFound => Err(
            "the window is a program of its own, raystream-view, which is neither beside this one \
             nor in PATH; `cargo build --release -p raystream-view` builds it, `cargo install \
             --path crates/view` installs it"
                .into(),
        ),
        Err(error) => Err(format!("cannot run {}: {error}", program.display()).into()),
    }
}
