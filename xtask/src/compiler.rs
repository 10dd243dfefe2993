//! Finds or installs the SPIR-V compiler and runs it.

use anyhow::{Context, Result, bail, ensure};
use cargo_gpu_install::install::Install;
use spirv_builder::{ModuleResult, ShaderPanicStrategy, SpirvBuilder, SpirvMetadata};
use std::env;
use std::ffi::OsString;
use std::fs;
use std::path::Path;
use std::process::Command;

/// SPIR-V 1.3 is what every Vulkan 1.1 device takes. The generic target rather than Vulkan's: see
/// [`crate::module`].
const TARGET: &str = "spirv-unknown-spv1.3";
/// Names a rustup toolchain that the backend was built for.
const TOOLCHAIN: &str = "RUST_GPU_TOOLCHAIN";
/// Path of the backend's dynamic library.
const BACKEND: &str = "RUSTC_CODEGEN_SPIRV";

/// The feature of the shader crate with which kernels check every index.
const BOUNDS_CHECKS: &str = "bounds-checks";

/// Compiles the crate in the folder `shader_crate` to one SPIR-V module, as the compiler leaves it;
/// with kernels that check every index, if `bounds_checks`.
pub fn compile(shader_crate: &Path, bounds_checks: bool) -> Result<Vec<u8>> {
    let mut builder = configure(shader_crate)?
        .release(true)
        .multimodule(false)
        .spirv_metadata(SpirvMetadata::None)
        // A thread that panics leaves the kernel; the host tests are where a panic is seen.
        .shader_panic_strategy(ShaderPanicStrategy::SilentExit);
    builder.shader_crate_features.features =
        bounds_checks.then(|| BOUNDS_CHECKS.to_owned()).into_iter().collect();
    let compiled = builder
        .build()
        .context("the kernels did not compile to SPIR-V; the compiler's messages are above")?;
    let ModuleResult::SingleModule(path) = compiled.module else {
        bail!("the compiler made several SPIR-V modules of the kernels, where one was asked for");
    };
    fs::read(&path)
        .with_context(|| format!("cannot read what the compiler wrote, {}", path.display()))
}

/// A builder that uses the compiler that the environment names, or one that is installed now.
fn configure(shader_crate: &Path) -> Result<SpirvBuilder> {
    match (variable(TOOLCHAIN), variable(BACKEND)) {
        (Some(toolchain), Some(backend)) => {
            let Ok(toolchain) = toolchain.into_string() else { bail!("{TOOLCHAIN} is not UTF-8") };
            check_toolchain(&toolchain)?;
            let mut builder =
                SpirvBuilder::new(shader_crate, TARGET).rustc_codegen_spirv_location(backend);
            builder.toolchain_overwrite = Some(toolchain);
            Ok(builder)
        }
        (None, None) => {
            eprintln!(
                "Installing the SPIR-V compiler, unless it is there; the first time takes some \
                 minutes."
            );
            let install = Install::from_shader_crate(shader_crate.to_path_buf());
            let backend = install.run().with_context(|| {
                format!(
                    "cannot install the SPIR-V compiler, which needs rustup and the internet. \
                     Where there is none, set {TOOLCHAIN} to a rustup toolchain and {BACKEND} to \
                     the path of a backend of rust-gpu 0.10.0 built for it"
                )
            })?;
            Ok(backend.to_spirv_builder(shader_crate, TARGET))
        }
        _ => {
            bail!("set both {TOOLCHAIN} and {BACKEND}, or neither, to have the compiler installed")
        }
    }
}

/// Fails when rustup cannot run `toolchain`, of which the builder would make a panic.
fn check_toolchain(toolchain: &str) -> Result<()> {
    let output = Command::new("rustc")
        .args([&format!("+{toolchain}"), "--version"])
        .output()
        .context("cannot run rustc, which rustup installs")?;
    ensure!(
        output.status.success(),
        "the toolchain {toolchain}, which {TOOLCHAIN} names, does not run: {}",
        String::from_utf8_lossy(&output.stderr).trim()
    );
    Ok(())
}

/// The value of an environment variable; an empty one counts as not set.
fn variable(name: &str) -> Option<OsString> {
    env::var_os(name).filter(|value| !value.is_empty())
}
