//! A scene on the device, as one view.

use crate::bvh::BvhView;
use crate::material::Material;
use crate::surface::Attributes;
use crate::texture::TextureView;

/// Everything that a ray may hit. Lights are apart: not everyone who hits looks for them.
#[derive(Clone, Copy)]
pub struct SceneView<'a> {
    /// The geometry.
    pub bvh: BvhView<'a>,
    /// Corner normals and texture coordinates of the triangles that have any.
    pub attributes: &'a [Attributes],
    /// The materials.
    pub materials: &'a [Material],
    /// How far rays start from surfaces, see [`crate::ray::OFFSET_ROUNDINGS`].
    pub offset_roundings: f32,
    /// The textures.
    pub textures: TextureView<'a>,
}

impl<'a> SceneView<'a> {
    /// Wraps the buffers. `offset_roundings` is as in [`Self::offset_roundings`].
    #[inline(always)]
    pub fn new(
        bvh: BvhView<'a>,
        attributes: &'a [Attributes],
        materials: &'a [Material],
        texels: &'a [u32],
        offset_roundings: f32,
    ) -> Self {
        Self { bvh, attributes, materials, offset_roundings, textures: TextureView::new(texels) }
    }
}
