//! Compiles the library to WebAssembly.

use anyhow::{Context, Result, bail, ensure};
use std::env;
use std::path::{Path, PathBuf};
use std::process::Command;

const TARGET: &str = "wasm32-unknown-unknown";
const PACKAGE: &str = "raystream-web";
/// Names a toolchain that has the sources of the standard library.
const TOOLCHAIN: &str = "RUST_GPU_TOOLCHAIN";

/// Random numbers are the page's; vectors of four numbers have registers of their own, in every
/// browser since 2023.
const FLAGS: &str = r#"--cfg getrandom_backend="custom" -Ctarget-feature=+simd128"#;

/// Compiles the library. Returns where it is.
///
/// # Errors
/// If there is neither a standard library for WebAssembly nor its sources, or the compiler fails.
pub fn build() -> Result<PathBuf> {
    let mut command = Command::new("cargo");
    // Those of the cargo that runs this program are about this program.
    command.env_remove("RUSTUP_TOOLCHAIN").env("RUSTFLAGS", FLAGS).current_dir(root()?);
    if !has_target()? {
        from_source(&mut command)?;
    }
    command.args(["build", "--locked", "--release", "--lib", "--package", PACKAGE]);
    command.args(["--target", TARGET]);
    let status = command.status().context("cannot run cargo")?;
    ensure!(status.success(), "the library did not compile; the compiler's messages are above");
    Ok(target_folder()?.join(TARGET).join("release/raystream_web.wasm"))
}

/// Has the standard library compiled from the sources that a toolchain has, with the linker that
/// the usual one has.
fn from_source(command: &mut Command) -> Result<()> {
    let toolchain = env::var(TOOLCHAIN).ok().filter(|name| !name.is_empty());
    let Some(toolchain) = toolchain else {
        bail!(
            "there is no standard library for WebAssembly: run `rustup target add {TARGET}`. \
             Where there is no internet, set {TOOLCHAIN} to a rustup toolchain with the component \
             rust-src"
        )
    };
    eprintln!("Compiling the standard library with the toolchain {toolchain}, too.");
    let linker = linker()?;
    command.arg(format!("+{toolchain}")).arg("-Zbuild-std=std,panic_abort");
    command.env("RUSTC_BOOTSTRAP", "1");
    command.env("CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER", linker);
    Ok(())
}

/// Whether the usual toolchain has the standard library for WebAssembly.
fn has_target() -> Result<bool> {
    let folder = rustc(&["--target", TARGET, "--print", "target-libdir"])?;
    Ok(Path::new(&folder).is_dir())
}

/// The linker that comes with the usual toolchain.
fn linker() -> Result<PathBuf> {
    let version = rustc(&["-vV"])?;
    let host = version.lines().find_map(|line| line.strip_prefix("host: "));
    let host = host.context("rustc -vV names no host")?;
    let name = format!("rust-lld{}", env::consts::EXE_SUFFIX);
    Ok(Path::new(&rustc(&["--print", "sysroot"])?)
        .join("lib/rustlib")
        .join(host)
        .join("bin")
        .join(name))
}

/// What the usual `rustc` prints.
fn rustc(arguments: &[&str]) -> Result<String> {
    let mut command = Command::new("rustc");
    command.args(arguments).env_remove("RUSTUP_TOOLCHAIN").current_dir(root()?);
    let output = command.output().context("cannot run rustc, which rustup installs")?;
    ensure!(
        output.status.success(),
        "rustc {} failed: {}",
        arguments.join(" "),
        String::from_utf8_lossy(&output.stderr).trim()
    );
    Ok(String::from_utf8_lossy(&output.stdout).trim().to_owned())
}

/// Cargo's folder for what it builds.
pub fn target_folder() -> Result<PathBuf> {
    // This program lies in it, in a folder named after its profile.
    let program = env::current_exe().context("cannot find this program")?;
    let folder = program.parent().and_then(Path::parent);
    Ok(folder.context("this program is in no folder of Cargo's")?.to_owned())
}

/// The repository's root, wherever the command was called.
pub fn root() -> Result<&'static Path> {
    let above = Path::new(env!("CARGO_MANIFEST_DIR")).ancestors().nth(2);
    above.context("the tool has no folder above it")
}
