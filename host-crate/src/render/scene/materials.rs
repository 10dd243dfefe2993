//! The table of materials.

use crate::scene::{Channel, Material, Principled, Reflectance, Scene, TextureId};
use glam::Vec3;
use raystream_shaders::scene::bsdf::principled::Layers;
use raystream_shaders::scene::bsdf::{self, MaterialKind};
use raystream_shaders::scene::texture::NO_TEXTURE;

/// The materials of a scene, then one for each of its quad lights; `places` says where each texture
/// lies.
pub fn table(scene: &Scene, places: &[u32]) -> Vec<bsdf::Material> {
    let lamps = scene.quad_lights.iter().map(|light| Material::emissive(light.radiance));
    scene.materials.iter().copied().chain(lamps).map(|material| pack(material, places)).collect()
}

/// Where the kernels find a texture.
fn place(texture: Option<TextureId>, places: &[u32]) -> u32 {
    texture.map_or(NO_TEXTURE, |texture| places[texture.0 as usize])
}

/// What principled materials have beside the [`table`], for all of a scene's materials; nothing
/// where none is principled.
pub fn layers(scene: &Scene, places: &[u32]) -> Vec<Layers> {
    let place_of = |texture: Option<TextureId>| place(texture, places);
    let channel = |map: Option<Channel>| map.map_or(0, |map| map.channel);
    let is_principled = |material: &Material| matches!(material, Material::Principled(_));
    if !scene.materials.iter().any(is_principled) {
        return Vec::new();
    }
    let layers = scene.materials.iter().map(|material| match material {
        Material::Principled(principled) => Layers {
            specular: principled.specular,
            metallic: principled.metallic,
            roughness: principled.roughness,
            transmission: principled.transmission,
            roughness_map: place_of(principled.maps.roughness.map(|map| map.texture)),
            metallic_map: place_of(principled.maps.metallic.map(|map| map.texture)),
            normal_map: place_of(principled.maps.normal.map(|map| map.texture)),
            normal_scale: principled.maps.normal.map_or(1.0, |map| map.scale),
            channels: channel(principled.maps.roughness) | channel(principled.maps.metallic) << 8,
            emission_map: place_of(principled.maps.emission),
        },
        _ => Layers::NONE,
    });
    layers.collect()
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
        Material::Principled(Principled { base_colour, ior, emission, maps, .. }) => {
            bsdf::Material {
                kind: MaterialKind::PRINCIPLED,
                reflectance: base_colour,
                texture: place(maps.base_colour, places),
                emission,
                ior,
                ..plain
            }
        }
    }
}
