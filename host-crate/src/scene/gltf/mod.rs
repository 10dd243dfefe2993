//! glTF 2.0: meshes, materials, cameras and what holds them together, as text or binary.
//!
//! The crate `gltf` describes the JSON. What it says is checked where it is used, here: the crate's
//! own validation panics on indices that lead nowhere, and its readers know no quantised positions.

mod accessor;
mod animation;
mod camera;
mod deform;
mod document;
mod draco;
mod extensions;
mod geometry;
mod instances;
mod layout;
mod lights;
mod material;
mod meshopt;
mod nodes;
mod placed;
mod primitive;
mod specular_glossiness;
mod texture;
mod variants;

pub(super) use document::is_binary;

use self::document::Document;
use self::instances::instances;
use self::material::{Materials, Surface};
use self::nodes::Nodes;
use self::placed::Placed;
use self::primitive::{Primitive, Shape};
use self::variants::Variants;
use super::clean::Cleaner;
use super::description::Scene;
use super::environment::{Environment, LIT_BY_DEFAULT};
use super::error::SceneError;
use super::film::FilmSize;
use super::framing::{FRAMED, TO_BE_FRAMED};
use super::material::Material;
use super::options::LoadOptions;
use super::recentre::{origin_of, warn_if_moved};
use super::source::{SceneBytes, Source};
use glam::{DMat4, Vec3};
use std::collections::HashMap;
use std::rc::Rc;

/// Loads a glTF.
pub(super) fn load(
    source: &dyn Source,
    file: SceneBytes<'_>,
    options: &LoadOptions,
) -> Result<Scene, SceneError> {
    let mut document = Document::parse(source, file, options)?;
    if let Some(at) = options.at {
        animation::pose(&mut document, at)?;
    }
    let nodes = Nodes::of(&document)?;
    let variants = Variants::of(&document, options.variant.as_deref())?;
    let mut scene = Scene::new(TO_BE_FRAMED, FilmSize::default());
    scene.name = file.path.file_stem().map_or_else(String::new, |s| s.to_string_lossy().into());
    document.warn(options.at.is_some(), &mut scene);
    let mut materials = Materials::new(&document, source, options);
    let placed = place(&document, &nodes, &variants, &mut materials, &mut scene)?;
    scene.variants = variants.names;
    let placed = placed::gathered(placed, &document, &scene)?;
    let origin = origin_of(placed.iter().flat_map(Placed::sampled));
    let mut cleaner = Cleaner::new(false);
    placed::add(&document, &placed, origin, &mut cleaner, &mut scene)?;
    materials.finish(&mut scene);
    let path = file.path.display();
    if cleaner.degenerate > 0 {
        let count = cleaner.degenerate;
        scene.warnings.push(format!("{path}: {count} triangles without area were dropped."));
    }
    warn_if_moved(file.path, origin, &mut scene);
    lights::add(&document, &nodes, origin, &mut scene)?;
    camera::add(&document, &nodes, origin, &mut scene)?;
    match scene.cameras.first() {
        Some(first) => (scene.camera, scene.film) = (first.camera, first.film),
        None => {
            scene.frame_all();
            scene.warnings.push(format!("{path}: it has no camera that is shown; {FRAMED}"));
        }
    }
    if !has_lamp(&scene) {
        scene.set_environment(Environment::studio());
        scene.warnings.push(format!("{path}: it has no light that is shown; {LIT_BY_DEFAULT}"));
    }
    // What a file says has been checked on the way; this is for what is made of it.
    scene.check().map_err(|wrong| document.wrong(&wrong.place, wrong.what))?;
    Ok(scene)
}

/// Whether anything is there to light the scene. A texture of emission is mostly black, and what
/// glows on it is no lamp.
fn has_lamp(scene: &Scene) -> bool {
    let shines = |material: &Material| {
        let is_mapped = material.principled().is_some_and(|p| p.maps.emission.is_some());
        material.radiance() != Vec3::ZERO && !is_mapped
    };
    !scene.punctual_lights.is_empty() || scene.materials.iter().any(shines)
}

/// All shapes of the scene that is shown.
fn place(
    document: &Document<'_>,
    nodes: &Nodes,
    variants: &Variants,
    materials: &mut Materials<'_>,
    scene: &mut Scene,
) -> Result<Vec<Placed>, SceneError> {
    let mut placed = Vec::new();
    let mut rigid: HashMap<(usize, usize), Shape> = HashMap::new();
    let mut lacks = primitive::Lacks::default();
    for node in nodes.shown() {
        let Some(mesh_index) = document.root.nodes[node].mesh else { continue };
        let at = format!("nodes[{node}].mesh");
        let mesh = document.get(&document.root.meshes, mesh_index.value(), "meshes", &at)?;
        let transforms = instances(document, nodes, node)?;
        for number in 0..mesh.primitives.len() {
            let primitive = Primitive { document, mesh: mesh_index.value(), number };
            let key = (mesh_index.value(), number);
            let is_bent = primitive.is_bent(node);
            let shape = match rigid.get(&key).filter(|_| !is_bent) {
                Some(shape) => shape.clone(),
                None => {
                    let shape = primitive.shape(variants, materials, scene, &mut lacks)?;
                    if !is_bent {
                        rigid.insert(key, shape.clone());
                    }
                    shape
                }
            };
            let Shape { geometry: Some(geometry), surface: Surface::Of(material) } = shape else {
                continue;
            };
            let (shape, transforms) = if is_bent {
                let (bent, is_in_world) = deform::bend(&primitive, nodes, node, &geometry)?;
                let transforms =
                    if is_in_world { vec![DMat4::IDENTITY] } else { transforms.clone() };
                (Rc::new(bent), transforms)
            } else {
                (geometry, transforms.clone())
            };
            let part = primitive.place();
            placed.push(Placed { shape, transforms, material, part });
        }
    }
    lacks.finish(document, scene);
    if placed.is_empty() {
        return Err(document.wrong("meshes", "there is no triangle in the scene that is shown"));
    }
    Ok(placed)
}
