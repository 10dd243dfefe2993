//! A scene in the layout that the kernels read.

pub mod bvh;
pub mod camera;
mod lights;
mod triangles;

use self::bvh::BvhQuality;
use super::error::RenderError;
use crate::exec::{ExecError, Executor, SceneBuffers};
use crate::scene::{CameraSettings, PathLimits, Scene};
use bytemuck::{Pod, Zeroable};
use glam::UVec4;
use raystream_shaders::scene::{SceneParams, SceneView};

/// A scene, ready to be copied to a device. [`raystream_shaders::scene`] says how it is laid out.
pub struct PreparedScene {
    /// Nodes of the BVH, and triangles in the order of its leaves.
    pub geometry: Vec<UVec4>,
    /// The same triangles for shading, attributes, materials and lights.
    pub surfaces: Vec<UVec4>,
    /// The textures.
    pub texels: Vec<u32>,
    /// What lies where, and the lights' total. What is up to a render's settings is zero.
    pub params: SceneParams,
    /// For each triangle in the order of the leaves, its index in the scene. Triangles that were
    /// split appear several times.
    pub scene_triangles: Vec<u32>,
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
        let mut geometry = bvh.nodes;
        let first_planes = append(&mut geometry, &triangles::planes(&scene.triangles, &bvh.order));
        let mut surfaces = triangles::shading(&scene.triangles, &bvh.order);
        let params = SceneParams {
            lights: lights.table.len() as u32,
            total_importance: lights.total_importance,
            first_planes,
            first_attributes: append(&mut surfaces, &scene.attributes),
            first_material: append(&mut surfaces, &scene.materials),
            first_light: append(&mut surfaces, &lights.table),
            ..SceneParams::zeroed()
        };
        Ok(Self {
            geometry,
            surfaces,
            texels: scene.texels,
            params,
            scene_triangles: bvh.order,
            camera: scene.camera,
            limits: scene.limits,
        })
    }

    /// The scene as kernels see it, for the host. What is up to a render's settings is zero.
    pub fn view(&self) -> SceneView<'_> {
        SceneView::new(&self.params, &self.geometry, &self.surfaces, &self.texels)
    }

    /// Copies it to a device.
    pub fn buffers<E: Executor>(&self, executor: &E) -> Result<SceneBuffers<E::Buffer>, ExecError> {
        SceneBuffers::new(executor, &self.geometry, &self.surfaces, &self.texels)
    }
}

/// Adds the rows of `elements`, whose sizes are multiples of a row's; the number of the first one.
fn append<T: Pod>(rows: &mut Vec<UVec4>, elements: &[T]) -> u32 {
    let first = rows.len() as u32;
    rows.extend(bytemuck::pod_collect_to_vec::<T, UVec4>(elements));
    first
}
