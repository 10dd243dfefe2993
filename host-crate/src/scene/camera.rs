//! The camera.

use super::bounds;
use super::film::FilmSize;
use glam::Vec3;

/// The smallest sine of the angle between the view and up.
const MIN_SINE_TO_UP: f64 = 1e-5;

/// A pinhole camera with square pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// The pinhole, in world units.
    pub origin: Vec3,
    /// A point in the middle of the picture; differs from `origin`.
    pub target: Vec3,
    /// Upwards in the picture, of any length but 0; not parallel to the view.
    pub up: Vec3,
    /// Vertical angle of view in degrees, in (0, 180).
    pub fov_y: f32,
}

/// A camera of a file that has several.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedCamera {
    /// What it is called.
    pub name: String,
    /// The camera.
    pub camera: Camera,
    /// The size of its picture.
    pub film: FilmSize,
}

impl Camera {
    /// A camera at `origin` that looks at `target`, both in world units, with y upwards and an
    /// angle of view of `fov_y` degrees over the picture's height.
    pub fn new(origin: Vec3, target: Vec3, fov_y: f32) -> Self {
        Self { origin, target, up: Vec3::Y, fov_y }
    }

    /// What is wrong with it, as a sentence about its fields.
    pub(super) fn check(&self) -> Result<(), String> {
        let vectors = [("origin", self.origin), ("target", self.target), ("up", self.up)];
        for (name, vector) in vectors {
            bounds::coordinates(&vector.as_dvec3().to_array())
                .map_err(|what| format!("{name} {what}"))?;
        }
        bounds::angle_of_view(self.fov_y.into()).map_err(|what| format!("fov_y {what}"))?;
        self.check_directions().map_err(str::to_owned)
    }

    /// Whether it has a direction to look in and another one upwards.
    pub(super) fn check_directions(&self) -> Result<(), &'static str> {
        // As an f32 sees them: that is what the picture is made from.
        let view = (self.target - self.origin).as_dvec3();
        let Some(view) = view.try_normalize() else {
            return Err("origin and target are the same point: there is no direction to look in");
        };
        let up = self.up.as_dvec3().normalize_or_zero();
        if view.cross(up).length() < MIN_SINE_TO_UP {
            return Err("up is zero or along the view: it must point to a side of the picture");
        }
        Ok(())
    }
}
