//! The older model of materials (KHR_materials_pbrSpecularGlossiness).

use gltf::json::texture::Info;
use serde::Deserialize;

/// What a material of that model says.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct SpecularGlossiness {
    /// Colour of the base, and its opacity.
    pub diffuse_factor: [f32; 4],
    pub diffuse_texture: Option<Info>,
    /// What is reflected at normal incidence.
    pub specular_factor: [f32; 3],
    /// 1 less the roughness.
    pub glossiness_factor: f32,
    pub specular_glossiness_texture: Option<Info>,
}

impl Default for SpecularGlossiness {
    fn default() -> Self {
        Self {
            diffuse_factor: [1.0; 4],
            diffuse_texture: None,
            specular_factor: [1.0; 3],
            glossiness_factor: 1.0,
            specular_glossiness_texture: None,
        }
    }
}
