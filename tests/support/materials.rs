//! Materials as the kernels read them.

use glam::Vec3;
use raystream_shaders::scene::bsdf::{Material, MaterialKind};
use raystream_shaders::scene::texture::NO_TEXTURE;

/// Lambert's law.
pub fn diffuse(reflectance: f32) -> Material {
    Material {
        reflectance: Vec3::splat(reflectance),
        kind: MaterialKind::DIFFUSE,
        emission: Vec3::ZERO,
        texture: NO_TEXTURE,
        transmittance: Vec3::ONE,
        ior: 1.0,
    }
}

/// An ideal mirror.
pub fn mirror(reflectance: f32) -> Material {
    Material { kind: MaterialKind::MIRROR, ..diffuse(reflectance) }
}

/// Clear glass.
pub fn glass(ior: f32) -> Material {
    Material { kind: MaterialKind::DIELECTRIC, ior, ..diffuse(1.0) }
}
