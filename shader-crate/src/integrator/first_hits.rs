//! The first-hit features of pixels: what the camera sees, without its light.
//!
//! They guide filters and are layers of the picture. They settle long before the light does, so
//! they have camera rays of their own, and only up to [`FEATURE_SAMPLES`] a pixel: paths need not
//! carry them to the film.

use crate::film::tiles::pixel_of_rank;
use crate::glam::{UVec4, Vec3};
use crate::integrator::path::PathParams;
use crate::math::random::{PIXEL, SampleStream};
use crate::memory::device_struct;
use crate::scene::SceneView;
use crate::scene::bsdf::Material;
use crate::scene::{surface::Surface, triangle::Attributes};

/// Camera rays that the features of a pixel average at most.
pub const FEATURE_SAMPLES: u32 = 32;

device_struct! {
    /// The first-hit features of one pixel: sums over its camera rays. 48 bytes.
    pub struct FeaturePixel {
        /// Sum of reflectance.
        pub albedo: Vec3,
        /// Camera rays that hit a surface.
        pub hits: u32,
        /// Sum of shading normals, towards the camera.
        pub normal: Vec3,
        /// Sum of distances from the camera, in world units.
        pub depth: f32,
        /// Sum of positions, in world units.
        pub position: Vec3,
        /// Camera rays traced.
        pub samples: u32,
    }
}

device_struct! {
    /// The parameters of a window of features. 128 bytes.
    pub struct FeatureParams {
        /// Pixels in the window.
        pub threads: u32,
        /// Rank of the window's first pixel; the features that are bound start there.
        pub first_rank: u32,
        /// Camera rays that each pixel shall have in the end.
        pub samples: u32,
        /// Unused; zero.
        pub pad: u32,
        /// The render; its `threads` do not count.
        pub path: PathParams,
    }
}

/// Kernel: adds to the features of the pixel `lane` of a window the camera rays that it lacks:
/// those of the first paths of the pixel.
#[allow(clippy::too_many_arguments)] // one per binding; the body sees views
pub fn first_hits(
    lane: u32,
    params: &FeatureParams,
    nodes: &[UVec4],
    triangles: &[UVec4],
    attributes: &[Attributes],
    materials: &[Material],
    texels: &[u32],
    features: &mut FeaturePixel,
) {
    let scene = SceneView::new(
        nodes,
        triangles,
        attributes,
        materials,
        texels,
        params.path.offset_roundings,
    );
    let camera = &params.path.camera;
    let (x, y) = pixel_of_rank(params.first_rank + lane, camera.width, camera.height);
    let mut sums = *features;
    while sums.samples < params.samples {
        let numbers = SampleStream::new(
            params.path.sampler,
            params.path.seed,
            y * camera.width + x,
            sums.samples,
        );
        let ray = camera.ray(x, y, numbers.pair(PIXEL));
        let hit = scene.bvh.closest_hit(&ray);
        if hit.is_some() {
            let surface = Surface::at(&scene.surfaces, &ray, &hit);
            sums.albedo += surface.material.reflectance;
            sums.hits += 1;
            sums.normal += surface.normal;
            sums.depth += hit.t;
            sums.position += surface.point.position;
        }
        sums.samples += 1;
    }
    *features = sums;
}
