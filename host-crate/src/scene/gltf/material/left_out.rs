//! What a file says of a material and the picture does not show.

use super::described::Reader;
use crate::scene::error::SceneError;
use crate::scene::summary::Fate;
use gltf::json::Value;
use gltf::json::material::Material;

/// Extensions of materials that have no effect, the key of each whose value of 0 says that it has
/// none anyway, and what becomes of it.
const LEFT_OUT: [(&str, &str, &str); 3] = [
    ("KHR_materials_iridescence", "iridescenceFactor", "thin films are left out: "),
    ("KHR_materials_dispersion", "dispersion", "colours are not spread by glass: "),
    (
        "KHR_materials_diffuse_transmission",
        "diffuseTransmissionFactor",
        "no light passes diffusely: ",
    ),
];
const OCCLUSION: Fate = Fate::Judged("light that does not come is found by tracing: ");
const BACKS: Fate = Fate::Judged("backs are shown as fronts are: ");

impl Reader<'_, '_> {
    pub(super) fn note_what_is_left_out(&mut self, json: &Material) -> Result<(), SceneError> {
        if json.occlusion_texture.is_some() {
            self.note(OCCLUSION, "occlusionTexture");
        }
        if !json.double_sided {
            self.note(BACKS, "doubleSided");
        }
        let Some(extensions) = &json.extensions else { return Ok(()) };
        for (extension, key, what) in LEFT_OUT {
            let value = extensions.others.get(extension);
            if value.is_some_and(|value| value.get(key).is_some_and(|value| !is_zero(value))) {
                self.note(Fate::Becomes(what), extension);
            }
        }
        Ok(())
    }
}

/// Whether a number is 0, or all of a list's are.
fn is_zero(value: &Value) -> bool {
    match value {
        Value::Array(values) => values.iter().all(is_zero),
        value => value.as_f64() == Some(0.0),
    }
}
