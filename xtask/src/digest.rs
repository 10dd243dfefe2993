//! What the checked-in SPIR-V was compiled from, as a text file of digests.
//!
//! Compiling needs a special compiler; comparing digests does not. So every `cargo test` can tell
//! that a kernel was changed and not compiled. It cannot tell that the module is right: that is
//! what `cargo shaders --check` does.

use sha2::{Digest, Sha256};
use std::fmt::Write;
use std::fs;
use std::io::{Error, ErrorKind, Result};
use std::path::Path;

/// The SPIR-V module, relative to the repository's root.
pub const MODULE: &str = "host-crate/shaders/kernels.spv";
/// The text file of digests, relative to the repository's root.
pub const DIGEST: &str = "host-crate/shaders/kernels.digest";

/// The packages whose code becomes part of the kernels. Others in the shader crate's tree run on
/// the host only.
const PACKAGES: [&str; 6] =
    ["glam", "libm", "num-traits", "spirv-std", "spirv-std-macros", "spirv-std-types"];

/// What [`DIGEST`] must say, given the sources and the [`MODULE`] that lie under `root`: a line per
/// locked package, per source file of the shader crate and for the module.
///
/// # Errors
///
/// When a file cannot be read, or Cargo.lock lacks a package; the message names it.
pub fn current(root: &Path) -> Result<String> {
    let mut text = String::from("# Written by `cargo shaders`, read by the tests.\n");
    let lock = String::from_utf8_lossy(&read(root, "Cargo.lock")?).into_owned();
    for package in PACKAGES {
        for version in locked_versions(&lock, package)? {
            push_line(&mut text, &version, package);
        }
    }
    let mut sources = vec!["shader-crate/Cargo.toml".to_owned()];
    list_rust_files(root, "shader-crate/src", &mut sources)?;
    sources.sort();
    for source in sources {
        // A checkout may have turned line ends into those of its system, in comments and code
        // alike.
        let contents = String::from_utf8_lossy(&read(root, &source)?).replace("\r\n", "\n");
        push_line(&mut text, &sha256(contents.as_bytes()), &source);
    }
    push_line(&mut text, &sha256(&read(root, MODULE)?), MODULE);
    Ok(text)
}

fn push_line(text: &mut String, value: &str, name: &str) {
    text.push_str(value);
    text.push_str("  ");
    text.push_str(name);
    text.push('\n');
}

/// The versions of `package` in the text of a Cargo.lock, in its order.
fn locked_versions(lock: &str, package: &str) -> Result<Vec<String>> {
    let name = format!("name = \"{package}\"");
    let version =
        |line: &str| line.strip_prefix("version = \"")?.strip_suffix('"').map(str::to_owned);
    let lines = || lock.lines();
    let versions: Vec<_> = lines()
        .zip(lines().skip(1))
        .filter(|(first, _)| *first == name)
        .filter_map(|(_, next)| version(next))
        .collect();
    if versions.is_empty() {
        let message =
            format!("Cargo.lock has no package {package}; correct the list in xtask/src/digest.rs");
        return Err(Error::new(ErrorKind::NotFound, message));
    }
    Ok(versions)
}

/// Appends the Rust files under `folder`, as paths relative to `root` with forward slashes. Others
/// are what editors and tools leave.
fn list_rust_files(root: &Path, folder: &str, files: &mut Vec<String>) -> Result<()> {
    let path = root.join(folder);
    for entry in fs::read_dir(&path).map_err(|error| name_path(&path, &error))? {
        let entry = entry.map_err(|error| name_path(&path, &error))?;
        let child = format!("{folder}/{}", entry.file_name().to_string_lossy());
        if entry.path().is_dir() {
            list_rust_files(root, &child, files)?;
        } else if child.ends_with(".rs") {
            files.push(child);
        }
    }
    Ok(())
}

fn read(root: &Path, file: &str) -> Result<Vec<u8>> {
    let path = root.join(file);
    fs::read(&path).map_err(|error| name_path(&path, &error))
}

fn name_path(path: &Path, error: &Error) -> Error {
    Error::new(error.kind(), format!("{}: {error}", path.display()))
}

fn sha256(bytes: &[u8]) -> String {
    hexadecimal(&Sha256::digest(bytes))
}

/// Two digits for each of `bytes`.
pub fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut text, byte| {
        // Writing to a String cannot fail.
        let _ = write!(text, "{byte:02x}");
        text
    })
}
