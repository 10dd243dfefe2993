//! Triangles, twice: as the traversal tests them and as shading looks them up.
//!
//! One buffer holds three `uvec4`s of each triangle for the test and then, from its middle on,
//! three of each for shading, both in the order of the BVH's leaves:
//!
//! ```text
//! test:    normal, its offset | u gradient, u offset | v gradient, v offset
//! shading: corner 0 xyz, material | edge to corner 1 xyz, attributes | edge to corner 2 xyz, unused
//! ```
//!
//! What the words of a row are, [`crate::memory::rows`] says.

use crate::glam::{UVec4, Vec3};
use crate::math::{UNIT_ROUNDOFF, triangle_normal};
use crate::memory::access::at;
use crate::memory::device_struct;
use crate::memory::rows::{row, vector};
use crate::scene::ray::{Hit, OFFSET_ROUNDINGS, Ray, SurfacePoint};

/// `uvec4`s of one triangle, in either half of the buffer.
const ROWS: u32 = 3;
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

    /// The triangle number `index`, in the order of the BVH, for shading.
    pub fn get(&self, index: u32) -> Triangle {
        Triangle::from_rows(self.rows_from(self.rows.len() as u32 / 2 + index * ROWS))
    }

    /// The same triangle, for the test.
    #[inline(always)]
    pub fn planes(&self, index: u32) -> Planes {
        Planes { rows: self.rows_from(index * ROWS) }
    }

    #[inline(always)]
    fn rows_from(&self, first: u32) -> [UVec4; ROWS as usize] {
        [at(self.rows, first), at(self.rows, first + 1), at(self.rows, first + 2)]
    }
}

/// A triangle as three affine functions of a point: the distance from its plane and two barycentric
/// coordinates.
#[derive(Clone, Copy)]
pub struct Planes {
    rows: [UVec4; 3],
}

impl Planes {
    /// Where the line `origin + t * direction` meets the triangle's plane, as `(t, u, v)`; outside
    /// the triangle `t` is negative. Both sides count.
    ///
    /// After Havel and Herout, "Yet Faster Ray-Triangle Intersection (Using SSE4)", TVCG 16(3),
    /// 2010, but for the division, which they put off. No threshold on the angle: a line in the
    /// plane gives infinities or NaN, which fail a comparison.
    #[inline(always)]
    fn intersect(&self, origin: Vec3, direction: Vec3) -> (f32, f32, f32) {
        let [plane, u_plane, v_plane] = self.rows;
        let offset = |row: UVec4| f32::from_bits(row.w);
        let normal = vector(plane);
        let t = (offset(plane) - normal.dot(origin)) / normal.dot(direction);
        let point = origin + direction * t;
        let u = vector(u_plane).dot(point) + offset(u_plane);
        let v = vector(v_plane).dot(point) + offset(v_plane);
        let inside = u >= 0.0 && v >= 0.0 && u + v <= 1.0;
        (if inside { t } else { -1.0 }, u, v)
    }

    /// Makes triangle number `index`, which this one is, the hit of `ray` where it is nearer.
    #[inline(always)]
    pub fn test(&self, ray: &Ray, index: u32, hit: &mut Hit) {
        let (t, u, v) = self.intersect(ray.origin, ray.direction);
        if t > 0.0 && t < hit.t {
            *hit = Hit { t, u, v, triangle: index };
        }
    }
}

impl Triangle {
    /// Unpacks the three rows of shading.
    pub fn from_rows(rows: [UVec4; 3]) -> Self {
        Self {
            corner: vector(rows[0]),
            edge1: vector(rows[1]),
            edge2: vector(rows[2]),
            material: rows[0].w,
            attributes: rows[1].w,
        }
    }

    /// The three rows of shading.
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
