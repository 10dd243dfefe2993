//! Triangles as the traversal tests them: three rows each, in the order of the BVH's leaves.
//!
//! ```text
//! normal, its offset | u gradient, u offset | v gradient, v offset
//! ```
//!
//! Row layout: see [`crate::memory::rows`].

use crate::glam::{UVec4, Vec3};
use crate::memory::rows::{float, vector};

/// The plane of a triangle.
#[derive(Clone, Copy)]
pub struct Plane {
    /// Unit normal of the front, the side from which the corners run counter-clockwise.
    pub normal: Vec3,
    /// `normal . x` of the points `x` on it, in world units.
    pub offset: f32,
}

impl Plane {
    /// Unpacks a row.
    pub fn from_row(row: UVec4) -> Self {
        Self { normal: vector(row), offset: float(row) }
    }

    /// The point on it that is nearest to `point`, which is near it already.
    #[inline(always)]
    pub fn nearest_point(&self, point: Vec3) -> Vec3 {
        point + self.normal * (self.offset - self.normal.dot(point))
    }
}

/// A triangle as three affine functions of a point: the distance from its plane and two barycentric
/// coordinates.
#[derive(Clone, Copy)]
pub struct Planes {
    /// See the [module](self).
    pub rows: [UVec4; 3],
}

impl Planes {
    /// Rows of one.
    pub const ROWS: u32 = 3;

    /// The plane that it lies in.
    pub fn plane(&self) -> Plane {
        Plane::from_row(self.rows[0])
    }

    /// Where the line `origin + t * direction` meets the triangle's plane, as `(t, u, v)`; outside
    /// the triangle `t` is negative. Both sides count.
    ///
    /// After Havel and Herout, "Yet Faster Ray-Triangle Intersection (Using SSE4)", TVCG 16(3),
    /// 2010, but for the division, which they put off. No threshold on the angle: a line in the
    /// plane gives infinities or NaN, which fail a comparison.
    #[inline(always)]
    pub fn intersect(&self, origin: Vec3, direction: Vec3) -> (f32, f32, f32) {
        let [_, u_plane, v_plane] = self.rows;
        let Plane { normal, offset } = self.plane();
        let t = (offset - normal.dot(origin)) / normal.dot(direction);
        let point = origin + direction * t;
        let u = vector(u_plane).dot(point) + float(u_plane);
        let v = vector(v_plane).dot(point) + float(v_plane);
        let inside = u >= 0.0 && v >= 0.0 && u + v <= 1.0;
        (if inside { t } else { -1.0 }, u, v)
    }
}
