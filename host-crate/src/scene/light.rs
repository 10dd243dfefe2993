//! What emits light and is no mesh.

use super::bounds;
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

/// A light without a surface. It lights surfaces that are no mirrors; neither the camera nor its
/// mirror image sees the light itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PunctualLight {
    /// A point that shines alike in all directions.
    Point {
        /// Where it is, in world units.
        position: Vec3,
        /// Radiant intensity, linear Rec.709, each component in [0, 1e12].
        intensity: Vec3,
    },
    /// A point that shines into a cone. Between the two angles its intensity falls off smoothly, as
    /// glTF's `KHR_lights_punctual` has it: by the square of a straight line over the cosine.
    Spot {
        /// Where it is, in world units.
        position: Vec3,
        /// Where it shines, of any length but 0.
        direction: Vec3,
        /// Radiant intensity in that direction, linear Rec.709, each component in [0, 1e12].
        intensity: Vec3,
        /// Angle to the direction, in degrees, up to which the intensity is the full one; from 0 to
        /// `outer_angle`.
        inner_angle: f32,
        /// Angle to the direction, in degrees, from which on there is no light; above 0, at most
        /// 180.
        outer_angle: f32,
    },
    /// Light from infinity, such as the sun's.
    Directional {
        /// Where its light goes, of any length but 0.
        direction: Vec3,
        /// Irradiance of a surface that faces it, linear Rec.709, each component in [0, 1e12].
        irradiance: Vec3,
        /// How large it looks: its diameter in degrees, from 0 to 90. The sun's is 0.53. Shadows
        /// are the softer for it.
        angle: f32,
    },
}

impl PunctualLight {
    /// A point that shines alike in all directions; see the fields.
    pub fn point(position: Vec3, intensity: Vec3) -> Self {
        Self::Point { position, intensity }
    }

    /// Light from infinity that goes in this `direction`, with sharp shadows; see the fields.
    pub fn directional(direction: Vec3, irradiance: Vec3) -> Self {
        Self::Directional { direction, irradiance, angle: 0.0 }
    }

    /// Its radiant intensity, or irradiance if it is at infinity: linear Rec.709.
    pub fn colour(&self) -> Vec3 {
        match *self {
            Self::Point { intensity, .. } | Self::Spot { intensity, .. } => intensity,
            Self::Directional { irradiance, .. } => irradiance,
        }
    }

    /// What is wrong with it: the field, and a sentence about it.
    pub(super) fn check(&self) -> Result<(), (&'static str, String)> {
        let values = |vector: Vec3| vector.as_dvec3().to_array();
        let place = |name, vector| {
            bounds::coordinates(&values(vector)).map(drop).map_err(|what| (name, what))
        };
        let emits =
            |name, colour| bounds::radiance(&values(colour)).map(drop).map_err(|what| (name, what));
        let points = |vector: Vec3| {
            place("direction", vector)?;
            bounds::direction(vector.as_dvec3()).map_err(|what| ("direction", what.to_owned()))
        };
        match *self {
            Self::Point { position, intensity } => {
                place("position", position)?;
                emits("intensity", intensity)
            }
            Self::Spot { position, direction, intensity, inner_angle, outer_angle } => {
                place("position", position)?;
                points(direction)?;
                emits("intensity", intensity)?;
                bounds::cone(inner_angle.into(), outer_angle.into())
            }
            Self::Directional { direction, irradiance, angle } => {
                points(direction)?;
                emits("irradiance", irradiance)?;
                bounds::angular_diameter(angle.into()).map(drop).map_err(|what| ("angle", what))
            }
        }
    }
}
