//! Emissive triangles, chosen by power.

use crate::glam::Vec3;
use crate::math::triangle_normal;
use crate::math::wide::{Wide, multiply};
use crate::memory::access::at;
use crate::memory::device_struct;
use crate::scene::ray::SurfacePoint;

device_struct! {
    /// One emissive triangle, and one column of the alias table that chooses among them. 64 bytes.
    pub struct Light {
        /// First corner, in world units.
        pub corner: Vec3,
        /// The column stands for its own light if a random number of 24 bits is below this (at most
        /// 2^24).
        pub threshold: u32,
        /// From the first corner to the second.
        pub edge1: Vec3,
        /// The light that the column stands for otherwise.
        pub alias: u32,
        /// From the first corner to the third.
        pub edge2: Vec3,
        /// Density of a point of this light, choice included, per area in world units: see
        /// [`area_pdf`].
        pub pdf: f32,
        /// Radiance of the front, linear Rec.709.
        pub radiance: Vec3,
        /// Unused; zero.
        pub pad: u32,
    }
}

/// Radiance as one number, for the choice: the mean of its components.
pub fn importance(radiance: Vec3) -> f32 {
    (radiance.x + radiance.y + radiance.z) * (1.0 / 3.0)
}

/// Density per area of choosing a point on a triangle of this `radiance`, when the choice is by
/// power: importance times area over `total_importance` (the sum of that over all lights), times
/// one over the area. The area cancels, so a path that finds a light knows the density from the
/// material alone.
pub fn area_pdf(radiance: Vec3, total_importance: f32) -> f32 {
    importance(radiance) / total_importance
}

/// A point on a light.
#[derive(Clone, Copy)]
pub struct LightPoint {
    /// Where, in world units.
    pub position: Vec3,
    /// Unit normal of the side that emits.
    pub normal: Vec3,
    /// What that side emits, linear Rec.709.
    pub radiance: Vec3,
    /// Density per area, choice included.
    pub pdf: f32,
    /// The largest magnitude that entered the position, in world units.
    pub magnitude: f32,
}

impl LightPoint {
    /// Where it is, and how a ray leaves it, see [`SurfacePoint::offset_roundings`].
    pub fn point(&self, offset_roundings: f32) -> SurfacePoint {
        SurfacePoint {
            position: self.position,
            normal: self.normal,
            magnitude: self.magnitude,
            offset_roundings,
        }
    }
}

/// The lights of a scene.
#[derive(Clone, Copy)]
pub struct LightView<'a> {
    lights: &'a [Light],
    count: u32,
}

impl<'a> LightView<'a> {
    /// Wraps the buffer, whose first `count` elements are lights.
    pub fn new(lights: &'a [Light], count: u32) -> Self {
        Self { lights, count }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// A light, chosen by power with 32 random `bits`: Walker's alias method in integers.
    pub fn choose(&self, bits: u32) -> u32 {
        let Wide { high: column, low: fraction } = multiply(bits, self.count);
        let light = at(self.lights, column);
        if fraction >> 8 < light.threshold { column } else { light.alias }
    }

    /// A uniform point of the light number `index`, from a uniform point of the unit square.
    ///
    /// Heitz, "A Low-Distortion Map Between Triangle and Square", 2019.
    pub fn sample(&self, index: u32, u: [f32; 2]) -> LightPoint {
        let light = at(self.lights, index);
        let (a, b) = if u[1] > u[0] {
            let a = 0.5 * u[0];
            (a, u[1] - a)
        } else {
            let b = 0.5 * u[1];
            (u[0] - b, b)
        };
        LightPoint {
            position: light.corner + light.edge1 * a + light.edge2 * b,
            normal: triangle_normal(light.edge1, light.edge2),
            radiance: light.radiance,
            pdf: light.pdf,
            magnitude: (light.corner.abs() + light.edge1.abs() + light.edge2.abs()).max_element(),
        }
    }
}
