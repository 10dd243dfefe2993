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
/// render says otherwise. Any number from 21 on is safe, see [`SurfacePoint`]; the rest is room for
/// a driver's own arithmetic.
pub const OFFSET_ROUNDINGS: f32 = 32.0;

/// How far off a surface rays start, in world units, where the largest coordinate is `magnitude`.
pub fn offset_distance(offset_roundings: f32, magnitude: f32) -> f32 {
    offset_roundings * UNIT_ROUNDOFF * magnitude
}

/// How far off a surface rays start.
#[derive(Clone, Copy)]
pub struct Clearance {
    /// In roundings of the largest coordinate: [`OFFSET_ROUNDINGS`], or more in an
    /// [instance](crate::scene::bvh::instance), whose hits have the roundings of its transform
    /// besides.
    pub roundings: f32,
    /// What is added to the largest coordinate, in world units: 0 but in an instance, whose shape
    /// has roundings of its own extent.
    pub spread: f32,
}

impl Clearance {
    /// That of what is in no instance.
    #[inline(always)]
    pub fn of_world(offset_roundings: f32) -> Self {
        Self { roundings: offset_roundings, spread: 0.0 }
    }

    /// The distance in world units at a point whose largest coordinate is `magnitude`.
    #[inline(always)]
    pub fn distance(&self, magnitude: f32) -> f32 {
        // No sum where it is 0, which is known when a kernel without instances is compiled.
        let reach = if self.spread == 0.0 { magnitude } else { magnitude + self.spread };
        offset_distance(self.roundings, reach)
    }
}

/// A point on a surface, from which rays leave.
///
/// How far off the surface a ray has to start follows from the point alone, and not from the
/// triangle that it is on: a plane that goes on for a thousand kilometres is as exact near the
/// origin as one of a metre.
///
/// **The bound.** Let `M` be the point's largest coordinate, `u` = 2^-24, and `(n, c)` a plane as
/// [stored](crate::scene::bvh::planes), `n . x = c`, with `n` of unit length, so that
/// `|n.x| + |n.y| + |n.z| <= sqrt(3)`. A sum of three products has an error of at most
/// `3 u sqrt(3) M`, in any order and with or without fused operations.
///
/// - [`Triangle::point`](crate::scene::triangle::Triangle::point) ends with a step onto the plane
///   along its normal. The step's length has that error, 5.2 u M, and the sum is rounded, 1.7 u M:
///   the point lies at most 6.9 u M off the stored plane.
/// - A ray that starts at `o` meets the plane at `t = (c - n . o) / (n . d)`. The numerator has the
///   error of the product, 5.2 u M, `o` has that of its own rounding, 1.7 u M. So from 13.9 u M on
///   the numerator has the sign of the side that the ray starts on, `t` is negative, and the
///   triangle that a ray leaves is not hit again.
/// - Rounding `n` and `c` to f32 puts a plane at most 3.5 u M off the triangle, here its neighbour
///   in the same plane and itself: 20.8 u M in all.
///
/// Of instances the host works out how much there is besides, see [`Clearance`].
#[derive(Clone, Copy)]
pub struct SurfacePoint {
    /// Where, in world units.
    pub position: Vec3,
    /// Unit normal of the triangle, of either sign.
    pub normal: Vec3,
    /// How far rays that leave start from the surface.
    pub clearance: Clearance,
}

impl SurfacePoint {
    /// The origin of a ray that leaves towards `direction`.
    pub fn offset_towards(&self, direction: Vec3) -> Vec3 {
        self.moved(direction, self.magnitude())
    }

    /// The end of a segment that comes from the point `from` along `-direction`. Where it meets the
    /// surface is as uncertain as either end is.
    pub fn end_towards(&self, direction: Vec3, from: Vec3) -> Vec3 {
        self.moved(direction, self.magnitude().max(from.abs().max_element()))
    }

    /// What the roundings of the position are relative to.
    fn magnitude(&self) -> f32 {
        self.position.abs().max_element()
    }

    fn moved(&self, direction: Vec3, magnitude: f32) -> Vec3 {
        let distance = self.clearance.distance(magnitude);
        let signed = if direction.dot(self.normal) < 0.0 { -distance } else { distance };
        self.position + self.normal * signed
    }
}
