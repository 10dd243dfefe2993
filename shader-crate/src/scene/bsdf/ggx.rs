//! Rough surfaces as microfacets, whose normals follow the GGX distribution.
//!
//! Walter, Marschner, Li, Torrance, "Microfacet Models for Refraction through Rough Surfaces",
//! EGSR 2007; with the height-correlated masking of Heitz, "Understanding the Masking-Shadowing
//! Function in Microfacet-Based BRDFs", JCGT 3(2), 2014.
//!
//! All vectors here are unit vectors in the frame of the surface, whose normal is +z.

use crate::glam::{Vec2, Vec3};
use crate::math::angles::sin_cos_of_turns;
use core::f32::consts::FRAC_1_PI;
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

/// The distribution, the same in all directions around the normal.
#[derive(Clone, Copy)]
pub struct Ggx {
    /// Slope of the roughness, in \[[`Self::SMOOTHEST`], 1\].
    pub alpha: f32,
}

impl Ggx {
    /// What counts as the smoothest: a lobe a tenth of a degree wide. Below it densities leave the
    /// range of f32's digits.
    pub const SMOOTHEST: f32 = 1e-3;

    /// The distribution of a `roughness` in [0, 1] as artists mean it: the root of the slope
    /// (Burley, "Physically-Based Shading at Disney", 2012).
    pub fn of_roughness(roughness: f32) -> Self {
        Self { alpha: (roughness * roughness).max(Self::SMOOTHEST) }
    }

    /// Density of the microfacets' normals at `h`, per solid angle and projected area.
    pub fn distribution(&self, h: Vec3) -> f32 {
        let alpha2 = self.alpha * self.alpha;
        // Not one minus a square: that has no digits near the normal.
        let stretched = (h.x * h.x + h.y * h.y) / alpha2 + h.z * h.z;
        FRAC_1_PI / (alpha2 * stretched * stretched)
    }

    /// Smith's auxiliary function of a direction.
    fn lambda(&self, w: Vec3) -> f32 {
        let tan2 = (w.x * w.x + w.y * w.y) / (w.z * w.z);
        0.5 * ((1.0 + self.alpha * self.alpha * tan2).sqrt() - 1.0)
    }

    /// The share of microfacets that is seen from `w`.
    pub fn masking(&self, w: Vec3) -> f32 {
        1.0 / (1.0 + self.lambda(w))
    }

    /// The share of microfacets that is seen from `o` and from `i`, both above the surface.
    pub fn masking_reflected(&self, o: Vec3, i: Vec3) -> f32 {
        1.0 / (1.0 + self.lambda(o) + self.lambda(i))
    }

    /// The share of microfacets that is seen from `o` above and from `i` below the surface, as if
    /// the two were independent (Walter et al. 2007, equation 23).
    pub fn masking_transmitted(&self, o: Vec3, i: Vec3) -> f32 {
        self.masking(o) * self.masking(i)
    }

    /// See [`sample_visible`].
    pub fn sample_visible(&self, o: Vec3, u: [f32; 2]) -> Vec3 {
        sample_visible(o, Vec2::splat(self.alpha), u)
    }
}

/// A normal of a microfacet that is seen from `o`, unit length and above the surface, where the
/// microfacets' slopes have the widths `alpha` along both axes; from a uniform point of the unit
/// square.
///
/// Dupuy, Benyoub, "Sampling Visible GGX Normals with Spherical Caps", CGF 42(8), 2023.
pub fn sample_visible(o: Vec3, alpha: Vec2, u: [f32; 2]) -> Vec3 {
    let stretched = Vec3::new(o.x * alpha.x, o.y * alpha.y, o.z).normalize();
    let (sine, cosine) = sin_cos_of_turns(u[0]);
    // The point of the cap has this height less `stretched.z`; their sum has this height.
    let height = (1.0 - u[1]) * (1.0 + stretched.z);
    let z = height - stretched.z;
    let radius = (1.0 - z * z).max(0.0).sqrt();
    let (x, y) = (radius * cosine + stretched.x, radius * sine + stretched.y);
    Vec3::new(x * alpha.x, y * alpha.y, height).normalize()
}
