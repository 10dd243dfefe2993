//! Triangles as the traversal reads them: three `uvec4`s each, in the order of the BVH's leaves.
//!
//! ```text
//! corner 0 xyz, material | edge to corner 1 xyz, attributes | edge to corner 2 xyz, unused
//! ```
//!
//! What the words of a row are, [`crate::rows`] says.

use crate::access::at;
use crate::glam::{UVec4, Vec3};
use crate::math::{UNIT_ROUNDOFF, triangle_normal};
use crate::ray::{Hit, OFFSET_ROUNDINGS, SurfacePoint};
use crate::rows::{row, vector};

/// `uvec4`s of one triangle.
pub const ROWS_PER_TRIANGLE: u32 = 3;
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

/// The triangles of a scene.
#[derive(Clone, Copy)]
pub struct TriangleView<'a> {
    rows: &'a [UVec4],
}

impl<'a> TriangleView<'a> {
    /// Wraps the buffer.
    pub fn new(rows: &'a [UVec4]) -> Self {
        Self { rows }
    }

    /// The triangle number `index`, in the order of the BVH.
    pub fn get(&self, index: u32) -> Triangle {
        let first = index * ROWS_PER_TRIANGLE;
        Triangle::from_rows([at(self.rows, first), at(self.rows, first + 1), at(self.rows, first + 2)])
    }
}

impl Triangle {
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

    /// The three rows of the buffer.
    pub fn to_rows(&self) -> [UVec4; 3] {
        [row(self.corner, self.material), row(self.edge1, self.attributes), row(self.edge2, 0)]
    }

    /// Where the line `origin + t * direction` meets the triangle's plane, as `(t, u, v)`; outside the
    /// triangle `t` is negative. Both sides count.
    ///
    /// Moller and Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", JGT 2(1), 1997. No
    /// threshold on the determinant: a line in the plane gives infinities or NaN, which fail every comparison.
    #[inline(always)]
    pub fn intersect(&self, origin: Vec3, direction: Vec3) -> (f32, f32, f32) {
        let p = direction.cross(self.edge2);
        let inverse_determinant = 1.0 / self.edge1.dot(p);
        let s = origin - self.corner;
        let u = s.dot(p) * inverse_determinant;
        let q = s.cross(self.edge1);
        let v = direction.dot(q) * inverse_determinant;
        let t = self.edge2.dot(q) * inverse_determinant;
        let inside = u >= 0.0 && v >= 0.0 && u + v <= 1.0;
        (if inside { t } else { -1.0 }, u, v)
    }

    /// Unit normal of the front, the side from which the corners run counter-clockwise.
    pub fn normal(&self) -> Vec3 {
        triangle_normal(self.edge1, self.edge2)
    }

    /// The point of barycentric coordinates `(u, v)`, moved towards the centroid by a few roundings: a point on an edge
    /// must not end up beyond the neighbour there, from where a ray would leave a closed room.
    fn interior_point(&self, u: f32, v: f32) -> Vec3 {
        let size = self.edge1.abs().max(self.edge2.abs()).max_element();
        let shift = (OFFSET_ROUNDINGS * UNIT_ROUNDOFF * self.magnitude() / size).min(1.0);
        let towards_centroid = |w: f32| w + (1.0 / 3.0 - w) * shift;
        self.corner + self.edge1 * towards_centroid(u) + self.edge2 * towards_centroid(v)
    }

    /// The point of `hit`, which is on this triangle, for rays that leave it by `offset_roundings` (see [`OFFSET_ROUNDINGS`]).
    pub fn surface_point(&self, hit: &Hit, offset_roundings: f32) -> SurfacePoint {
        SurfacePoint {
            position: self.interior_point(hit.u, hit.v),
            normal: self.normal(),
            magnitude: self.magnitude(),
            offset_roundings,
        }
    }

    /// The largest coordinate that enters a point: what its rounding error is relative to.
    fn magnitude(&self) -> f32 {
        (self.corner.abs() + self.edge1.abs() + self.edge2.abs()).max_element()
    }
}
