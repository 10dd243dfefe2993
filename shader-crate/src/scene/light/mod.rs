//! Lights, chosen by power: emissive triangles, and the environment.

use crate::glam::{UVec4, Vec3};
use crate::math::random::unit_float;
use crate::math::wide::{Wide, multiply};
use crate::memory::device_struct;
use crate::memory::rows::{five_rows, float, vector};
use crate::scene::abilities::{Abilities, ENVIRONMENT};
use crate::scene::bvh::planes::Plane;
use crate::scene::environment::{EnvironmentSample, EnvironmentView};
use crate::scene::ray::SurfacePoint;
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

device_struct! {
    /// One emissive triangle, and one column of the alias table that chooses among them. 80 bytes.
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
        /// Unit normal of the front.
        pub normal: Vec3,
        /// `normal . x` of the points `x` of its plane, in world units.
        pub offset: f32,
    }
}

impl Light {
    /// Rows of one.
    pub const ROWS: u32 = 5;

    /// Unpacks the five rows, which are the struct's memory.
    pub fn from_rows(rows: [UVec4; 5]) -> Self {
        Self {
            corner: vector(rows[0]),
            threshold: rows[0].w,
            edge1: vector(rows[1]),
            alias: rows[1].w,
            edge2: vector(rows[2]),
            pdf: float(rows[2]),
            radiance: vector(rows[3]),
            pad: rows[3].w,
            normal: vector(rows[4]),
            offset: float(rows[4]),
        }
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
}

impl LightPoint {
    /// Where it is, and how a ray leaves it, see [`SurfacePoint::offset_roundings`].
    pub fn point(&self, offset_roundings: f32) -> SurfacePoint {
        SurfacePoint { position: self.position, normal: self.normal, offset_roundings }
    }
}

/// The choice of a light that shines on a point.
#[derive(Clone, Copy)]
pub struct LightSample {
    /// From the point to the light, unit length.
    pub direction: Vec3,
    /// Whether it is at infinity.
    pub is_distant: bool,
    /// How far it is, in world units; 1 at infinity.
    pub distance: f32,
    /// What the light sends back along the direction, linear Rec.709.
    pub radiance: Vec3,
    /// Density of the direction per solid angle, choice of the light included; 0 if the light does
    /// not shine on the point.
    pub pdf: f32,
    /// Whether no other technique than choosing lights can find this one.
    pub is_delta: bool,
    /// Density of the light's point per area in world units, choice included; at infinity [`pdf`](
    /// Self::pdf), per solid angle.
    pub area_pdf: f32,
    /// Cosine between the direction back and the light's normal; 1 at infinity.
    pub cosine: f32,
    /// Where a ray that tests the visibility ends: off the light's surface, or behind all others.
    pub end: Vec3,
}

/// The lights of a scene.
#[derive(Clone, Copy)]
pub struct LightView<'a, A> {
    /// The scene's buffer `surfaces`, see [`crate::scene`].
    pub rows: &'a [UVec4],
    /// Row of the first light.
    pub first: u32,
    /// How many there are, the environment included, which is the last.
    pub count: u32,
    /// See [`crate::scene::SceneParams::total_importance`].
    pub total_importance: f32,
    /// See [`crate::scene::SceneParams::offset_roundings`].
    pub offset_roundings: f32,
    /// The environment, if there is one.
    pub environment: EnvironmentView<'a>,
    /// What the scene uses.
    pub abilities: A,
}

impl<A: Abilities> LightView<'_, A> {
    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Whether there is an environment.
    #[inline(always)]
    pub fn has_environment(&self) -> bool {
        self.abilities.has(ENVIRONMENT) && self.environment.is_some()
    }

    /// Whether the light number `index` is the environment, not a triangle.
    #[inline(always)]
    pub fn is_environment(&self, index: u32) -> bool {
        self.has_environment() && index + 1 == self.count
    }

    /// The light number `index`, a triangle or what chooses the environment.
    pub fn light(&self, index: u32) -> Light {
        Light::from_rows(five_rows(self.rows, self.first + index * Light::ROWS))
    }

    /// A light, chosen by power with 32 random `bits`: Walker's alias method in integers.
    pub fn choose(&self, bits: u32) -> u32 {
        let Wide { high: column, low: fraction } = multiply(bits, self.count);
        let light = self.light(column);
        if fraction >> 8 < light.threshold { column } else { light.alias }
    }

    /// A uniform point of the light number `index`, a triangle, from a uniform point of the unit
    /// square.
    ///
    /// Heitz, "A Low-Distortion Map Between Triangle and Square", 2019.
    pub fn point_on(&self, index: u32, u: [f32; 2]) -> LightPoint {
        let light = self.light(index);
        let (a, b) = if u[1] > u[0] {
            let a = 0.5 * u[0];
            (a, u[1] - a)
        } else {
            let b = 0.5 * u[1];
            (u[0] - b, b)
        };
        let Light { normal, offset, .. } = light;
        // The sum has the roundings of the whole triangle; of those that count, the ones across it,
        // the plane leaves what the point itself has.
        let position = light.corner + light.edge1 * a + light.edge2 * b;
        LightPoint {
            position: Plane { normal, offset }.nearest_point(position),
            normal,
            radiance: light.radiance,
            pdf: light.pdf,
        }
    }

    /// A light for the point `from`, by 32 random bits for the `choice` of the light and 64 for the
    /// `point` on it.
    #[inline(always)]
    pub fn sample(&self, from: &SurfacePoint, choice: u32, point: [u32; 2]) -> LightSample {
        let index = self.choose(choice);
        if self.is_environment(index) {
            self.sample_environment(from, point)
        } else {
            self.sample_triangle(from, index, [unit_float(point[0]), unit_float(point[1])])
        }
    }

    fn sample_environment(&self, from: &SurfacePoint, point: [u32; 2]) -> LightSample {
        let EnvironmentSample { direction, pdf } = self.environment.sample(point);
        LightSample {
            direction,
            is_distant: true,
            distance: 1.0,
            radiance: self.environment.radiance(direction),
            pdf,
            is_delta: false,
            area_pdf: pdf,
            cosine: 1.0,
            end: self.environment.far_end(from.position, direction),
        }
    }

    #[inline(always)]
    fn sample_triangle(&self, from: &SurfacePoint, index: u32, u: [f32; 2]) -> LightSample {
        let light = self.point_on(index, u);
        let offset = light.position - from.position;
        let distance2 = offset.length_squared();
        let direction = offset.normalize();
        let cosine = -direction.dot(light.normal);
        let shines = cosine > 0.0 && distance2 > 0.0;
        let end = light.point(self.offset_roundings).end_towards(light.normal, from.position);
        LightSample {
            direction,
            is_distant: false,
            distance: distance2.sqrt(),
            radiance: light.radiance,
            pdf: if shines { light.pdf * distance2 / cosine } else { 0.0 },
            is_delta: false,
            area_pdf: light.pdf,
            cosine,
            end,
        }
    }

    /// The density per area of a point on a light of this `emission`.
    pub fn area_pdf(&self, emission: Vec3) -> f32 {
        area_pdf(emission, self.total_importance)
    }

    /// The density per solid angle with which [`Self::sample`] picks the direction to a triangle of
    /// this `emission` that was hit at `distance`, under this `cosine` to its normal.
    pub fn pdf_of_hit(&self, emission: Vec3, distance: f32, cosine: f32) -> f32 {
        self.area_pdf(emission) * distance * distance / cosine
    }
}
