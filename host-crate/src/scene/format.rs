//! The scene file: JSON, format 1, checked key by key as it is read.

use super::rule::MaterialRule;
use super::values::{AngleOfView, Coordinates, Depth, FilmSide, Object, Radiance};
use super::{CameraSettings, FilmSize, PathLimits, SceneError};
use serde::Deserialize;
use serde::de::IgnoredAny;
use std::collections::BTreeMap;
use std::path::Path;

/// A scene file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SceneFile {
    #[serde(rename = "format")]
    _format: IgnoredAny,
    #[serde(default, rename = "about")]
    _about: IgnoredAny,
    pub name: String,
    pub obj: String,
    film: Object<Film>,
    camera: Object<Camera>,
    #[serde(default)]
    pub normals: Normals,
    #[serde(default)]
    pub dedupe: bool,
    #[serde(default)]
    pub materials: BTreeMap<String, Object<MaterialRule>>,
    #[serde(default)]
    pub quads: Vec<Object<Quad>>,
    #[serde(default)]
    integrator: Object<Integrator>,
}

impl SceneFile {
    /// Reads a scene file; `path` is for messages only.
    pub(super) fn parse(path: &Path, json: &[u8]) -> Result<Self, SceneError> {
        // First and alone: a later format has keys that format 1 does not know.
        let Version { format } = parse(path, json)?;
        if format != 1 {
            return Err(SceneError::Format { path: path.to_owned(), found: format });
        }
        parse(path, json)
    }

    pub(super) fn film(&self) -> FilmSize {
        FilmSize { width: self.film.0.width.0, height: self.film.0.height.0 }
    }

    pub(super) fn camera(&self) -> CameraSettings {
        self.camera.0.0
    }

    pub(super) fn limits(&self) -> PathLimits {
        let Object(integrator) = &self.integrator;
        PathLimits { max_depth: integrator.max_depth.0, roulette_depth: integrator.rr_depth.0 }
    }
}

#[derive(Deserialize)]
struct Version {
    format: u64,
}

fn parse<'de, T: Deserialize<'de>>(path: &Path, json: &'de [u8]) -> Result<T, SceneError> {
    let fail = |key: String, source| SceneError::Json { path: path.to_owned(), key, source };
    let mut deserializer = serde_json::Deserializer::from_slice(json);
    let Object(parsed) = serde_path_to_error::deserialize(&mut deserializer).map_err(|error| {
        let key = error.path().to_string();
        fail(if key == "." { String::new() } else { key }, error.into_inner())
    })?;
    deserializer.end().map_err(|source| fail(String::new(), source))?;
    Ok(parsed)
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Film {
    width: FilmSide,
    height: FilmSide,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct Integrator {
    max_depth: Depth,
    rr_depth: Depth,
}

impl Default for Integrator {
    fn default() -> Self {
        Self { max_depth: Depth(8), rr_depth: Depth(5) }
    }
}

/// Where shading normals come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Normals {
    /// The triangle.
    #[default]
    Flat,
    /// The OBJ's vn, interpolated.
    Smooth,
}

#[derive(Debug, Deserialize)]
#[serde(try_from = "CameraKeys")]
struct Camera(CameraSettings);

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CameraKeys {
    origin: Coordinates,
    target: Coordinates,
    up: Coordinates,
    fov_y: AngleOfView,
}

/// The smallest sine of the angle between the view and up.
const MIN_SINE_TO_UP: f64 = 1e-5;

impl TryFrom<CameraKeys> for Camera {
    type Error = &'static str;

    fn try_from(keys: CameraKeys) -> Result<Self, Self::Error> {
        let settings = CameraSettings {
            origin: keys.origin.0.as_vec3(),
            target: keys.target.0.as_vec3(),
            up: keys.up.0.as_vec3(),
            fov_y: keys.fov_y.0,
        };
        // As an f32 sees them: that is what the picture is made from.
        let view = (settings.target - settings.origin).as_dvec3();
        let Some(view) = view.try_normalize() else {
            return Err("origin and target are the same point: there is no direction to look in");
        };
        let up = settings.up.as_dvec3().normalize_or_zero();
        if view.cross(up).length() < MIN_SINE_TO_UP {
            return Err("up is zero or along the view: it must point to a side of the picture");
        }
        Ok(Self(settings))
    }
}

/// A parallelogram that emits on the side of cross(u, v).
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Quad {
    pub corner: Coordinates,
    pub u: Coordinates,
    pub v: Coordinates,
    pub radiance: Radiance,
}
