//! A scene on the device, as views: of all of it, and of what shading looks up.

pub mod bsdf;
pub mod bvh;
pub mod camera;
pub mod light;
pub mod ray;
pub mod surface;
pub mod texture;
pub mod triangle;

use crate::glam::UVec4;
use crate::scene::bsdf::Material;
use crate::scene::bvh::BvhView;
use crate::scene::surface::SurfaceView;
use crate::scene::triangle::Attributes;

/// Everything that a ray may hit. Lights are apart: not everyone who hits looks for them.
#[derive(Clone, Copy)]
pub struct SceneView<'a> {
    /// The geometry, to trace rays through.
    pub bvh: BvhView<'a>,
    /// What they hit.
    pub surfaces: SurfaceView<'a>,
}

impl<'a> SceneView<'a> {
    /// Wraps the buffers. `nodes` and `triangles` are as in [`BvhView::new`], the others as in
    /// [`SurfaceView::new`].
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
