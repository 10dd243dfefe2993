//! Puts the page's files together.

use crate::wasm::root;
use anyhow::{Context, Result};
use std::fs;
use std::path::Path;

/// Where the page's own files are.
const STATIC: &str = "crates/web/page";

/// Writes the page to `folder`: its own files, and the library. Returns how many bytes that are.
///
/// # Errors
/// If a file cannot be read or written.
pub fn write(library: &Path, folder: &Path) -> Result<u64> {
    fs::create_dir_all(folder).with_context(|| format!("cannot create {}", folder.display()))?;
    let own = root()?.join(STATIC);
    let entries = fs::read_dir(&own).with_context(|| format!("cannot read {}", own.display()))?;
    let mut bytes = 0;
    for entry in entries {
        let entry = entry.with_context(|| format!("cannot read {}", own.display()))?;
        bytes += copy(&entry.path(), &folder.join(entry.file_name()))?;
    }
    Ok(bytes + copy(library, &folder.join("raystream.wasm"))?)
}

fn copy(from: &Path, to: &Path) -> Result<u64> {
    fs::copy(from, to)
        .with_context(|| format!("cannot copy {} to {}", from.display(), to.display()))
}
