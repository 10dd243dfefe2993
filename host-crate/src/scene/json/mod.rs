//! Scene files of format 1: JSON that names an OBJ, and says what its materials are, what lights it
//! and where it is seen from.

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
use super::formats::SceneBytes;
use super::obj::{Obj, Part};
use super::options::LoadOptions;
use super::ply;
use super::recentre::origin_of;
use super::source::Source;
use glam::DVec3;
use serde::de::Error as _;
use std::collections::HashSet;
use std::path::Path;

/// Loads a scene from its scene file.
pub(super) fn load(
    source: &dyn Source,
    SceneBytes { path, folder, bytes }: SceneBytes<'_>,
    options: LoadOptions,
) -> Result<Scene, SceneError> {
    let file = SceneFile::parse(path, bytes)?;
    let names = Names { source, scene: path, folder };
    let obj_path = names.find("obj", &file.obj, &[folder])?;
    let obj_text = source.read(&obj_path, options.geometry_bytes())?;
    let smooth = file.normals == Normals::Smooth;
    let obj = if ply::is_ply(&obj_text) {
        ply::parse(&obj_path, &obj_text, smooth, options.max_memory)?
    } else {
        Obj::parse(&obj_path, &obj_text, smooth, options.max_memory)?
    };
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
