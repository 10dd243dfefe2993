//! What emits light and is no mesh.

use super::mesh::has_area;
use glam::{DVec3, Vec3};

/// A parallelogram that emits from one side, that of `u.cross(v)`, and reflects nothing.
///
/// Its vectors are f64: two of its corners are sums of them, and are rounded only once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuadLight {
    /// A corner, in world units.
    pub corner: DVec3,
    /// From there to one neighbouring corner.
    pub u: DVec3,
    /// From there to the other one; not parallel to `u`.
    pub v: DVec3,
    /// Radiance, linear Rec.709, each component in [0, 1e12].
    pub radiance: Vec3,
}

impl QuadLight {
    /// A light with a `corner`, the edges `u` and `v` that start there, in world units, and a
    /// `radiance`, linear Rec.709. It emits from the side of `u.cross(v)`.
    pub fn new(corner: Vec3, u: Vec3, v: Vec3, radiance: Vec3) -> Self {
        let [corner, u, v] = [corner, u, v].map(Vec3::as_dvec3);
        Self { corner, u, v, radiance }
    }

    /// The corners of its two triangles, counter-clockwise as seen from the side that emits.
    pub fn triangles(&self) -> [[Vec3; 3]; 2] {
        let (o, u, v) = (self.corner, self.u, self.v);
        let [a, b, c, d] = [o, o + u, o + u + v, o + v].map(DVec3::as_vec3);
        [[a, b, c], [a, c, d]]
    }

    /// Whether both triangles have an area.
    pub(super) fn has_area(&self) -> bool {
        self.triangles().into_iter().all(has_area)
    }
}
