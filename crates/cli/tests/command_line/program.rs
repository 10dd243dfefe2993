//! Runs of the program in a folder of their own.

pub use raystream_tests::Run;
use std::ffi::OsStr;
use std::path::Path;
use std::process::{Command, Stdio};

/// The program with `arguments`, in `folder`, with nothing to read from stdin.
pub fn program<A: AsRef<OsStr>>(folder: &Path, arguments: &[A]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_raystream"));
    command
        .args(arguments)
        .current_dir(folder)
        .stdin(Stdio::null())
        .env_remove("RUST_LOG")
        .env_remove("SCENES_DIR");
    command
}

/// Runs the program with `arguments`, split at spaces, in `folder`.
#[track_caller]
pub fn run(folder: &Path, arguments: &str) -> Run {
    let arguments: Vec<_> = arguments.split_whitespace().collect();
    Run::new(program(folder, &arguments).output().expect("the program starts"))
}

/// Renders on the CPU with more `arguments`, split at spaces.
#[track_caller]
pub fn render(folder: &Path, arguments: &str) -> Run {
    run(folder, &format!("render --device cpu {arguments}"))
}

/// Names of all files in a folder, hidden ones too, sorted.
pub fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> = std::fs::read_dir(folder)
        .unwrap()
        .map(|e| e.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

/// A line of a CSV file: its fields by name.
pub type Row = std::collections::HashMap<String, String>;

/// The lines of a CSV file.
pub fn csv(path: &Path) -> Vec<Row> {
    let text =
        std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let mut lines = text.lines().map(|line| line.split(',').map(str::to_owned).collect::<Vec<_>>());
    let header = lines.next().expect("a header");
    lines.map(|line| header.iter().cloned().zip(line).collect()).collect()
}
