//! From a hit to what shading needs to know.

use crate::glam::{UVec4, Vec2, Vec3};
use crate::memory::rows::{four_rows, three_rows};
use crate::scene::abilities::{Abilities, TEXTURES};
use crate::scene::bsdf::{Bsdf, Material};
use crate::scene::ray::{Hit, Ray, SurfacePoint};
use crate::scene::texture::{NO_TEXTURE, TextureView};
use crate::scene::triangle::{Attributes, NO_ATTRIBUTES, Triangle};
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

/// The surfaces of a scene, for those who know what has been hit.
#[derive(Clone, Copy)]
pub struct SurfaceView<'a, A> {
    /// The scene's buffer `surfaces`, see [`crate::scene`].
    pub rows: &'a [UVec4],
    /// Row of the first attributes.
    pub first_attributes: u32,
    /// Row of the first material.
    pub first_material: u32,
    /// How far rays start from surfaces, see [`crate::scene::ray::OFFSET_ROUNDINGS`].
    pub offset_roundings: f32,
    /// The textures.
    pub textures: TextureView<'a>,
    /// What the scene uses.
    pub abilities: A,
}

impl<A: Abilities> SurfaceView<'_, A> {
    /// The triangle number `index`, in the order of the BVH's leaves.
    pub fn triangle(&self, index: u32) -> Triangle {
        Triangle::from_rows(three_rows(self.rows, index * Triangle::ROWS))
    }

    fn attributes(&self, index: u32) -> Attributes {
        Attributes::from_rows(four_rows(
            self.rows,
            self.first_attributes + index * Attributes::ROWS,
        ))
    }

    fn material(&self, index: u32) -> Material {
        Material::from_rows(three_rows(self.rows, self.first_material + index * Material::ROWS))
    }
}

/// A point on a surface, seen along a ray.
#[derive(Clone, Copy)]
pub struct Surface {
    /// Where it is, and how a ray leaves it.
    pub point: SurfacePoint,
    /// Whether the ray came from the front of the triangle, the side that emits.
    pub from_front: bool,
    /// What the surface does with light.
    pub bsdf: Bsdf,
    /// Radiance of the front, linear Rec.709.
    pub emission: Vec3,
}

impl Surface {
    /// The surface at `hit`, which `ray` made and which [is some](Hit::is_some).
    pub fn at(surfaces: &SurfaceView<'_, impl Abilities>, ray: &Ray, hit: &Hit) -> Self {
        let triangle = surfaces.triangle(hit.triangle);
        let point = triangle.surface_point(hit, surfaces.offset_roundings);
        let geometric = point.normal;
        let mut material = surfaces.material(triangle.material);
        let mut shading = geometric;
        if triangle.attributes != NO_ATTRIBUTES {
            let a = surfaces.attributes(triangle.attributes);
            let w = 1.0 - hit.u - hit.v;
            let normal = a.normal0 * w + a.normal1 * hit.u + a.normal2 * hit.v;
            let length = normal.length_squared();
            if length > 0.0 {
                shading = normal / length.sqrt();
            }
            if surfaces.abilities.has(TEXTURES) && material.texture != NO_TEXTURE {
                let uv = Vec2::new(a.u0, a.v0) * w
                    + Vec2::new(a.u1, a.v1) * hit.u
                    + Vec2::new(a.u2, a.v2) * hit.v;
                material.reflectance = surfaces.textures.sample(material.texture, uv.x, uv.y);
            }
        }
        let from_outside = ray.direction.dot(shading) < 0.0;
        Self {
            point,
            from_front: ray.direction.dot(geometric) < 0.0,
            bsdf: material.bsdf(if from_outside { shading } else { -shading }, from_outside),
            emission: material.emission,
        }
    }

    /// Whether it emits along the ray, back to where that came from.
    pub fn emits(&self) -> bool {
        self.from_front && self.emission.max_element() > 0.0
    }
}
