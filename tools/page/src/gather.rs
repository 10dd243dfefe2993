//! Puts the page's files together.

use crate::sections::without_custom;
use crate::wasm::root;
use crate::wgsl;
use anyhow::{Context, Result};
use flate2::Compression;
use flate2::write::GzEncoder;
use std::fs;
use std::io::Write;
use std::path::Path;

/// Where the page's own files are.
const STATIC: &str = "crates/web/page";

/// Writes the page to `folder`: its own files, the library, and the kernels for GPUs. Returns how
/// many bytes that are.
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
    let module = fs::read(library).with_context(|| format!("cannot read {}", library.display()))?;
    bytes += compress(&without_custom(&module)?, &folder.join("raystream.wasm.gz"))?;
    let kernels = serde_json::to_vec(&wgsl::kernels()?).context("cannot write the kernels")?;
    Ok(bytes + compress(&kernels, &folder.join("kernels.json.gz"))?)
}

/// Writes bytes as gzip, which the page takes apart: so they are few from every server.
fn compress(bytes: &[u8], to: &Path) -> Result<u64> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(bytes).context("cannot compress a file")?;
    let bytes = encoder.finish().context("cannot compress a file")?;
    fs::write(to, &bytes).with_context(|| format!("cannot write {}", to.display()))?;
    Ok(bytes.len() as u64)
}

fn copy(from: &Path, to: &Path) -> Result<u64> {
    fs::copy(from, to)
        .with_context(|| format!("cannot copy {} to {}", from.display(), to.display()))
}
