//! The scene file: JSON, formats 1 and 2, checked key by key as it is read.

use super::camera::FileCamera;
use super::choice::MaterialChoice;
use super::environment::FileEnvironment;
use super::light::FileLight;
use super::material::FileMaterial;
use super::transform::FileTransform;
use super::values::{Coordinates, Depth, FilmSide, Object, Place, Radiance, integer, present};
use super::wrong_kind;
use crate::scene::camera::Camera;
use crate::scene::error::SceneError;
use crate::scene::film::FilmSize;
use crate::scene::light::QuadLight;
use crate::scene::limits::PathLimits;
use crate::scene::text::plain_text;
use glam::{DAffine3, DVec3, Vec3};
use serde::de::{Error as _, IgnoredAny, Unexpected};
use serde::{Deserialize, Deserializer};
use std::collections::BTreeMap;
use std::path::Path;

/// A scene file, of whichever format.
#[derive(Debug)]
pub(super) struct SceneFile {
    pub name: String,
    pub film: FilmSize,
    /// None where all is to be seen.
    camera: Option<FileCamera>,
    /// In the order in which they are loaded.
    pub meshes: Vec<FileMesh>,
    /// Those that meshes may name.
    pub materials: BTreeMap<String, FileMaterial>,
    pub quads: Vec<Quad>,
    pub lights: Vec<FileLight>,
    pub environment: Option<FileEnvironment>,
    pub background: Vec3,
    integrator: Integrator,
}

/// An OBJ of a scene file.
#[derive(Debug)]
pub(super) struct FileMesh {
    /// The key that names the file.
    pub key: String,
    /// The keys beside it begin so.
    pub place: String,
    pub file: String,
    /// None where it stays as it is.
    pub transform: Option<DAffine3>,
    /// Where it stands then, if that is in several places.
    pub instances: Option<Vec<DAffine3>>,
    /// What all of it is made of, but for `materials`.
    pub material: Option<MaterialChoice>,
    /// What its materials are, by their names in the OBJ.
    pub materials: BTreeMap<String, MaterialChoice>,
    pub normals: Normals,
    pub dedupe: bool,
}

/// Format 1: one OBJ.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Format1 {
    #[serde(rename = "format")]
    _format: IgnoredAny,
    #[serde(default, rename = "about")]
    _about: IgnoredAny,
    name: String,
    obj: String,
    film: Object<Film>,
    camera: Object<FileCamera>,
    #[serde(default)]
    normals: Normals,
    #[serde(default)]
    dedupe: bool,
    #[serde(default)]
    materials: BTreeMap<String, Object<FileMaterial>>,
    #[serde(default)]
    quads: Vec<Object<Quad>>,
    #[serde(default)]
    integrator: Object<Integrator>,
}

/// Format 2: any number of them, moved and made of what the file says, and all kinds of lights.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Format2 {
    #[serde(rename = "format")]
    _format: IgnoredAny,
    #[serde(default, rename = "$schema")]
    _schema: IgnoredAny,
    #[serde(default, rename = "about")]
    _about: IgnoredAny,
    name: String,
    film: Object<Film>,
    camera: Object<FileCamera>,
    #[serde(default)]
    meshes: Vec<Object<MeshKeys>>,
    #[serde(default)]
    materials: BTreeMap<String, Object<FileMaterial>>,
    #[serde(default)]
    quads: Vec<Object<Quad>>,
    #[serde(default)]
    lights: Vec<Object<FileLight>>,
    #[serde(default, deserialize_with = "present")]
    environment: Option<Object<FileEnvironment>>,
    #[serde(default, deserialize_with = "present")]
    background: Option<Radiance>,
    #[serde(default)]
    integrator: Object<Integrator>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct MeshKeys {
    file: String,
    #[serde(default, deserialize_with = "present")]
    transform: Option<Object<FileTransform>>,
    #[serde(default, deserialize_with = "present")]
    instances: Option<Vec<Object<FileTransform>>>,
    #[serde(default, deserialize_with = "present")]
    material: Option<MaterialChoice>,
    #[serde(default)]
    materials: BTreeMap<String, MaterialChoice>,
    #[serde(default)]
    normals: Normals,
    #[serde(default)]
    dedupe: bool,
}

impl From<Format1> for SceneFile {
    fn from(file: Format1) -> Self {
        let own = |(name, Object(material))| (name, MaterialChoice::Own(Box::new(material)));
        let mesh = FileMesh {
            key: "obj".to_owned(),
            place: String::new(),
            file: file.obj,
            transform: None,
            instances: None,
            material: None,
            materials: file.materials.into_iter().map(own).collect(),
            normals: file.normals,
            dedupe: file.dedupe,
        };
        Self {
            name: file.name,
            film: file.film.0.into(),
            camera: Some(file.camera.0),
            meshes: vec![mesh],
            materials: BTreeMap::new(),
            quads: file.quads.into_iter().map(|Object(quad)| quad).collect(),
            lights: Vec::new(),
            environment: None,
            background: Vec3::ZERO,
            integrator: file.integrator.0,
        }
    }
}

impl From<Format2> for SceneFile {
    fn from(file: Format2) -> Self {
        let mesh = |(index, Object(mesh)): (usize, Object<MeshKeys>)| FileMesh {
            key: format!("meshes[{index}].file"),
            place: format!("meshes[{index}]."),
            file: mesh.file,
            transform: mesh.transform.map(|Object(FileTransform(transform))| transform),
            instances: mesh.instances.map(|list| {
                list.into_iter().map(|Object(FileTransform(transform))| transform).collect()
            }),
            material: mesh.material,
            materials: mesh.materials,
            normals: mesh.normals,
            dedupe: mesh.dedupe,
        };
        let named = |(name, Object(material))| (name, material);
        Self {
            name: file.name,
            film: file.film.0.into(),
            camera: Some(file.camera.0),
            meshes: file.meshes.into_iter().enumerate().map(mesh).collect(),
            materials: file.materials.into_iter().map(named).collect(),
            quads: file.quads.into_iter().map(|Object(quad)| quad).collect(),
            lights: file.lights.into_iter().map(|Object(light)| light).collect(),
            environment: file.environment.map(|Object(environment)| environment),
            background: file.background.map_or(Vec3::ZERO, |Radiance(radiance)| radiance),
            integrator: file.integrator.0,
        }
    }
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
        // First and alone: each format has keys that others do not know.
        let Version { format } = parse(path, json)?;
        match format {
            1 => parse::<Format1>(path, json).map(Self::from),
            2 => parse::<Format2>(path, json).map(Self::from),
            found => Err(SceneError::Format { path: path.to_owned(), found }),
        }
    }

    /// What there would be of an OBJ alone.
    pub(super) fn of_obj(path: &Path) -> Self {
        let mesh = FileMesh {
            key: String::new(),
            place: String::new(),
            file: path.to_string_lossy().into_owned(),
            transform: None,
            instances: None,
            material: None,
            materials: BTreeMap::new(),
            normals: Normals::Smooth,
            dedupe: false,
        };
        Self {
            name: path.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
            film: FilmSize::default(),
            camera: None,
            meshes: vec![mesh],
            materials: BTreeMap::new(),
            quads: Vec::new(),
            lights: Vec::new(),
            environment: None,
            background: Vec3::ZERO,
            integrator: Integrator::default(),
        }
    }

    /// The camera, if there is one, with `origin` taken off its place; the error says what is then
    /// wrong with it.
    pub(super) fn camera(&self, origin: DVec3) -> Result<Option<Camera>, String> {
        let Some(camera) = &self.camera else { return Ok(None) };
        let camera = camera.seen_from(origin)?;
        camera.check()?;
        Ok(Some(camera))
    }

    pub(super) fn limits(&self) -> PathLimits {
        let Integrator { max_depth, rr_depth } = &self.integrator;
        PathLimits { max_depth: max_depth.0, roulette_depth: rr_depth.0 }
    }
}

#[derive(Deserialize)]
struct Version {
    #[serde(deserialize_with = "version")]
    format: u64,
}

fn version<'de, D: Deserializer<'de>>(deserializer: D) -> Result<u64, D::Error> {
    let expected = "the number of a format, 1 or 2";
    let found = integer(deserializer, expected)?;
    u64::try_from(found).map_err(|_| D::Error::invalid_value(Unexpected::Signed(found), &expected))
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

impl From<Film> for FilmSize {
    fn from(film: Film) -> Self {
        Self { width: film.width.0, height: film.height.0 }
    }
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
