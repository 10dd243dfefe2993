//! Materials as the kernels read them.

use glam::Vec3;
use raystream_shaders::scene::abilities::{BASIC, Fixed};
use raystream_shaders::scene::bsdf::albedo::AlbedoView;
use raystream_shaders::scene::bsdf::layers::Layers;
use raystream_shaders::scene::bsdf::{Bsdf, Material, MaterialKind};
use raystream_shaders::scene::normals::Normals;
use raystream_shaders::scene::texture::NO_TEXTURE;

/// A material that looks nothing up, at a point with this shading `normal`, which is on the side
/// that the path came from: `from_outside` says whether that is the front.
pub fn bsdf(material: &Material, normal: Vec3, from_outside: bool) -> Bsdf<'static, Fixed<BASIC>> {
    let albedos = AlbedoView { rows: &[], first: 0, anisotropic: 0 };
    let normals = [Normals::all(normal); 2];
    material.bsdf(normals, Vec3::ZERO, from_outside, Layers::NONE, albedos, Fixed)
}

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
