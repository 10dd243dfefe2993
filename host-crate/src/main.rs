//! The `raystream` binary.

fn main() -> std::process::ExitCode {
    raystream::cli::main()
}
