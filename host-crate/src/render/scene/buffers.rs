//! A scene in a device's memory.

use super::PreparedScene;
use crate::exec::{Array, ExecError, Executor, View};
use glam::UVec4;
use raystream_shaders::scene::bsdf::Material;
use raystream_shaders::scene::light::Light;
use raystream_shaders::scene::triangle::Attributes;

/// The buffers of [`PreparedScene`].
pub struct SceneBuffers<B> {
    /// Nodes of the BVH.
    pub nodes: Array<B, UVec4>,
    /// Triangles in the order of the leaves.
    pub triangles: Array<B, UVec4>,
    /// Corner normals and texture coordinates.
    pub attributes: Array<B, Attributes>,
    /// The materials.
    pub materials: Array<B, Material>,
    /// The emissive triangles.
    pub lights: Array<B, Light>,
    /// The textures.
    pub texels: Array<B, u32>,
}

impl<B> SceneBuffers<B> {
    /// Copies the scene to the device.
    pub fn new<E: Executor<Buffer = B>>(
        executor: &E,
        scene: &PreparedScene,
    ) -> Result<Self, ExecError> {
        Ok(Self {
            nodes: Array::from_slice(executor, "BVH nodes", &scene.nodes)?,
            triangles: Array::from_slice(executor, "triangles", &scene.triangles)?,
            attributes: Array::from_slice(
                executor,
                "normals and texture coordinates",
                &scene.attributes,
            )?,
            materials: Array::from_slice(executor, "materials", &scene.materials)?,
            lights: Array::from_slice(executor, "lights", &scene.lights)?,
            texels: Array::from_slice(executor, "textures", &scene.texels)?,
        })
    }

    /// What a kernel is given that binds `before`, then the whole scene in the order of the fields,
    /// then `after`.
    pub fn between<'a, const BEFORE: usize, const AFTER: usize>(
        &'a self,
        before: [View<'a, B>; BEFORE],
        after: [View<'a, B>; AFTER],
    ) -> Vec<View<'a, B>> {
        let scene = [
            self.nodes.view(),
            self.triangles.view(),
            self.attributes.view(),
            self.materials.view(),
            self.lights.view(),
            self.texels.view(),
        ];
        before.into_iter().chain(scene).chain(after).collect()
    }
}
