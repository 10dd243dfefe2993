//! Scene files: JSON that names OBJs, and says where they are, what their materials are, what
//! lights them and where they are seen from. Format 1 has one OBJ, format 2 any number. An OBJ
//! alone is a scene, too: that of a scene file which says nothing else.

mod camera;
mod choice;
mod defects;
mod environment;
mod format;
mod libraries;
mod light;
mod material;
mod names;
mod parts;
mod remarks;
mod surfaces;
mod transform;
mod values;
mod wrong_kind;

use self::choice::MaterialChoice;
use self::format::{FileMesh, Normals, SceneFile};
use self::names::Names;
use self::parts::{Parts, Places};
use self::surfaces::Sources;
use super::bounds;
use super::description::{DARK, Scene};
use super::environment::{Environment, LIT_BY_DEFAULT};
use super::error::SceneError;
use super::framing::{FRAMED, TO_BE_FRAMED};
use super::gltf;
use super::obj::{Obj, Part, Placement};
use super::options::LoadOptions;
use super::picture::Pictures;
use super::ply;
use super::recentre::{origin_of, warn_if_moved};
use super::source::{SceneBytes, Source};
use glam::{DAffine3, DVec3};
use serde::de::Error as _;
use std::borrow::Cow;
use std::collections::HashSet;
use std::path::{Path, PathBuf};

/// Loads a scene from its scene file.
pub(super) fn load(
    source: &dyn Source,
    SceneBytes { path, folder, bytes }: SceneBytes<'_>,
    options: &LoadOptions,
) -> Result<Scene, SceneError> {
    let file = SceneFile::parse(path, bytes)?;
    let names = Names { source, scene: path, folder };
    // They share the memory alike.
    let memory = options.max_memory / file.meshes.len().max(1) as u64;
    let mut meshes = Vec::with_capacity(file.meshes.len());
    for rules in &file.meshes {
        meshes.push(LoadedObj::read(rules, &names, options, memory)?);
    }
    for LoadedObj { rules, obj, .. } in &meshes {
        check_overrides(path, rules, obj)?;
    }
    let mut scene = assemble(&names, &file, &meshes, options)?;
    if !scene.emits() {
        scene.warnings.push(format!("{}: {DARK}", path.display()));
    }
    Ok(scene)
}

/// Loads an OBJ with its MTLs as a scene: all of it is seen, and lit unless something of it emits
/// light.
pub(super) fn load_obj(
    source: &dyn Source,
    SceneBytes { path, folder, bytes }: SceneBytes<'_>,
    options: &LoadOptions,
) -> Result<Scene, SceneError> {
    let file = SceneFile::of_obj(path);
    let names = Names { source, scene: path, folder };
    let obj = Obj::parse(path, bytes, true, options.max_memory)?;
    let (path, text) = (path.to_owned(), Cow::Borrowed(bytes));
    let name = path.display().to_string();
    let meshes = [LoadedObj { rules: &file.meshes[0], path, text, obj }];
    let mut scene = assemble(&names, &file, &meshes, options)?;
    scene.warnings.push(format!("{name}: an OBJ has no camera; {FRAMED}"));
    if !scene.emits() {
        scene.set_environment(Environment::studio());
        scene.warnings.push(format!("{name}: none of it emits light; {LIT_BY_DEFAULT}"));
    }
    Ok(scene)
}

/// The scene of a file and of what it names.
fn assemble(
    names: &Names<'_>,
    file: &SceneFile,
    meshes: &[LoadedObj<'_>],
    options: &LoadOptions,
) -> Result<Scene, SceneError> {
    let path = names.scene;
    let placed = meshes.iter().flat_map(|mesh| {
        let placements = mesh.rules.placements(DVec3::ZERO);
        // Of what stands in many places, some.
        let count = if placements.len() > 1 { SAMPLED } else { usize::MAX };
        let of_part = move |part| {
            let sampled = move |placement: &Placement| placement.positions(part).take(count);
            placements.iter().map(sampled).collect::<Vec<_>>()
        };
        mesh.obj.parts.iter().flat_map(of_part)
    });
    let origin = origin_of(placed);
    let keeps_instances = keeps_instances(path, meshes, options)?;
    let camera = file.camera(origin).map_err(|what| wrong_key(path, "camera", &what))?;
    let mut scene = Scene::new(camera.unwrap_or(TO_BE_FRAMED), file.film);
    scene.name = file.name.clone();
    scene.limits = file.limits();
    scene.background = file.background;
    let mut pictures = Pictures::new(options);
    for LoadedObj { rules, path, text, obj } in meshes {
        let sources = Sources { file, rules, names: *names, obj_path: path };
        let places = Places { origin, keeps_instances };
        let mut parts = Parts::new(sources, text, places, options, pictures);
        parts.read_libraries(obj, &mut scene)?;
        for part in &obj.parts {
            parts.add(part, &mut scene)?;
        }
        pictures = parts.finish(obj, &mut scene);
    }
    scene.textures = pictures.textures;
    scene.warnings.extend(pictures.warnings);
    add_quads(path, file, origin, &mut scene)?;
    add_lights(path, file, origin, &mut scene)?;
    if let Some(environment) = &file.environment {
        environment.light(names, options, &mut scene)?;
    }
    if camera.is_none() {
        scene.frame_all();
    }
    warn_of_unused_materials(path, file, &mut scene);
    warn_if_moved(path, origin, &mut scene);
    Ok(scene)
}

/// Positions of a part that are looked at in each of many places.
const SAMPLED: usize = 64;
/// Memory that a triangle takes for each place that it is repeated in, in bytes, by an estimate.
const PER_TRIANGLE: u64 = 400;

/// Whether shapes that stand in several places are kept once.
fn keeps_instances(
    path: &Path,
    meshes: &[LoadedObj<'_>],
    options: &LoadOptions,
) -> Result<bool, SceneError> {
    let repeated = |mesh: &LoadedObj<'_>| {
        let triangles: usize = mesh.obj.parts.iter().map(Part::triangle_count).sum();
        triangles as u64 * mesh.rules.instances.as_ref().map_or(0, |list| list.len() as u64)
    };
    let total = meshes.iter().map(repeated).sum();
    let keeps = options.instancing.keeps(total);
    if !keeps && total.saturating_mul(PER_TRIANGLE) > options.max_memory {
        let largest = meshes.iter().max_by_key(|mesh| repeated(mesh));
        let place = largest.map_or_else(String::new, |mesh| mesh.rules.place.clone());
        return Err(SceneError::TooLarge {
            path: path.to_owned(),
            place: format!("{place}instances"),
            limit: options.max_memory,
        });
    }
    Ok(keeps)
}

/// An OBJ that has been read.
struct LoadedObj<'a> {
    rules: &'a FileMesh,
    path: PathBuf,
    text: Cow<'a, [u8]>,
    obj: Obj,
}

impl<'a> LoadedObj<'a> {
    fn read(
        rules: &'a FileMesh,
        names: &Names<'_>,
        options: &LoadOptions,
        memory: u64,
    ) -> Result<Self, SceneError> {
        if rules.instances.as_ref().is_some_and(Vec::is_empty) {
            let what = "must name a place at least, or be left out: the mesh is shown nowhere";
            return Err(wrong_key(names.scene, &format!("{}instances", rules.place), what));
        }
        let path = names.find(&rules.key, &rules.file, &[names.folder])?;
        let text = names.source.read(&path, options.geometry_bytes())?;
        if gltf::is_binary(&text) {
            let what = "is a glTF, which is a scene by itself: a mesh is an OBJ or a PLY";
            return Err(wrong_key(names.scene, &rules.key, what));
        }
        let smooth = rules.normals == Normals::Smooth;
        let obj = if ply::is_ply(&text) {
            ply::parse(&path, &text, smooth, memory)?
        } else {
            Obj::parse(&path, &text, smooth, memory)?
        };
        Ok(Self { rules, path, text: Cow::Owned(text), obj })
    }
}

impl FileMesh {
    /// Where its vertices go, with `origin` taken off.
    fn placements(&self, origin: DVec3) -> Vec<Placement> {
        let Some(instances) = &self.instances else {
            return vec![Placement { transform: self.transform, origin }];
        };
        let first = self.transform.unwrap_or(DAffine3::IDENTITY);
        let place = |instance: &DAffine3| Placement { transform: Some(*instance * first), origin };
        instances.iter().map(place).collect()
    }
}

fn add_quads(
    path: &Path,
    file: &SceneFile,
    origin: DVec3,
    scene: &mut Scene,
) -> Result<(), SceneError> {
    for (index, quad) in file.quads.iter().enumerate() {
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

fn add_lights(
    path: &Path,
    file: &SceneFile,
    origin: DVec3,
    scene: &mut Scene,
) -> Result<(), SceneError> {
    for (index, light) in file.lights.iter().enumerate() {
        let light = light.seen_from(origin);
        let light = light.map_err(|what| wrong_key(path, &format!("lights[{index}]"), &what))?;
        scene.add_punctual_light(light);
    }
    Ok(())
}

/// Says which of the file's materials no mesh is made of.
fn warn_of_unused_materials(path: &Path, file: &SceneFile, scene: &mut Scene) {
    let choices = file.meshes.iter().flat_map(|mesh| mesh.materials.values().chain(&mesh.material));
    let used: HashSet<&str> = choices
        .filter_map(|choice| match choice {
            MaterialChoice::Named(name) => Some(name.as_str()),
            MaterialChoice::Own(_) => None,
        })
        .collect();
    let unused: Vec<String> =
        file.materials.keys().filter(|name| !used.contains(name.as_str())).cloned().collect();
    if !unused.is_empty() {
        let (path, unused) = (path.display(), super::error::list(&unused));
        scene.warnings.push(format!("{path}: no mesh names these materials: {unused}."));
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

fn check_overrides(path: &Path, rules: &FileMesh, obj: &Obj) -> Result<(), SceneError> {
    let mut used: Vec<_> = obj.parts.iter().map(|part| part.material.to_string()).collect();
    // A material may have several parts.
    let mut seen = HashSet::new();
    used.retain(|name| seen.insert(name.clone()));
    let names: Vec<_> =
        rules.materials.keys().filter(|name| !seen.contains(*name)).cloned().collect();
    if names.is_empty() {
        Ok(())
    } else {
        let key = format!("{}materials", rules.place);
        Err(SceneError::UnknownMaterials { path: path.to_owned(), key, names, used })
    }
}
