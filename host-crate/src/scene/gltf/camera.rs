//! Cameras.

use super::document::Document;
use super::nodes::Nodes;
use crate::scene::bounds;
use crate::scene::camera::{Camera, NamedCamera};
use crate::scene::description::Scene;
use crate::scene::error::SceneError;
use crate::scene::film::FilmSize;
use glam::{DMat4, DVec3};
use gltf::json::camera::Perspective;

/// Adds the cameras of the scene that is shown, with `origin` taken off their places.
pub(super) fn add(
    document: &Document<'_>,
    nodes: &Nodes,
    origin: DVec3,
    scene: &mut Scene,
) -> Result<(), SceneError> {
    let mut orthographic = Vec::new();
    for node in nodes.shown() {
        let json = &document.root.nodes[node];
        let Some(index) = json.camera else { continue };
        let place = format!("nodes[{node}].camera");
        let camera = document.get(&document.root.cameras, index.value(), "cameras", &place)?;
        let name = json.name.as_ref().or(camera.name.as_ref());
        let name = name.cloned().unwrap_or_else(|| format!("cameras[{}]", index.value()));
        let Some(perspective) = &camera.perspective else {
            orthographic.push(name);
            continue;
        };
        let aspect = perspective.aspect_ratio.map_or(0.0, f64::from);
        let film = if aspect > 0.0 && aspect.is_finite() {
            FilmSize::of_aspect(aspect)
        } else {
            FilmSize::default()
        };
        let camera = seen(perspective, nodes.transform(node), origin)
            .map_err(|what| document.wrong(&format!("cameras[{}]", index.value()), what))?;
        scene.cameras.push(NamedCamera { name: unused(name, &scene.cameras), camera, film });
    }
    if !orthographic.is_empty() {
        let names = crate::scene::error::list(&orthographic);
        let what = format!("orthographic cameras are left out: {names}.");
        scene.warnings.push(document.warning(&what));
    }
    if let Some(first) = scene.cameras.first()
        && scene.cameras.len() > 1
    {
        let names: Vec<_> = scene.cameras.iter().map(|camera| camera.name.clone()).collect();
        let names = crate::scene::error::list(&names);
        let what = format!("it has several cameras, {names}; `{}` is used.", first.name);
        scene.warnings.push(document.warning(&what));
    }
    Ok(())
}

/// The camera at a place in the world: it looks along -z, with y upwards.
fn seen(perspective: &Perspective, transform: DMat4, origin: DVec3) -> Result<Camera, String> {
    let fov_y = bounds::angle_of_view(f64::from(perspective.yfov).to_degrees())
        .map_err(|what| format!("yfov {what}"))?;
    let direction = |axis: DVec3| transform.transform_vector3(axis).normalize_or_zero();
    let place = transform.w_axis.truncate() - origin;
    let camera = Camera {
        origin: place.as_vec3(),
        // As far as there are digits to say in which direction.
        target: (place + direction(DVec3::NEG_Z) * place.abs().max_element().max(1.0)).as_vec3(),
        up: direction(DVec3::Y).as_vec3(),
        fov_y,
    };
    camera.check()?;
    Ok(camera)
}

/// A name, with a number if another camera has it.
fn unused(name: String, others: &[NamedCamera]) -> String {
    let is_taken = |name: &str| others.iter().any(|other| other.name == name);
    if !is_taken(&name) {
        return name;
    }
    let numbered = (2..).map(|number| format!("{name} {number}"));
    numbered.into_iter().find(|name| !is_taken(name)).unwrap_or(name)
}
