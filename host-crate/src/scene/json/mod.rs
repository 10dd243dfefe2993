//! Scene files of format 1: JSON that names an OBJ, and says what its materials are, what lights it
//! and where it is seen from.

mod clean;
mod defects;
mod format;
mod libraries;
mod material;
mod names;
mod parts;
mod remarks;
mod values;
mod wrong_kind;

use self::format::{Normals, SceneFile};
use self::names::Names;
use self::parts::Parts;
use self::values::Object;
use super::bounds;
use super::description::{DARK, Scene};
use super::error::SceneError;
use super::obj::{Obj, Part};
use super::options::LoadOptions;
use super::recentre::origin_of;
use super::source::Source;
use glam::DVec3;
use serde::de::Error as _;
use std::collections::HashSet;
use std::path::Path;

/// The text of a scene file.
#[derive(Clone, Copy)]
pub(super) struct SceneText<'a> {
    /// What the file is called in messages.
    pub path: &'a Path,
    /// The folder that its paths start from.
    pub folder: &'a Path,
    pub text: &'a [u8],
}

/// Loads a scene file of format 1 whose files are in `source`.
pub(super) fn load_from(
    source: &dyn Source,
    path: &Path,
    options: LoadOptions,
) -> Result<Scene, SceneError> {
    let text = &source.read(path, options.text_bytes())?;
    let folder = if is_descriptor(path) { Path::new("") } else { parent(path) };
    load_text(source, SceneText { path, folder, text }, options)
}

/// Whether a path is one of the program's open files: beside `/dev/stdin` there are no files.
fn is_descriptor(path: &Path) -> bool {
    let of_process = path.starts_with("/proc") && parent(path).ends_with("fd");
    path == Path::new("/dev/stdin") || path.starts_with("/dev/fd") || of_process
}

/// Loads a scene from the text of its scene file.
pub(super) fn load_text(
    source: &dyn Source,
    SceneText { path, folder, text }: SceneText<'_>,
    options: LoadOptions,
) -> Result<Scene, SceneError> {
    let file = SceneFile::parse(path, text)?;
    let names = Names { source, scene: path, folder };
    let obj_path = names.find("obj", &file.obj, &[folder])?;
    let obj_text = source.read(&obj_path, options.obj_bytes())?;
    let smooth = file.normals == Normals::Smooth;
    let obj = Obj::parse(&obj_path, &obj_text, smooth, options.max_memory)?;
    check_overrides(path, &file, &obj)?;

    let origin = origin_of(obj.parts.iter().map(Part::positions));
    let camera = file.camera(origin).map_err(|what| wrong_key(path, "camera", &what))?;
    let mut scene = Scene::new(camera, file.film());
    scene.name = file.name.clone();
    scene.limits = file.limits();
    let mut parts = Parts::new(&file, names, (&obj_path, &obj_text), origin, options);
    parts.read_libraries(&obj, &mut scene)?;
    for part in &obj.parts {
        parts.add(part, &mut scene)?;
    }
    parts.finish(&obj, &mut scene);
    add_quads(path, &file, origin, &mut scene)?;
    warn_of_the_whole(path, origin, &mut scene);
    Ok(scene)
}

fn add_quads(
    path: &Path,
    file: &SceneFile,
    origin: DVec3,
    scene: &mut Scene,
) -> Result<(), SceneError> {
    for (index, Object(quad)) in file.quads.iter().enumerate() {
        let light = quad.light(origin);
        if let Err(what) = bounds::coordinates(&light.corner.to_array()) {
            return Err(wrong_key(path, &format!("quads[{index}].corner"), &what));
        }
        if !light.has_area() {
            let what = "u and v span no area: a quad needs two edges in different directions";
            return Err(wrong_key(path, &format!("quads[{index}]"), what));
        }
        scene.add_quad_light(light);
    }
    Ok(())
}

/// Says what the user should know of the scene as a whole.
fn warn_of_the_whole(path: &Path, origin: DVec3, scene: &mut Scene) {
    let path = path.display();
    if origin != DVec3::ZERO {
        scene.warnings.push(format!(
            "{path}: the scene is far from the origin; all positions count from ({}, {}, {}), so \
             that none loses its digits.",
            origin.x, origin.y, origin.z
        ));
    }
    if !scene.emits() {
        scene.warnings.push(format!("{path}: {DARK}"));
    }
}

/// An error of the value of a key that shows only when all is known.
fn wrong_key(path: &Path, key: &str, what: &str) -> SceneError {
    SceneError::Json {
        path: path.to_owned(),
        key: key.to_owned(),
        source: serde_json::Error::custom(what),
    }
}

fn parent(path: &Path) -> &Path {
    path.parent().unwrap_or(Path::new(""))
}

fn check_overrides(path: &Path, file: &SceneFile, obj: &Obj) -> Result<(), SceneError> {
    let mut used: Vec<_> = obj.parts.iter().map(|part| part.material.to_string()).collect();
    // A material may have several parts.
    let mut seen = HashSet::new();
    used.retain(|name| seen.insert(name.clone()));
    let names: Vec<_> =
        file.materials.keys().filter(|name| !seen.contains(*name)).cloned().collect();
    if names.is_empty() {
        Ok(())
    } else {
        Err(SceneError::UnknownMaterials { path: path.to_owned(), names, used })
    }
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
}
