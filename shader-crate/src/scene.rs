//! A scene on the device, as views: of all of it, and of what shading looks up.

use crate::bvh::BvhView;
use crate::glam::UVec4;
use crate::material::Material;
use crate::surface::Attributes;
use crate::texture::TextureView;
use crate::triangle::TriangleView;

/// Everything that a ray may hit. Lights are apart: not everyone who hits looks for them.
#[derive(Clone, Copy)]
pub struct SceneView<'a> {
    /// The geometry, to trace rays through.
    pub bvh: BvhView<'a>,
    /// What they hit.
    pub surfaces: SurfaceView<'a>,
}

impl<'a> SceneView<'a> {
    /// Wraps the buffers. `nodes` and `triangles` are as in [`BvhView::new`], the others as in [`SurfaceView::new`].
    #[inline(always)]
    pub fn new(
        nodes: &'a [UVec4],
        triangles: &'a [UVec4],
        attributes: &'a [Attributes],
        materials: &'a [Material],
        texels: &'a [u32],
        offset_roundings: f32,
    ) -> Self {
        Self {
            bvh: BvhView::new(nodes, triangles),
            surfaces: SurfaceView::new(triangles, attributes, materials, texels, offset_roundings),
        }
    }
}

/// The surfaces of a scene, for those who know what has been hit.
#[derive(Clone, Copy)]
pub struct SurfaceView<'a> {
    /// The triangles, in the order of the BVH's leaves.
    pub triangles: TriangleView<'a>,
    /// Corner normals and texture coordinates of the triangles that have any.
    pub attributes: &'a [Attributes],
    /// The materials.
    pub materials: &'a [Material],
    /// How far rays start from surfaces, see [`crate::ray::OFFSET_ROUNDINGS`].
    pub offset_roundings: f32,
    /// The textures.
    pub textures: TextureView<'a>,
}

impl<'a> SurfaceView<'a> {
    /// Wraps the buffers. `offset_roundings` is as in [`Self::offset_roundings`].
    #[inline(always)]
    pub fn new(
        triangles: &'a [UVec4],
        attributes: &'a [Attributes],
        materials: &'a [Material],
        texels: &'a [u32],
        offset_roundings: f32,
    ) -> Self {
        Self {
            triangles: TriangleView::new(triangles),
            attributes,
            materials,
            offset_roundings,
            textures: TextureView::new(texels),
        }
    }
}
