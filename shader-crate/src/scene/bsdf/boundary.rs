//! The rough boundary of a dielectric, which light passes or is reflected by (Walter et al. 2007,
//! with Fresnel's equations), and what several of its microfacets do.
//!
//! A microfacet lets nothing go to waste, so what one alone does not send on, the share `m(o)`, is
//! sent on by several. As in Kulla and Conty, "Revisiting Physically Based Shading at Imageworks",
//! 2017, that follows the cosine on the far side of the path as on the near one:
//!
//! ```text
//! f(o, i) = t m(o) m'(i) / (pi m'),   on the near side (1 - t) m(o) m(i) / (pi m)
//! ```
//!
//! with the means `m` over the near side and `m'` over the far side. All light is kept whatever `t`
//! is. Both directions are worth the same, but for the squeezing of radiance, where `t m` and `t'
//! m' eta^2` are equal; and that both sides send on what the other keeps, `t + t' = 1`, says how
//! much: `t = m' eta^2 / (m' eta^2 + m)`.
//!
//! A *thin* boundary is two with nothing between: what passes is not bent.

use super::albedo::AlbedoView;
use super::dielectric::fresnel;
use super::ggx::Ggx;
use crate::glam::{Vec2, Vec3};
use core::f32::consts::FRAC_1_PI;
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

/// A boundary as a direction `o` sees it. All vectors are unit vectors in the frame of the surface,
/// whose normal is +z on the side of `o`.
#[derive(Clone, Copy)]
pub struct Boundary {
    /// Its microfacets.
    ggx: Ggx,
    /// Index of refraction on the far side over that on `o`'s side, as Fresnel's equations have it.
    ior: f32,
    is_thin: bool,
    is_from_outside: bool,
    roughness: f32,
    /// Share of `o`'s light that is left for several microfacets.
    pub missed: f32,
    /// The means of that over the near side and over the far side.
    mean: [f32; 2],
}

/// What is to be said of a direction that light comes from.
pub struct Scattered {
    /// BSDF times cosine, by one microfacet.
    pub once: f32,
    /// Density of that per solid angle, where the lobe of one microfacet is sampled.
    pub once_pdf: f32,
    /// BSDF times cosine, by several.
    pub several: f32,
}

impl Boundary {
    /// That of what lets no light pass.
    pub const NONE: Self = Self {
        ggx: Ggx { alpha: 1.0 },
        ior: 1.0,
        is_thin: false,
        is_from_outside: true,
        roughness: 1.0,
        missed: 0.0,
        mean: [0.0, 0.0],
    };

    /// A boundary of this `roughness` in [0, 1] and index of refraction `ior` behind the front,
    /// which is seen from `o`. `albedos` are those of a boundary, or of a surface if it is thin.
    pub fn new(
        o: Vec3,
        roughness: f32,
        ior: f32,
        is_thin: bool,
        from_outside: bool,
        albedos: AlbedoView<'_>,
    ) -> Self {
        // A thin one has its front on both sides.
        let is_from_outside = from_outside || is_thin;
        let mean = albedos.mean(roughness);
        Self {
            ggx: Ggx::of_roughness(roughness),
            ior: if is_from_outside { ior } else { 1.0 / ior },
            is_thin,
            is_from_outside,
            roughness,
            missed: missed(albedos.directional(roughness, o.z), is_thin, is_from_outside),
            mean: [missed(mean, is_thin, is_from_outside), missed(mean, is_thin, !is_from_outside)],
        }
    }

    /// Index of refraction on the far side over that on the near side.
    pub fn eta(&self) -> f32 {
        if self.is_thin { 1.0 } else { self.ior }
    }

    /// Share of what several microfacets do that crosses.
    pub fn crossing(&self) -> f32 {
        let [near, far] = self.mean;
        let far = (far * self.eta() * self.eta()).max(f32::MIN_POSITIVE);
        far / (far + near)
    }

    /// Where a path goes on by one microfacet, from a uniform point of the unit square and a number
    /// for the choice of reflection or passage; and whether it crosses.
    pub fn sample(&self, o: Vec3, u: [f32; 2], choice: f32) -> (Vec3, bool) {
        let h = self.ggx.sample_visible(o, u);
        let cosine = o.dot(h).clamp(0.0, 1.0);
        let crosses = choice >= self.reflects(cosine);
        let mirrored = (-o).reflect(h);
        let i = if !crosses {
            mirrored
        } else if self.is_thin {
            Vec3::new(mirrored.x, mirrored.y, -mirrored.z)
        } else {
            refract(o, h, cosine, self.ior)
        };
        (i, crosses)
    }

    /// Light from `i`, seen from `o`; `albedos` are as in [`Self::new`].
    pub fn scattered(&self, o: Vec3, i: Vec3, albedos: AlbedoView<'_>) -> Scattered {
        let eta = self.eta();
        let crosses = i.z < 0.0;
        let [near, far] = self.mean;
        let (share, mean) =
            if crosses { (self.crossing(), far) } else { (1.0 - self.crossing(), near) };
        let pair = albedos.directional(self.roughness, i.z.abs().min(1.0));
        let there = missed(pair, self.is_thin, self.is_from_outside != crosses);
        let missed = self.missed * there / mean.max(f32::MIN_POSITIVE);
        let squeezed = if crosses { 1.0 / (eta * eta) } else { 1.0 };
        let several = share * missed * i.z.abs() * FRAC_1_PI * squeezed;
        let mut once = 0.0;
        let mut once_pdf = 0.0;
        if crosses && !self.is_thin {
            let h = (o + i * self.ior).normalize();
            let h = if h.z < 0.0 { -h } else { h };
            let (here, there) = (o.dot(h), i.dot(h));
            if here > 0.0 && there < 0.0 {
                let passes = 1.0 - dielectric_fresnel(here, self.ior);
                let spread = here + self.ior * there;
                let lobe = self.ggx.distribution(h) * here * -there * (eta * eta)
                    / (spread * spread * o.z);
                once = passes * self.ggx.masking_transmitted(o, i) * lobe * squeezed;
                once_pdf = passes * self.ggx.masking(o) * lobe;
            }
        } else {
            let mirrored = Vec3::new(i.x, i.y, i.z.abs());
            let h = (o + mirrored).normalize();
            let reflects = self.reflects(o.dot(h).clamp(0.0, 1.0));
            let share = if crosses { 1.0 - reflects } else { reflects };
            let lobe = self.ggx.distribution(h) / (4.0 * o.z);
            once = share * self.ggx.masking_reflected(o, mirrored) * lobe;
            once_pdf = share * self.ggx.masking(o) * lobe;
        }
        Scattered { once, once_pdf, several }
    }

    /// Reflectance of a microfacet that is seen under a `cosine`.
    fn reflects(&self, cosine: f32) -> f32 {
        let once = dielectric_fresnel(cosine, self.ior);
        // Two interfaces, between which light goes to and fro.
        if self.is_thin { 2.0 * once / (1.0 + once) } else { once }
    }
}

/// What a pair of albedos leaves of 1: on one side of a boundary, or, if thin, of a surface that
/// reflects all.
fn missed(pair: Vec2, is_thin: bool, is_outside: bool) -> f32 {
    let albedo = if is_thin {
        pair.x + pair.y
    } else if is_outside {
        pair.x
    } else {
        pair.y
    };
    (1.0 - albedo).max(0.0)
}

/// Where light goes that a microfacet of normal `h`, which `o` sees under this `cosine`, refracts.
pub fn refract(o: Vec3, h: Vec3, cosine: f32, eta: f32) -> Vec3 {
    let far = (1.0 - (1.0 - cosine * cosine) / (eta * eta)).max(0.0).sqrt();
    -o / eta + h * (cosine / eta - far)
}

/// Fresnel's reflectance under a `cosine` on the near side, where the far side has `eta` times the
/// index of refraction.
pub fn dielectric_fresnel(cosine: f32, eta: f32) -> f32 {
    let sin2 = (1.0 - cosine * cosine) / (eta * eta);
    if sin2 >= 1.0 { 1.0 } else { fresnel(cosine, (1.0 - sin2).sqrt(), eta) }
}
