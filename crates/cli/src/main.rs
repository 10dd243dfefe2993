//! The `raystream` binary: the command line.

use std::process::ExitCode;

fn main() -> ExitCode {
    raystream_cli::main()
}
