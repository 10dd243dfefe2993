//! Lights without a surface: points, spots, and directions at infinity.
//!
//! No ray runs into them, so choosing lights is the only technique that finds them: they are delta
//! distributions, all but a direction with an angle, a sun, which no ray is asked about either.
//!
//! They are rows of the table of [lights](Light), whose words mean
//!
//! | | [`POINT`](super::POINT) | [`DIRECTION`] |
//! |---|---|---|
//! | `corner` | its position | middle of a ball around the scene |
//! | `normal` | the axis of its cone | where its light goes |
//! | `radiance` | radiant intensity along the axis | irradiance of a surface that faces it |
//! | `edge1` | scale and offset of the falloff, 1 - cosine of the cone | sine of half its angle, 0, 0 |
//! | `edge2` | unused | radius of the ball, 0, 0 |
//! | `pdf` | probability of its choice | the same |
//!
//! A point that shines in all directions has a cone of the cosine -1.

use super::{DIRECTION, Light, LightSample};
use crate::glam::Vec3;
use crate::math::angles::sin_cos_of_turns;
use crate::math::{concentric_disc, tangent_frame};
use crate::scene::environment::REACH;
use crate::scene::ray::{Ray, SurfacePoint};
use core::f32::consts::{PI, TAU};
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

/// A ray of light that leaves a punctual light.
#[derive(Clone, Copy)]
pub struct LightRay {
    /// From the light, or through the ball around the scene.
    pub ray: Ray,
    /// The flux that it stands for, linear Rec.709.
    pub flux: Vec3,
    /// Whether it comes from infinity.
    pub is_distant: bool,
    /// 1 over the density of the ray: per solid angle, or from infinity per area across it.
    pub extent: f32,
}

impl Light {
    /// Light of this punctual light for the point `from`, by a uniform point `u` of the unit
    /// square.
    pub(super) fn sample_punctual(&self, from: &SurfacePoint, u: [f32; 2]) -> LightSample {
        if self.kind == DIRECTION {
            self.sample_direction(from, u)
        } else {
            self.sample_point(from)
        }
    }

    fn sample_point(&self, from: &SurfacePoint) -> LightSample {
        let offset = self.corner - from.position;
        let distance2 = offset.length_squared();
        let direction = offset.normalize();
        let falloff = self.falloff(-direction);
        let shines = falloff > 0.0 && distance2 > 0.0;
        LightSample {
            direction,
            is_distant: false,
            distance: distance2.sqrt(),
            radiance: self.radiance * (falloff / distance2),
            pdf: if shines { self.pdf } else { 0.0 },
            is_delta: true,
            area_pdf: self.pdf,
            cosine: 1.0,
            emission_pdf: (1.0 / TAU) / self.edge1.z,
            disc_area: 0.0,
            end: self.corner,
        }
    }

    fn sample_direction(&self, from: &SurfacePoint, u: [f32; 2]) -> LightSample {
        let (direction, cosine) = self.direction_to(u);
        LightSample {
            direction,
            is_distant: true,
            distance: 1.0,
            radiance: self.radiance / cosine,
            pdf: self.pdf,
            is_delta: true,
            area_pdf: self.pdf,
            cosine: 1.0,
            emission_pdf: 0.0,
            disc_area: self.disc_area(),
            end: from.position + direction * (self.edge2.x * REACH),
        }
    }

    /// A ray of this punctual light, by uniform points of the unit square: `to` for its direction,
    /// `place` for where it crosses the disc that a distant light is seen through.
    pub fn emit(&self, to: [f32; 2], place: [f32; 2]) -> LightRay {
        if self.kind == DIRECTION {
            let (direction, cosine) = self.direction_to(to);
            let (x, y) = tangent_frame(direction);
            let (dx, dy) = concentric_disc(place);
            let start = self.corner + (direction + x * dx + y * dy) * self.edge2.x;
            let extent = self.disc_area();
            let flux = self.radiance * (extent / (cosine * self.pdf));
            let ray = Ray::new(start, -direction);
            return LightRay { ray, flux, is_distant: true, extent };
        }
        let (x, y) = tangent_frame(self.normal);
        // 1 - cosine; the sine follows from it without cancellation.
        let versine = to[0] * self.edge1.z;
        let sine = (versine * (2.0 - versine)).max(0.0).sqrt();
        let (rise, run) = sin_cos_of_turns(to[1]);
        let across = x * run + y * rise;
        let direction = (across * sine + self.normal * (1.0 - versine)).normalize();
        let extent = self.cone();
        let flux = self.radiance * (self.falloff(direction) * (extent / self.pdf));
        LightRay { ray: Ray::new(self.corner, direction), flux, is_distant: false, extent }
    }

    /// How much of its intensity goes in a direction: the square of a straight line over the cosine
    /// from the outer cone to the inner (glTF's KHR_lights_punctual).
    fn falloff(&self, direction: Vec3) -> f32 {
        let share = self.normal.dot(direction) * self.edge1.x + self.edge1.y;
        let share = share.min(1.0);
        if share > 0.0 { share * share } else { 0.0 }
    }

    /// Solid angle of its cone.
    fn cone(&self) -> f32 {
        TAU * self.edge1.z
    }

    /// A direction to a light at infinity, unit length, and its cosine to the middle of that light.
    /// It is drawn by what a surface that faces the middle gets from there: the offsets from the
    /// middle are uniform over a disc.
    fn direction_to(&self, u: [f32; 2]) -> (Vec3, f32) {
        let (dx, dy) = concentric_disc(u);
        let (dx, dy) = (dx * self.edge1.x, dy * self.edge1.x);
        let (x, y) = tangent_frame(-self.normal);
        let cosine = (1.0 - dx * dx - dy * dy).max(0.0).sqrt();
        ((x * dx + y * dy - self.normal * cosine).normalize(), cosine)
    }

    /// Area of the disc through which its light reaches the scene, in squared world units.
    fn disc_area(&self) -> f32 {
        PI * self.edge2.x * self.edge2.x
    }
}
