//! Lights (KHR_lights_punctual).

use super::document::Document;
use super::nodes::Nodes;
use crate::scene::description::Scene;
use crate::scene::error::SceneError;
use glam::DVec3;

/// Adds the lights of the scene that is shown, with `origin` taken off their places. Scenes have no
/// such lights: what is left out is said.
pub(super) fn add(
    document: &Document<'_>,
    nodes: &Nodes,
    _origin: DVec3,
    scene: &mut Scene,
) -> Result<(), SceneError> {
    let lights = document.root.extensions.as_ref().and_then(|all| all.khr_lights_punctual.as_ref());
    let lights = lights.map(|list| list.lights.as_slice()).unwrap_or_default();
    let mut count = 0;
    for node in nodes.shown() {
        let extensions = document.root.nodes[node].extensions.as_ref();
        let Some(light) = extensions.and_then(|all| all.khr_lights_punctual.as_ref()) else {
            continue;
        };
        let place = format!("nodes[{node}].extensions.KHR_lights_punctual");
        let light = document.get(lights, light.light.value(), "lights", &place)?;
        count += 1;
        let name = light.name.as_deref().unwrap_or("(unnamed)");
        let detail = format!("the light `{name}` of nodes[{node}] is left out");
        scene.details.push(document.warning(&detail));
    }
    if count > 0 {
        let what = format!("lights that are points, spots or suns do not shine here: {count}.");
        scene.warnings.push(document.warning(&what));
    }
    Ok(())
}
