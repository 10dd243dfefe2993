//! Lights (KHR_lights_punctual).

use super::document::Document;
use super::nodes::Nodes;
use crate::scene::description::Scene;
use crate::scene::error::SceneError;
use crate::scene::light::PunctualLight;
use glam::{DMat4, DVec3, Vec3};
use gltf::json::extensions::scene::khr_lights_punctual::{Light, Spot, Type};
use gltf::json::validation::Checked;

/// The outer angle of a cone that says none.
const FULL_CONE: f32 = std::f32::consts::FRAC_PI_4;

/// Adds the lights of the scene that is shown, with `origin` taken off their places. Intensities in
/// candela and illuminances in lux become radiant ones of the same number, as emissions in nits do.
pub(super) fn add(
    document: &Document<'_>,
    nodes: &Nodes,
    origin: DVec3,
    scene: &mut Scene,
) -> Result<(), SceneError> {
    let lights = document.root.extensions.as_ref().and_then(|all| all.khr_lights_punctual.as_ref());
    let lights = lights.map(|list| list.lights.as_slice()).unwrap_or_default();
    let mut ranges = 0;
    for node in nodes.shown() {
        let extensions = document.root.nodes[node].extensions.as_ref();
        let Some(named) = extensions.and_then(|all| all.khr_lights_punctual.as_ref()) else {
            continue;
        };
        let place = format!("nodes[{node}].extensions.KHR_lights_punctual");
        let index = named.light.value();
        let json = document.get(lights, index, "lights", &place)?;
        let place = format!("extensions.KHR_lights_punctual.lights[{index}]");
        let Some(light) = seen(json, nodes.transform(node), origin) else {
            return Err(document.wrong(&place, "is of no type that glTF has"));
        };
        light.check().map_err(|(key, what)| document.wrong(&format!("{place}: {key}"), what))?;
        if light.colour() != Vec3::ZERO {
            scene.add_punctual_light(light);
        }
        ranges += usize::from(json.range.is_some());
    }
    if ranges > 0 {
        let what = format!(
            "light falls off with the square of the distance, without a range: \
                            that of {ranges} lights is not used."
        );
        scene.warnings.push(document.warning(&what));
    }
    Ok(())
}

/// The light at a place in the world, where it shines along -z; none of an unknown type.
fn seen(json: &Light, transform: DMat4, origin: DVec3) -> Option<PunctualLight> {
    let Checked::Valid(kind) = json.type_.as_ref() else { return None };
    let position = (transform.w_axis.truncate() - origin).as_vec3();
    let direction = transform.transform_vector3(DVec3::NEG_Z).normalize_or_zero().as_vec3();
    let colour = Vec3::from_array(json.color) * json.intensity;
    Some(match kind {
        Type::Point => PunctualLight::point(position, colour),
        Type::Directional => PunctualLight::directional(direction, colour),
        Type::Spot => {
            let default = Spot { inner_cone_angle: 0.0, outer_cone_angle: FULL_CONE };
            let spot = json.spot.as_ref().unwrap_or(&default);
            PunctualLight::Spot {
                position,
                direction,
                intensity: colour,
                inner_angle: spot.inner_cone_angle.to_degrees(),
                outer_angle: spot.outer_cone_angle.to_degrees(),
            }
        }
    })
}
