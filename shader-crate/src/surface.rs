//! From a hit to what shading needs to know.

use crate::access::at;
use crate::device_struct;
use crate::glam::{Vec2, Vec3};
use crate::material::Material;
use crate::ray::{Hit, Ray, SurfacePoint};
use crate::scene::SurfaceView;
use crate::texture::NO_TEXTURE;
use crate::triangle::NO_ATTRIBUTES;
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

device_struct! {
    /// Corner normals and texture coordinates of one triangle. 64 bytes.
    pub struct Attributes {
        /// Unit normal at corner 0; all three are zero where there are none.
        pub normal0: Vec3,
        /// Texture coordinate at corner 0.
        pub u0: f32,
        /// Unit normal at corner 1.
        pub normal1: Vec3,
        /// Texture coordinate at corner 0.
        pub v0: f32,
        /// Unit normal at corner 2.
        pub normal2: Vec3,
        /// Texture coordinate at corner 1.
        pub u1: f32,
        /// Texture coordinate at corner 1.
        pub v1: f32,
        /// Texture coordinate at corner 2.
        pub u2: f32,
        /// Texture coordinate at corner 2.
        pub v2: f32,
        /// Unused; zero.
        pub pad: u32,
    }
}

/// A point on a surface, seen along a ray.
#[derive(Clone, Copy)]
pub struct Surface {
    /// Where it is, and how a ray leaves it.
    pub point: SurfacePoint,
    /// Shading normal, unit length, on the side of the shading frame that the ray came from.
    pub normal: Vec3,
    /// Whether the ray came from the front of the shading frame (outside, for a dielectric).
    pub from_outside: bool,
    /// Whether the ray came from the front of the triangle, the side that emits.
    pub from_front: bool,
    /// The material, its reflectance looked up in its texture.
    pub material: Material,
}

impl Surface {
    /// The surface at `hit`, which `ray` made and which [is some](Hit::is_some).
    pub fn at(surfaces: &SurfaceView<'_>, ray: &Ray, hit: &Hit) -> Self {
        let triangle = surfaces.triangles.get(hit.triangle);
        let point = triangle.surface_point(hit, surfaces.offset_roundings);
        let geometric = point.normal;
        let mut material = at(surfaces.materials, triangle.material);
        let mut shading = geometric;
        if triangle.attributes != NO_ATTRIBUTES {
            let a = at(surfaces.attributes, triangle.attributes);
            let w = 1.0 - hit.u - hit.v;
            let normal = a.normal0 * w + a.normal1 * hit.u + a.normal2 * hit.v;
            let length = normal.length_squared();
            if length > 0.0 {
                shading = normal / length.sqrt();
            }
            if material.texture != NO_TEXTURE {
                let uv = Vec2::new(a.u0, a.v0) * w + Vec2::new(a.u1, a.v1) * hit.u + Vec2::new(a.u2, a.v2) * hit.v;
                material.reflectance = surfaces.textures.sample(material.texture, uv.x, uv.y);
            }
        }
        let from_outside = ray.direction.dot(shading) < 0.0;
        Self {
            point,
            normal: if from_outside { shading } else { -shading },
            from_outside,
            from_front: ray.direction.dot(geometric) < 0.0,
            material,
        }
    }
}
