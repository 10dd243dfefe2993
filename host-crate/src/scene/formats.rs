//! Which format a scene is of.

use super::description::Scene;
use super::error::SceneError;
use super::options::LoadOptions;
use super::source::{SceneBytes, Source, parent};
use super::{gltf, json, obj, ply};
use serde::Deserialize;
use serde::de::IgnoredAny;
use std::path::Path;

/// Loads a scene whose files are in `source`.
pub(super) fn load_from(
    source: &dyn Source,
    path: &Path,
    options: &LoadOptions,
) -> Result<Scene, SceneError> {
    let limit =
        if by_ending(path).is_some() { options.geometry_bytes() } else { options.text_bytes() };
    let bytes = &source.read(path, limit)?;
    let folder = if is_descriptor(path) { Path::new("") } else { parent(path) };
    load_bytes(source, SceneBytes { path, folder, bytes }, options)
}

/// Loads a scene from its file.
pub(super) fn load_bytes(
    source: &dyn Source,
    file: SceneBytes<'_>,
    options: &LoadOptions,
) -> Result<Scene, SceneError> {
    let (format, name) = (Format::of(file.path, file.bytes), file.path.display());
    let mut scene = match format {
        Format::Json => json::load(source, file, options),
        Format::Obj => json::load_obj(source, file, options),
        Format::Gltf => gltf::load(source, file, options),
        Format::Ply => ply::load(file, options),
    }?;
    if let Some(variant) = options.variant.as_ref().filter(|_| format != Format::Gltf) {
        let (path, known) = (file.path.to_owned(), Vec::new());
        return Err(SceneError::UnknownVariant { path, name: variant.clone(), known });
    }
    if options.at.is_some() && format != Format::Gltf {
        let what = "nothing in it moves: whatever the time, it is shown as it stands";
        scene.warnings.push(format!("{name}: {what}."));
    }
    Ok(scene)
}

/// A format of scenes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    /// Scene files of format 1.
    Json,
    /// glTF 2.0, as text or binary.
    Gltf,
    /// Meshes with MTL files.
    Obj,
    /// Meshes alone.
    Ply,
}

impl Format {
    /// The format of a file, by its content or else by the end of its name.
    fn of(path: &Path, bytes: &[u8]) -> Self {
        if gltf::is_binary(bytes) {
            Self::Gltf
        } else if ply::is_ply(bytes) {
            Self::Ply
        } else {
            by_ending(path)
                .or_else(|| is_gltf_text(bytes).then_some(Self::Gltf))
                .or_else(|| obj::is_obj(bytes).then_some(Self::Obj))
                .unwrap_or(Self::Json)
        }
    }
}

/// The format of files of such a name; none if it may be a scene file's.
fn by_ending(path: &Path) -> Option<Format> {
    let ending = path.extension()?.to_str()?;
    let is = |known: &str| ending.eq_ignore_ascii_case(known);
    if is("gltf") || is("glb") {
        Some(Format::Gltf)
    } else if is("obj") {
        Some(Format::Obj)
    } else {
        is("ply").then_some(Format::Ply)
    }
}

/// Whether a text has the one key that every glTF has, and not the one that every scene file has.
fn is_gltf_text(text: &[u8]) -> bool {
    #[derive(Deserialize)]
    struct Keys {
        asset: Option<IgnoredAny>,
        format: Option<IgnoredAny>,
    }
    let keys: Option<Keys> = serde_json::from_slice(text).ok();
    keys.is_some_and(|keys| keys.asset.is_some() && keys.format.is_none())
}

/// Whether a path is one of the program's open files: beside `/dev/stdin` there are no files.
fn is_descriptor(path: &Path) -> bool {
    let of_process = path.starts_with("/proc") && parent(path).ends_with("fd");
    path == Path::new("/dev/stdin") || path.starts_with("/dev/fd") || of_process
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_open_files_have_no_folder() {
        for path in ["/dev/stdin", "/dev/fd/63", "/proc/self/fd/0"] {
            assert!(is_descriptor(Path::new(path)), "{path}");
        }
        for path in ["/dev/shm/scene.json", "/proc/scene.json", "stdin", "fd/0"] {
            assert!(!is_descriptor(Path::new(path)), "{path}");
        }
    }

    #[test]
    fn formats_go_by_content_first() {
        let format = |path: &str, text: &str| Format::of(Path::new(path), text.as_bytes());
        assert_eq!(format("a.json", "{\"format\": 1}"), Format::Json);
        assert_eq!(format("a.json", "glTF\u{2}\0\0\0"), Format::Gltf);
        assert_eq!(format("a.GLTF", "{}"), Format::Gltf);
        assert_eq!(format("-", "{\"asset\": {}}"), Format::Gltf);
        assert_eq!(format("-", "{\"asset\": {}, \"format\": 1}"), Format::Json);
        assert_eq!(format("scan", "ply\r\nformat ascii 1.0"), Format::Ply);
        assert_eq!(format("scan.ply", ""), Format::Ply);
        assert_eq!(format("scan.txt", "plywood"), Format::Json);
        assert_eq!(format("a.OBJ", "# nothing"), Format::Obj);
        assert_eq!(format("-", "# of a program\n\nmtllib a.mtl\n"), Format::Obj);
    }
}
