//! From a hit to what shading needs to know.

use crate::glam::{UVec4, Vec2, Vec3};
use crate::memory::access::at;
use crate::scene::bsdf::Material;
use crate::scene::ray::{Hit, Ray, SurfacePoint};
use crate::scene::texture::{NO_TEXTURE, TextureView};
use crate::scene::triangle::{Attributes, NO_ATTRIBUTES, TriangleView};
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

/// The surfaces of a scene, for those who know what has been hit.
#[derive(Clone, Copy)]
pub struct SurfaceView<'a> {
    /// The triangles, in the order of the BVH's leaves.
    pub triangles: TriangleView<'a>,
    /// Corner normals and texture coordinates of the triangles that have any.
    pub attributes: &'a [Attributes],
    /// The materials.
    pub materials: &'a [Material],
    /// How far rays start from surfaces, see [`crate::scene::ray::OFFSET_ROUNDINGS`].
    pub offset_roundings: f32,
    /// The textures.
    pub textures: TextureView<'a>,
}

impl<'a> SurfaceView<'a> {
    /// Wraps the buffers. `offset_roundings` is as in [`Self::offset_roundings`].
    #[inline(always)]
    pub fn new(
        triangles: &'a [UVec4],
        attributes: &'a [Attributes],
        materials: &'a [Material],
        texels: &'a [u32],
        offset_roundings: f32,
    ) -> Self {
        Self {
            triangles: TriangleView::new(triangles),
            attributes,
            materials,
            offset_roundings,
            textures: TextureView::new(texels),
        }
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
                let uv = Vec2::new(a.u0, a.v0) * w
                    + Vec2::new(a.u1, a.v1) * hit.u
                    + Vec2::new(a.u2, a.v2) * hit.v;
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
