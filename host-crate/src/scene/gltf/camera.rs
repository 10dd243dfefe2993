//! Cameras.

use super::document::Document;
use super::nodes::Nodes;
use crate::scene::bounds;
use crate::scene::camera::{Camera, NamedCamera, Projection};
use crate::scene::description::Scene;
use crate::scene::error::SceneError;
use crate::scene::film::FilmSize;
use glam::{DMat4, DVec3};
use gltf::json;

/// Adds the cameras of the scene that is shown, with `origin` taken off their places.
pub(super) fn add(
    document: &Document<'_>,
    nodes: &Nodes,
    origin: DVec3,
    scene: &mut Scene,
) -> Result<(), SceneError> {
    for node in nodes.shown() {
        let seen_from = &document.root.nodes[node];
        let Some(index) = seen_from.camera else { continue };
        let place = format!("nodes[{node}].camera");
        let camera = document.get(&document.root.cameras, index.value(), "cameras", &place)?;
        let name = seen_from.name.as_ref().or(camera.name.as_ref());
        let name = name.cloned().unwrap_or_else(|| format!("cameras[{}]", index.value()));
        let place = format!("cameras[{}]", index.value());
        let wrong = |what: String| document.wrong(&place, what);
        let (projection, aspect) = projection(camera).map_err(wrong)?;
        let film = if aspect > 0.0 && aspect.is_finite() {
            FilmSize::of_aspect(aspect)
        } else {
            FilmSize::default()
        };
        let camera = seen(projection, nodes.transform(node), origin).map_err(wrong)?;
        scene.cameras.push(NamedCamera { name: unused(name, &scene.cameras), camera, film });
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

/// How a camera shows the world, and the width of its picture over its height; 0 if it says none.
fn projection(camera: &json::Camera) -> Result<(Projection, f64), String> {
    if let Some(orthographic) = &camera.orthographic {
        let [half_width, half_height] = [orthographic.xmag, orthographic.ymag].map(f64::from);
        let width = bounds::distance(2.0 * half_width.abs());
        let width = width.map_err(|what| format!("orthographic.xmag, twice, {what}"))?;
        return Ok((Projection::Orthographic { width }, (half_width / half_height).abs()));
    }
    let Some(perspective) = &camera.perspective else {
        return Err("is neither perspective nor orthographic".to_owned());
    };
    let fov_y = bounds::angle_of_view(f64::from(perspective.yfov).to_degrees())
        .map_err(|what| format!("perspective.yfov {what}"))?;
    let aspect = perspective.aspect_ratio.map_or(0.0, f64::from);
    Ok((Projection::Perspective { fov_y, lens: None }, aspect))
}

/// The camera at a place in the world: it looks along -z, with y upwards.
fn seen(projection: Projection, transform: DMat4, origin: DVec3) -> Result<Camera, String> {
    let direction = |axis: DVec3| transform.transform_vector3(axis).normalize_or_zero();
    let place = transform.w_axis.truncate() - origin;
    let camera = Camera {
        origin: place.as_vec3(),
        // As far as there are digits to say in which direction.
        target: (place + direction(DVec3::NEG_Z) * place.abs().max_element().max(1.0)).as_vec3(),
        up: direction(DVec3::Y).as_vec3(),
        projection,
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
