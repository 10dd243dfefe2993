//! The camera.

use super::bounds;
use super::film::FilmSize;
use glam::Vec3;

/// The smallest sine of the angle between the view and up.
const MIN_SINE_TO_UP: f64 = 1e-5;

/// A camera with square pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Where it is, in world units: the pinhole, the middle of the lens, a point of the plane on
    /// which orthographic rays start, or the eye of a panorama.
    pub origin: Vec3,
    /// A point in the middle of the picture; differs from `origin`.
    pub target: Vec3,
    /// Upwards in the picture, of any length but 0; not parallel to the view.
    pub up: Vec3,
    /// How the world becomes a picture.
    pub projection: Projection,
}

/// How the world becomes a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// As the eye sees it.
    Perspective {
        /// Vertical angle of view in degrees, in (0, 180).
        fov_y: f32,
        /// A lens in place of the pinhole: what is not in focus is blurred.
        lens: Option<Lens>,
    },
    /// By parallel rays. What is behind the plane through the camera's origin is not seen.
    Orthographic {
        /// Width of the picture in world units, above 0 and at most 1e9.
        width: f32,
    },
    /// All around, equirectangular: columns are meridians, rows are circles of latitude, and the
    /// whole sphere fills the picture. Twice as wide as high, it has square pixels at its equator.
    Panorama,
}

/// A thin lens: points at one distance are sharp, all others become pictures of the aperture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// Radius of the aperture in world units, in [0, 1e9]: the focal length over twice the
    /// f-number. 0 is a pinhole.
    pub radius: f32,
    /// Distance along the view, in world units, of the plane in which points are sharp; above 0 and
    /// at most 1e9.
    pub focus_distance: f32,
    /// Corners of the aperture, a regular polygon whose corners are `radius` from its middle, from
    /// 3 to 64; 0 for a disc.
    pub blades: u32,
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
    pub const fn new(origin: Vec3, target: Vec3, fov_y: f32) -> Self {
        let projection = Projection::Perspective { fov_y, lens: None };
        Self { origin, target, up: Vec3::Y, projection }
    }

    /// What is wrong with it, as a sentence about its fields.
    pub(super) fn check(&self) -> Result<(), String> {
        let vectors = [("origin", self.origin), ("target", self.target), ("up", self.up)];
        for (name, vector) in vectors {
            bounds::coordinates(&vector.as_dvec3().to_array())
                .map_err(|what| format!("{name} {what}"))?;
        }
        self.projection.check()?;
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

impl Projection {
    /// Whether what the camera sees is blurred where it is out of focus.
    pub fn has_lens(&self) -> bool {
        matches!(self, Self::Perspective { lens: Some(lens), .. } if lens.radius > 0.0)
    }

    fn check(&self) -> Result<(), String> {
        let named = |name: &str, checked: Result<f32, String>| match checked {
            Ok(_) => Ok(()),
            Err(what) => Err(format!("{name} {what}")),
        };
        match *self {
            Self::Perspective { fov_y, lens } => {
                named("fov_y", bounds::angle_of_view(fov_y.into()))?;
                let Some(lens) = lens else { return Ok(()) };
                named("lens.radius", bounds::lens_radius(lens.radius.into()))?;
                named("lens.focus_distance", bounds::distance(lens.focus_distance.into()))?;
                bounds::blades(lens.blades.into())
                    .map(drop)
                    .map_err(|what| format!("lens.blades {what}"))
            }
            Self::Orthographic { width } => named("width", bounds::distance(width.into())),
            Self::Panorama => Ok(()),
        }
    }
}
