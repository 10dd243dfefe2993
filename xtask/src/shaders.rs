//! `cargo shaders`: writes the compiled kernels, or checks that the checked-in ones are current.

use crate::digest::{self, DIGEST, MODULE};
use crate::{Outcome, compiler, module};
use anyhow::{Context, Result};
use std::fs;
use std::path::Path;

/// Compiles the kernels, and writes the module and the digest of what it was compiled from. Kernels
/// that check every index are for debugging: [`check`] finds them stale.
pub fn write(bounds_checks: bool) -> Result<Outcome> {
    let root = root()?;
    let module = compile(root, bounds_checks)?;
    let path = root.join(MODULE);
    let unchanged = fs::read(&path).is_ok_and(|old| old == module);
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder)
            .with_context(|| format!("cannot create {}", folder.display()))?;
    }
    fs::write(&path, &module).with_context(|| format!("cannot write {MODULE}"))?;
    fs::write(root.join(DIGEST), digest::current(root)?)
        .with_context(|| format!("cannot write {DIGEST}"))?;
    let change = if unchanged { "unchanged" } else { "changed" };
    Ok(Outcome::Good(format!("{MODULE}: {} bytes, {change}", module.len())))
}

/// Compiles the kernels and compares with the checked-in module and digest.
pub fn check() -> Result<Outcome> {
    let root = root()?;
    let compiled = compile(root, false)?;
    let module = fs::read(root.join(MODULE))
        .with_context(|| format!("cannot read {MODULE}; run `cargo shaders`"))?;
    if let Some(difference) = first_difference(&compiled, &module) {
        return Ok(Outcome::Bad(format!(
            "{MODULE} is stale: it has {} bytes, the sources compile to {}, and they differ from \
             offset {difference} on; run `cargo shaders` and commit the result",
            module.len(),
            compiled.len(),
        )));
    }
    let digest = fs::read_to_string(root.join(DIGEST))
        .with_context(|| format!("cannot read {DIGEST}; run `cargo shaders`"))?;
    if !digest.lines().eq(digest::current(root)?.lines()) {
        return Ok(Outcome::Bad(format!(
            "{DIGEST} is stale, though {MODULE} is not; run `cargo shaders` and commit the result"
        )));
    }
    Ok(Outcome::Good(format!("{MODULE} is what the sources compile to")))
}

fn compile(root: &Path, bounds_checks: bool) -> Result<Vec<u8>> {
    module::finish(&compiler::compile(&root.join("shader-crate"), bounds_checks)?)
}

/// The repository's root, wherever the command was called.
fn root() -> Result<&'static Path> {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().context("xtask has no folder above it")
}

fn first_difference(a: &[u8], b: &[u8]) -> Option<usize> {
    let differing = a.iter().zip(b).position(|(a, b)| a != b);
    differing.or((a.len() != b.len()).then_some(a.len().min(b.len())))
}
