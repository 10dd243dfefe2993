//! The scene file: JSON, format 1, checked key by key as it is read.

use super::material::FileMaterial;
use super::values::{AngleOfView, Coordinates, Depth, FilmSide, Object, Radiance};
use crate::scene::camera::Camera;
use crate::scene::error::SceneError;
use crate::scene::film::FilmSize;
use crate::scene::light::QuadLight;
use crate::scene::limits::PathLimits;
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
    camera: Object<FileCamera>,
    #[serde(default)]
    pub normals: Normals,
    #[serde(default)]
    pub dedupe: bool,
    #[serde(default)]
    pub materials: BTreeMap<String, Object<FileMaterial>>,
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

    pub(super) fn camera(&self) -> Camera {
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
        let PathLimits { max_depth, roulette_depth } = PathLimits::default();
        Self { max_depth: Depth(max_depth), rr_depth: Depth(roulette_depth) }
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
struct FileCamera(Camera);

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CameraKeys {
    origin: Coordinates,
    target: Coordinates,
    up: Coordinates,
    fov_y: AngleOfView,
}

impl TryFrom<CameraKeys> for FileCamera {
    type Error = &'static str;

    fn try_from(keys: CameraKeys) -> Result<Self, Self::Error> {
        let camera = Camera {
            origin: keys.origin.0.as_vec3(),
            target: keys.target.0.as_vec3(),
            up: keys.up.0.as_vec3(),
            fov_y: keys.fov_y.0,
        };
        camera.check_directions()?;
        Ok(Self(camera))
    }
}

/// A parallelogram that emits on the side of cross(u, v).
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Quad {
    corner: Coordinates,
    u: Coordinates,
    v: Coordinates,
    radiance: Radiance,
}

impl Quad {
    pub(super) fn light(&self) -> QuadLight {
        QuadLight { corner: self.corner.0, u: self.u.0, v: self.v.0, radiance: self.radiance.0 }
    }
}
