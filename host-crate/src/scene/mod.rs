//! Scenes as the renderer takes them, and the loader of scene files (format 1).

mod error;
mod format;
mod geometry;
mod load;
mod mtl;
mod obj;
mod obj_text;
mod rule;
mod shipped;
mod source;
mod texture;
mod values;

pub use error::SceneError;
pub use load::load;
pub use shipped::{DEFAULT_SCENE, SceneGeometry, ShippedScene, embedded, load_named, shipped};

use glam::Vec3;
use raystream_shaders::scene::bsdf::Material;
use raystream_shaders::scene::triangle::Attributes;
use raystream_shaders::scene::triangle::Triangle;

/// A scene, loaded and checked: every index is in range, every number finite, every triangle has an
/// area.
#[derive(Clone, Debug)]
pub struct Scene {
    /// What the scene file calls it.
    pub name: String,
    /// Picture size in pixels, at least 1x1.
    pub film: FilmSize,
    /// The camera.
    pub camera: CameraSettings,
    /// How long paths may be.
    pub limits: PathLimits,
    /// All triangles, quads included as two each, null materials left out. May be empty.
    pub triangles: Vec<Triangle>,
    /// Corner normals and texture coordinates; [`Triangle::attributes`] points here.
    pub attributes: Vec<Attributes>,
    /// The materials; [`Triangle::material`] points here.
    pub materials: Vec<Material>,
    /// The textures, in the layout of [`raystream_shaders::scene::texture`]; [`Material::texture`]
    /// points here.
    pub texels: Vec<u32>,
    /// What the user should know of (no light, dropped triangles ...), one sentence each.
    pub warnings: Vec<String>,
}

/// Picture size in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FilmSize {
    /// Width, at least 1.
    pub width: u32,
    /// Height, at least 1.
    pub height: u32,
}

impl FilmSize {
    /// A size of `width` by `height` pixels.
    ///
    /// # Errors
    /// A sentence that names the limit, if a side is zero, negative or too large.
    pub fn new(width: i64, height: i64) -> Result<Self, String> {
        let side = |name, value| {
            values::FilmSide::try_from(value).map_err(|error| format!("the {name} {error}"))
        };
        Ok(Self { width: side("width", width)?.0, height: side("height", height)?.0 })
    }
}

/// A pinhole camera as a scene file gives it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraSettings {
    /// The pinhole, in world units.
    pub origin: Vec3,
    /// A point in the middle of the picture; differs from `origin`.
    pub target: Vec3,
    /// Upwards in the picture; not parallel to the view.
    pub up: Vec3,
    /// Vertical angle of view in degrees, in (0, 180).
    pub fov_y: f32,
}

/// How long paths may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PathLimits {
    /// Longest path in segments, at least 1: 1 sees only what emits, 2 direct light as well.
    pub max_depth: u32,
    /// Segment after which Russian roulette may end a path, at least 1.
    pub roulette_depth: u32,
}
