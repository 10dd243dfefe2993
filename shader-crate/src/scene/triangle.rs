//! Triangles as shading looks them up, in the order of the BVH's leaves. Traversal has its own form
//! of them, see [`crate::scene::bvh::planes`].
//!
//! ```text
//! triangle:   corner 0, material | edge to corner 1, attributes | edge to corner 2, unused
//! attributes: normal 0, u0 | normal 1, v0 | normal 2, u1 | v1, u2, v2, tangent
//! ```
//!
//! Row layout: see [`crate::memory::rows`].

use crate::glam::{UVec4, Vec3};
use crate::math::{UNIT_ROUNDOFF, triangle_normal};
use crate::memory::device_struct;
use crate::memory::rows::{float, row, vector};
use crate::scene::ray::{Hit, OFFSET_ROUNDINGS, SurfacePoint};

/// The attribute index of a triangle without normals and texture coordinates.
pub const NO_ATTRIBUTES: u32 = u32::MAX;

/// One triangle.
#[cfg_attr(not(target_arch = "spirv"), derive(Debug, PartialEq))]
#[derive(Clone, Copy)]
pub struct Triangle {
    /// First corner, in world units.
    pub corner: Vec3,
    /// From the first corner to the second.
    pub edge1: Vec3,
    /// From the first corner to the third.
    pub edge2: Vec3,
    /// Index into the materials.
    pub material: u32,
    /// Index into the attributes, or [`NO_ATTRIBUTES`].
    pub attributes: u32,
}

device_struct! {
    /// Corner normals and texture coordinates of one triangle. 64 bytes.
    pub struct Attributes {
        /// Unit normal at corner 0; all three are zero where there are none.
        pub normal0: Vec3,
        /// Texture coordinate u at corner 0.
        pub u0: f32,
        /// Unit normal at corner 1.
        pub normal1: Vec3,
        /// Texture coordinate v at corner 0.
        pub v0: f32,
        /// Unit normal at corner 2.
        pub normal2: Vec3,
        /// Texture coordinate u at corner 1.
        pub u1: f32,
        /// Texture coordinate v at corner 1.
        pub v1: f32,
        /// Texture coordinate u at corner 2.
        pub u2: f32,
        /// Texture coordinate v at corner 2.
        pub v2: f32,
        /// The direction of growing `u` along the triangle, see [`crate::math::packed`], or
        /// [`NO_TANGENT`](crate::math::packed::NO_TANGENT).
        pub tangent: u32,
    }
}

impl Attributes {
    /// Rows of one.
    pub const ROWS: u32 = 4;

    /// Unpacks the four rows.
    pub fn from_rows(rows: [UVec4; 4]) -> Self {
        let last = rows[3];
        Self {
            normal0: vector(rows[0]),
            u0: float(rows[0]),
            normal1: vector(rows[1]),
            v0: float(rows[1]),
            normal2: vector(rows[2]),
            u1: float(rows[2]),
            v1: f32::from_bits(last.x),
            u2: f32::from_bits(last.y),
            v2: f32::from_bits(last.z),
            tangent: last.w,
        }
    }
}

impl Triangle {
    /// Rows of one.
    pub const ROWS: u32 = 3;

    /// Unpacks the three rows.
    pub fn from_rows(rows: [UVec4; 3]) -> Self {
        Self {
            corner: vector(rows[0]),
            edge1: vector(rows[1]),
            edge2: vector(rows[2]),
            material: rows[0].w,
            attributes: rows[1].w,
        }
    }

    /// The three rows.
    pub fn to_rows(&self) -> [UVec4; 3] {
        [row(self.corner, self.material), row(self.edge1, self.attributes), row(self.edge2, 0)]
    }

    /// Unit normal of the front, the side from which the corners run counter-clockwise.
    pub fn normal(&self) -> Vec3 {
        triangle_normal(self.edge1, self.edge2)
    }

    /// The point of barycentric coordinates `(u, v)`, moved towards the centroid by a few
    /// roundings: a point on an edge must not end up beyond the neighbour there, from where a ray
    /// would leave a closed room.
    fn interior_point(&self, u: f32, v: f32) -> Vec3 {
        let shift = (OFFSET_ROUNDINGS * UNIT_ROUNDOFF * self.magnitude() / self.size()).min(1.0);
        let towards_centroid = |w: f32| w + (1.0 / 3.0 - w) * shift;
        self.corner + self.edge1 * towards_centroid(u) + self.edge2 * towards_centroid(v)
    }

    /// The point of `hit`, which is on this triangle, for rays that leave it by `offset_roundings`
    /// (see [`OFFSET_ROUNDINGS`]).
    pub fn surface_point(&self, hit: &Hit, offset_roundings: f32) -> SurfacePoint {
        SurfacePoint {
            position: self.interior_point(hit.u, hit.v),
            normal: self.normal(),
            magnitude: self.magnitude(),
            offset_roundings,
        }
    }

    /// The largest extent of an edge along an axis, in world units.
    pub fn size(&self) -> f32 {
        self.edge1.abs().max(self.edge2.abs()).max_element()
    }

    /// The largest coordinate that enters a point: what its rounding error is relative to.
    pub fn magnitude(&self) -> f32 {
        (self.corner.abs() + self.edge1.abs() + self.edge2.abs()).max_element()
    }
}
