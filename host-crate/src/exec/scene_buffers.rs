//! The buffers of a scene, as kernels bind them.

use super::{Array, ExecError, Executor, RawView};
use glam::UVec4;
use raystream_shaders::scene::bvh::wide::WideBvh;

/// What a row `with scene` of the [table of kernels](raystream_shaders::kernels) binds, in the
/// order of [`raystream_shaders::scene::SceneView::new`]. [`raystream_shaders::scene`] says what
/// they hold.
pub struct SceneBuffers<B> {
    geometry: Array<B, UVec4>,
    surfaces: Array<B, UVec4>,
    texels: Array<B, u32>,
    abilities: u32,
    wide: Option<WideBvh>,
}

impl<B> SceneBuffers<B> {
    /// The names of the bindings.
    pub const NAMES: [&'static str; 3] = ["geometry", "surfaces", "texels"];

    /// Copies the buffers to the device, and has it make its kernels ready for a scene of these
    /// [`abilities`](raystream_shaders::scene::abilities).
    pub fn new<E: Executor<Buffer = B>>(
        executor: &E,
        abilities: u32,
        geometry: &[UVec4],
        surfaces: &[UVec4],
        texels: &[u32],
    ) -> Result<Self, ExecError> {
        executor.prepare(abilities)?;
        Ok(Self {
            abilities,
            wide: None,
            geometry: Array::from_slice(executor, "the scene's geometry", geometry)?,
            surfaces: Array::from_slice(executor, "the scene's surfaces", surfaces)?,
            texels: Array::from_slice(executor, "the scene's textures", texels)?,
        })
    }

    /// The same, with the hierarchy of the scene that kernels traverse on a CPU.
    pub fn with_wide(self, wide: Option<WideBvh>) -> Self {
        Self { wide, ..self }
    }

    /// What launches are told of the scene.
    pub(super) fn uses(&self) -> SceneUses<'_> {
        SceneUses { abilities: self.abilities, wide: self.wide.as_ref() }
    }

    /// What the scene uses.
    pub fn abilities(&self) -> u32 {
        self.abilities
    }

    /// All of them, for a kernel.
    pub fn views(&self) -> [RawView<'_, B>; 3] {
        [self.geometry.view().raw(), self.surfaces.view().raw(), self.texels.view().raw()]
    }
}

/// What a launch is told of the scene that it works on, beside the buffers.
#[derive(Clone, Copy, Default)]
pub(super) struct SceneUses<'a> {
    /// The [abilities](raystream_shaders::scene::abilities); 0 without a scene.
    pub abilities: u32,
    /// The hierarchy that a CPU traverses, if that is another than the buffers hold.
    pub wide: Option<&'a WideBvh>,
}
