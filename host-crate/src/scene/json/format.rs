//! The scene file: JSON, format 1, checked key by key as it is read.

use super::material::FileMaterial;
use super::values::{AngleOfView, Coordinates, Depth, FilmSide, Object, Place, Radiance};
use super::wrong_kind;
use crate::scene::camera::Camera;
use crate::scene::error::SceneError;
use crate::scene::film::FilmSize;
use crate::scene::light::QuadLight;
use crate::scene::limits::PathLimits;
use crate::scene::text::plain_text;
use glam::DVec3;
use serde::Deserialize;
use serde::de::{Error as _, IgnoredAny};
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
        let wrong = |what| SceneError::WrongKind { path: path.to_owned(), what };
        let json =
            plain_text(json).map_err(|what| wrong(wrong_kind::by_ending(path).unwrap_or(what)))?;
        if let Some(what) = wrong_kind::of(path, json) {
            return Err(wrong(what));
        }
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

    /// The camera, with `origin` taken off its place; the error says what is then wrong with it.
    pub(super) fn camera(&self, origin: DVec3) -> Result<Camera, String> {
        let camera = self.camera.0.seen_from(origin)?;
        camera.check()?;
        Ok(camera)
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
        let key = known_key(&error.path().to_string());
        fail(key, with_comma_named(json, error.into_inner()))
    })?;
    deserializer.end().map_err(|source| fail(String::new(), source))?;
    Ok(parsed)
}

/// The error, which says so if a comma too many is why.
fn with_comma_named(json: &[u8], error: serde_json::Error) -> serde_json::Error {
    let (line, column) = (error.line(), error.column());
    let lines = json.split(|&byte| byte == b'\n').take(line.saturating_sub(1));
    let start: usize = lines.map(|line| line.len() + 1).sum();
    let until = &json[..(start + column).min(json.len())];
    let before = until.strip_suffix(b"}").or_else(|| until.strip_suffix(b"]"));
    if error.is_syntax() && before.is_some_and(|text| text.trim_ascii_end().ends_with(b",")) {
        let what = format!("trailing comma before line {line} column {column}; remove it");
        return serde_json::Error::custom(what);
    }
    error
}

/// The part of a key that is known: none at the top level, or where no key could be read.
fn known_key(path: &str) -> String {
    let path = path.strip_suffix('?').unwrap_or(path);
    path.strip_suffix('.').unwrap_or(path).to_owned()
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
struct FileCamera(CameraKeys);

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct CameraKeys {
    origin: Place,
    target: Place,
    up: Coordinates,
    fov_y: AngleOfView,
}

impl TryFrom<CameraKeys> for FileCamera {
    type Error = &'static str;

    /// Checks the directions as they are where coordinates are small.
    fn try_from(keys: CameraKeys) -> Result<Self, Self::Error> {
        let camera = Self(keys);
        camera.seen_from(camera.0.origin.0)?;
        Ok(camera)
    }
}

impl FileCamera {
    /// The camera where `origin` is the origin.
    fn seen_from(&self, origin: DVec3) -> Result<Camera, &'static str> {
        let Self(keys) = self;
        let camera = Camera {
            origin: (keys.origin.0 - origin).as_vec3(),
            target: (keys.target.0 - origin).as_vec3(),
            up: keys.up.0.as_vec3(),
            fov_y: keys.fov_y.0,
        };
        camera.check_directions()?;
        Ok(camera)
    }
}

/// A parallelogram that emits on the side of cross(u, v).
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Quad {
    corner: Place,
    u: Coordinates,
    v: Coordinates,
    radiance: Radiance,
}

impl Quad {
    /// The light where `origin` is the origin.
    pub(super) fn light(&self, origin: DVec3) -> QuadLight {
        let corner = self.corner.0 - origin;
        QuadLight { corner, u: self.u.0, v: self.v.0, radiance: self.radiance.0 }
    }
}
