//! Rays, hits, and how a ray leaves a surface.

use crate::glam::Vec3;
use crate::math::UNIT_ROUNDOFF;
use crate::memory::device_struct;

device_struct! {
    /// A ray, and how far along it a surface counts. 32 bytes.
    pub struct Ray {
        /// Where it starts, in world units.
        pub origin: Vec3,
        /// Hits at `t >= t_max` do not count. In units of `direction`'s length.
        pub t_max: f32,
        /// Where it goes; need not be of unit length.
        pub direction: Vec3,
        /// Unused; zero.
        pub pad: f32,
    }
}

/// [`Ray::t_max`] of a ray without an end: beyond every scene, and a number that WGSL takes in
/// decimal, unlike `f32::MAX`, which rounds up to infinity there.
pub const NO_END: f32 = 1e38;

impl Ray {
    /// The ray from `origin` along `direction` without an end.
    pub fn new(origin: Vec3, direction: Vec3) -> Self {
        Self::segment(origin, direction, NO_END)
    }

    /// The ray from `origin` along `direction` up to, but not including, `t_max`.
    pub fn segment(origin: Vec3, direction: Vec3, t_max: f32) -> Self {
        Self { origin, t_max, direction, pad: 0.0 }
    }
}

/// [`Hit::triangle`] where nothing was hit.
pub const NO_TRIANGLE: u32 = u32::MAX;

device_struct! {
    /// What a ray hit. 16 bytes.
    pub struct Hit {
        /// Distance in units of the ray's direction.
        pub t: f32,
        /// Barycentric coordinate of the triangle's second corner.
        pub u: f32,
        /// Barycentric coordinate of the triangle's third corner.
        pub v: f32,
        /// Index into the triangle table, in the order of the BVH; [`NO_TRIANGLE`] for a miss.
        pub triangle: u32,
    }
}

impl Hit {
    /// Nothing hit before `t_max`.
    pub fn miss(t_max: f32) -> Self {
        Self { t: t_max, u: 0.0, v: 0.0, triangle: NO_TRIANGLE }
    }

    /// Whether there is a triangle.
    pub fn is_some(&self) -> bool {
        self.triangle != NO_TRIANGLE
    }
}

/// How many roundings of its largest coordinate a point is moved away from surfaces, unless a
/// render says otherwise: those of the position (5), of the intersection with a neighbour (about as
/// many) and of the boxes' planes, with room for a driver's own arithmetic.
pub const OFFSET_ROUNDINGS: f32 = 32.0;

/// A point on a surface and the bound of its rounding error.
///
/// A point that is computed from barycentric coordinates lies off its triangle by a few roundings
/// of its largest coordinate, so that is how far a ray that leaves must be moved, along the
/// geometric normal: scale the scene, and the offset scales with it.
#[derive(Clone, Copy)]
pub struct SurfacePoint {
    /// Where, in world units.
    pub position: Vec3,
    /// Unit normal of the triangle, of either sign.
    pub normal: Vec3,
    /// The largest magnitude that entered the position, in world units.
    pub magnitude: f32,
    /// How far rays that leave start from the surface, in roundings of `magnitude`:
    /// [`OFFSET_ROUNDINGS`].
    pub offset_roundings: f32,
}

impl SurfacePoint {
    /// The origin of a ray that leaves towards `direction`.
    pub fn offset_towards(&self, direction: Vec3) -> Vec3 {
        let distance = self.offset_roundings * UNIT_ROUNDOFF * self.magnitude;
        let signed = if direction.dot(self.normal) < 0.0 { -distance } else { distance };
        self.position + self.normal * signed
    }
}
