//! Next-event estimation: the light that a sampled point of a light sends to a surface.
//!
//! Whoever asks weighs it against the other techniques that could have found the same light.

use crate::glam::Vec3;
use crate::scene::SceneView;
use crate::scene::abilities::Abilities;
use crate::scene::light::LightSample;
use crate::scene::media::Media;
use crate::scene::ray::{NO_END, Ray};
use crate::scene::surface::Surface;

/// Light from a sampled point, not yet known to be visible.
#[derive(Clone, Copy)]
pub struct NextEvent {
    /// The light.
    pub light: LightSample,
    /// Density per solid angle with which the BSDF would have picked the direction to it; 0 where
    /// the light does not reach the surface.
    pub bsdf_pdf: f32,
    /// What it adds to a path of throughput 1 if nothing occludes it and no other technique finds
    /// it.
    pub radiance: Vec3,
    /// What the way to the light starts in.
    pub media: Media,
}

impl NextEvent {
    /// What a `light` that was sampled for `surface` sends there. The path arrived along
    /// `incoming`.
    #[inline(always)]
    pub fn new(
        scene: &SceneView<'_, impl Abilities>,
        surface: &Surface<'_, impl Abilities>,
        incoming: Vec3,
        light: LightSample,
    ) -> Self {
        let bsdf = surface.bsdf.eval(incoming, light.direction);
        let reaches = light.pdf > 0.0 && bsdf.pdf > 0.0;
        let media = surface.media_towards(light.direction);
        let length = if light.is_distant { NO_END } else { light.distance };
        let arrives = light.radiance * scene.surfaces.transmittance(media, length);
        Self {
            light,
            bsdf_pdf: if reaches { bsdf.pdf } else { 0.0 },
            radiance: bsdf.weight * arrives * (bsdf.pdf / light.pdf),
            media,
        }
    }

    /// Whether the light reaches the surface unless something is in its way.
    pub fn is_some(&self) -> bool {
        self.bsdf_pdf > 0.0
    }

    /// The segment whose visibility is to be tested. Both ends leave their surfaces, so that
    /// neither occludes itself.
    #[inline(always)]
    pub fn segment(&self, surface: &Surface<'_, impl Abilities>) -> Ray {
        let from = surface.point.offset_towards(self.light.direction);
        Ray::segment(from, self.light.end - from, 1.0)
    }
}
