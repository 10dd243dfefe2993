//! The camera of a scene file.

use super::values::{AngleOfView, Blades, Coordinates, Distance, LensRadius, Place, present};
use crate::scene::camera::{Camera, Lens, Projection};
use glam::DVec3;
use serde::Deserialize;

/// A camera, whose keys fit together.
#[derive(Debug, Deserialize)]
#[serde(try_from = "CameraKeys")]
pub(super) struct FileCamera {
    origin: DVec3,
    target: DVec3,
    up: DVec3,
    projection: Projection,
}

/// All keys of all cameras. One flat struct, so that messages name the key and its line.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct CameraKeys {
    #[serde(rename = "type", default)]
    kind: Kind,
    origin: Place,
    target: Place,
    up: Coordinates,
    #[serde(default, deserialize_with = "present")]
    fov_y: Option<AngleOfView>,
    #[serde(default, deserialize_with = "present")]
    aperture: Option<LensRadius>,
    #[serde(default, deserialize_with = "present")]
    focus: Option<Distance>,
    #[serde(default, deserialize_with = "present")]
    blades: Option<Blades>,
    #[serde(default, deserialize_with = "present")]
    width: Option<Distance>,
}

#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Kind {
    #[default]
    Perspective,
    Orthographic,
    Panorama,
}

impl TryFrom<CameraKeys> for FileCamera {
    type Error = String;

    /// Checks the directions as they are where coordinates are small.
    fn try_from(keys: CameraKeys) -> Result<Self, String> {
        let (origin, target, up) = (keys.origin.0, keys.target.0, keys.up.0);
        let projection = match keys.kind {
            Kind::Perspective => {
                keys.refuse("a perspective", &["width"])?;
                let AngleOfView(fov_y) =
                    keys.fov_y.ok_or("a perspective camera needs the key `fov_y`")?;
                Projection::Perspective { fov_y, lens: keys.lens((target - origin).length())? }
            }
            Kind::Orthographic => {
                keys.refuse("an orthographic", &["fov_y", "aperture", "focus", "blades"])?;
                let Distance(width) =
                    keys.width.ok_or("an orthographic camera needs the key `width`")?;
                Projection::Orthographic { width }
            }
            Kind::Panorama => {
                keys.refuse("a panorama", &["fov_y", "aperture", "focus", "blades", "width"])?;
                Projection::Panorama
            }
        };
        let camera = Self { origin, target, up, projection };
        camera.seen_from(origin)?;
        Ok(camera)
    }
}

impl CameraKeys {
    /// The lens, if there is one, in focus at the target unless the file says otherwise.
    fn lens(&self, to_target: f64) -> Result<Option<Lens>, String> {
        let Some(LensRadius(radius)) = self.aperture else {
            return match self.given(&["focus", "blades"]) {
                Some(key) => Err(format!("`{key}` needs a lens: give `aperture`, its radius")),
                None => Ok(None),
            };
        };
        Ok(Some(Lens {
            radius,
            focus_distance: self.focus.map_or(to_target as f32, |Distance(focus)| focus),
            blades: self.blades.map_or(0, |Blades(blades)| blades),
        }))
    }

    fn refuse(&self, kind: &str, keys: &[&str]) -> Result<(), String> {
        match self.given(keys) {
            Some(key) => Err(format!("{kind} camera has no key `{key}`")),
            None => Ok(()),
        }
    }

    /// The first of these keys that is given.
    fn given<'k>(&self, keys: &[&'k str]) -> Option<&'k str> {
        let is_given = |key: &str| match key {
            "fov_y" => self.fov_y.is_some(),
            "aperture" => self.aperture.is_some(),
            "focus" => self.focus.is_some(),
            "blades" => self.blades.is_some(),
            _ => self.width.is_some(),
        };
        keys.iter().copied().find(|key| is_given(key))
    }
}

impl FileCamera {
    /// The camera where `origin` is the origin.
    pub(super) fn seen_from(&self, origin: DVec3) -> Result<Camera, &'static str> {
        let camera = Camera {
            origin: (self.origin - origin).as_vec3(),
            target: (self.target - origin).as_vec3(),
            up: self.up.as_vec3(),
            projection: self.projection,
        };
        camera.check_directions()?;
        Ok(camera)
    }
}
