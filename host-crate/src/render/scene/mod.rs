//! A scene in the layout that the kernels read.

pub mod buffers;
pub mod bvh;
pub mod camera;
mod lights;
mod triangles;

use self::bvh::BvhQuality;
use super::error::RenderError;
use crate::scene::{CameraSettings, PathLimits, Scene};
use glam::UVec4;
use raystream_shaders::scene::bsdf::Material;
use raystream_shaders::scene::light::Light;
use raystream_shaders::scene::triangle::Attributes;

/// A scene, ready to be copied to a device.
pub struct PreparedScene {
    /// Nodes of the BVH, see [`raystream_shaders::scene::bvh`].
    pub nodes: Vec<UVec4>,
    /// Triangles in the order of the leaves, see [`raystream_shaders::scene::triangle`].
    pub triangles: Vec<UVec4>,
    /// For each triangle in that order, its index in the scene. Triangles that were split appear
    /// several times.
    pub scene_triangles: Vec<u32>,
    /// Corner normals and texture coordinates.
    pub attributes: Vec<Attributes>,
    /// The materials.
    pub materials: Vec<Material>,
    /// The emissive triangles.
    pub lights: Vec<Light>,
    /// Sum over the lights of area times importance, in squared world units.
    pub total_importance: f32,
    /// The textures.
    pub texels: Vec<u32>,
    /// The camera.
    pub camera: CameraSettings,
    /// How long paths may be, by the scene file.
    pub limits: PathLimits,
}

impl PreparedScene {
    /// Builds the BVH and the table of lights.
    pub fn new(scene: Scene, quality: BvhQuality) -> Result<Self, RenderError> {
        let bvh = bvh::build(&scene.triangles, quality)?;
        let lights = lights::build(&scene.triangles, &scene.materials);
        Ok(Self {
            nodes: bvh.nodes,
            triangles: triangles::table(&scene.triangles, &bvh.order),
            scene_triangles: bvh.order,
            attributes: scene.attributes,
            materials: scene.materials,
            lights: lights.table,
            total_importance: lights.total_importance,
            texels: scene.texels,
            camera: scene.camera,
            limits: scene.limits,
        })
    }
}
