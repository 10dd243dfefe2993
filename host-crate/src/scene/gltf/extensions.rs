//! Extensions: which are read, and what becomes of the others.

use crate::scene::error::{SceneError, list};
use gltf::json::{Root, Texture};
use std::path::Path;

/// The extension of pictures as WebP.
pub(super) const WEBP: &str = "EXT_texture_webp";
/// The extension of pictures as KTX2, which is not read: of its decoders in Rust, one is bindings
/// of C++, which the page in the browser cannot have, and the other is at its version 0.1.0.
pub(super) const BASISU: &str = "KHR_texture_basisu";
/// The extension of copies of a mesh.
pub(super) const INSTANCING: &str = "EXT_mesh_gpu_instancing";
/// The extension that moves texture coordinates.
pub(super) const TRANSFORM: &str = "KHR_texture_transform";
/// The extension of materials that take each other's place.
pub(super) const VARIANTS: &str = "KHR_materials_variants";
/// The older model of materials.
pub(super) const SPECULAR_GLOSSINESS: &str = "KHR_materials_pbrSpecularGlossiness";

/// The extension of compressed primitives.
pub(super) const DRACO: &str = "KHR_draco_mesh_compression";
/// The extension of compressed views.
pub(super) const MESHOPT: &str = "EXT_meshopt_compression";

/// Extensions whose content is read; of what the picture does not show, its reader says so.
const READ: &[&str] = &[
    DRACO,
    INSTANCING,
    MESHOPT,
    WEBP,
    TRANSFORM,
    SPECULAR_GLOSSINESS,
    VARIANTS,
    "KHR_lights_punctual",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_diffuse_transmission",
    "KHR_materials_dispersion",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
];

/// Fails if the file requires what is not read.
pub(super) fn check_required(root: &Root, path: &Path) -> Result<(), SceneError> {
    let names = unknown(&root.extensions_required);
    if names.is_empty() {
        return Ok(());
    }
    let is_for_pictures = names.iter().any(|name| name == BASISU);
    let textures = if is_for_pictures { textures_in_ktx2(root) } else { Vec::new() };
    Err(SceneError::Extensions { path: path.to_owned(), names, textures })
}

/// The places of the textures that have a picture as KTX2.
fn textures_in_ktx2(root: &Root) -> Vec<String> {
    let textures = root.textures.iter().enumerate();
    textures
        .filter(|(_, texture)| is_in_ktx2(texture))
        .map(|(k, _)| format!("textures[{k}]"))
        .collect()
}

/// Whether a texture has a picture as KTX2.
pub(super) fn is_in_ktx2(texture: &Texture) -> bool {
    texture.extensions.as_ref().is_some_and(|all| all.others.contains_key(BASISU))
}

/// What to say of extensions that are not read.
pub(super) fn unread(root: &Root) -> Option<String> {
    let names = unknown(&root.extensions_used);
    (!names.is_empty()).then(|| format!("these extensions are not read: {}.", list(&names)))
}

fn unknown(names: &[String]) -> Vec<String> {
    names.iter().filter(|name| !READ.contains(&name.as_str())).cloned().collect()
}
