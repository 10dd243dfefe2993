//! The program `raystream-view`.

use std::process::ExitCode;

fn main() -> ExitCode {
    raystream_view::program::main()
}
