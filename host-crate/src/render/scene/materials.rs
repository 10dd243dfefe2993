//! The table of materials.

use crate::scene::{Material, Reflectance, Scene};
use glam::Vec3;
use raystream_shaders::scene::bsdf::{self, MaterialKind};
use raystream_shaders::scene::texture::NO_TEXTURE;

/// The materials of a scene, then one for each of its quad lights; `places` says where each texture
/// lies.
pub fn table(scene: &Scene, places: &[u32]) -> Vec<bsdf::Material> {
    let lamps = scene.quad_lights.iter().map(|light| Material::emissive(light.radiance));
    scene.materials.iter().copied().chain(lamps).map(|material| pack(material, places)).collect()
}

/// The material as the kernels read it.
fn pack(material: Material, places: &[u32]) -> bsdf::Material {
    let plain = bsdf::Material { ior: 1.0, texture: NO_TEXTURE, ..bsdf::Material::default() };
    match material {
        Material::Diffuse { reflectance: Reflectance::Colour(reflectance) } => {
            bsdf::Material { kind: MaterialKind::DIFFUSE, reflectance, ..plain }
        }
        Material::Diffuse { reflectance: Reflectance::Texture(texture) } => bsdf::Material {
            kind: MaterialKind::DIFFUSE,
            reflectance: Vec3::ONE,
            texture: places[texture.0 as usize],
            ..plain
        },
        Material::Mirror { reflectance } => {
            bsdf::Material { kind: MaterialKind::MIRROR, reflectance, ..plain }
        }
        Material::Dielectric { ior, transmittance, reflectance } => bsdf::Material {
            kind: MaterialKind::DIELECTRIC,
            reflectance,
            transmittance,
            ior,
            ..plain
        },
        Material::Emissive { radiance, reflectance } => {
            bsdf::Material { kind: MaterialKind::DIFFUSE, reflectance, emission: radiance, ..plain }
        }
    }
}
