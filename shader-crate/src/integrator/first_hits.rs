//! The first-hit features of pixels: what the camera sees, without its light.
//!
//! They guide filters and are layers of the picture. They settle long before the light does, so
//! they have camera rays of their own, and only up to [`FEATURE_SAMPLES`] a pixel: paths need not
//! carry them to the film.

use crate::film::stream::Slot;
use crate::glam::Vec3;
use crate::integrator::params::PathParams;
use crate::memory::device_struct;
use crate::scene::abilities::Abilities;
use crate::scene::surface::Surface;
use crate::scene::{Encounter, SceneParams, SceneView, TracingParams};

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
    /// The parameters of a window of features. 176 bytes.
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

impl TracingParams for FeatureParams {
    fn scene(&self) -> SceneParams {
        self.path.scene
    }
}

/// Kernel: adds to the features of the pixel `lane` of a window the camera rays that it lacks:
/// those of the first paths of the pixel.
pub fn first_hits(
    lane: u32,
    params: &FeatureParams,
    scene: &SceneView<'_, impl Abilities>,
    features: &mut FeaturePixel,
) {
    let mut sums = *features;
    while sums.samples < params.samples {
        let slot = Slot { rank: params.first_rank + lane, sample: sums.samples };
        let ray = params.path.camera_ray(scene.abilities(), slot, &params.path.numbers(slot));
        let Encounter { hit, sides } = scene.meet(&ray, scene.surfaces.media_of_camera());
        if hit.is_some() {
            let surface = Surface::at(&scene.surfaces, &ray, &hit, sides);
            sums.albedo += surface.bsdf.reflectance;
            sums.hits += 1;
            sums.normal += surface.bsdf.normal;
            sums.depth += hit.t;
            sums.position += surface.point.position;
        }
        sums.samples += 1;
    }
    *features = sums;
}
