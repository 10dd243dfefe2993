//! What a rough surface of one Fresnel term reflects, once and several times.

use crate::glam::{Vec2, Vec3};

/// How a direction sees the [table of albedos](super::albedo) at a roughness.
#[derive(Clone, Copy)]
pub struct Albedo {
    /// Factor of the reflectance at normal incidence.
    a: f32,
    /// What is reflected besides.
    b: f32,
    /// Share of light that is left for several reflections.
    pub missed: f32,
}

impl Albedo {
    /// Of a pair of the table.
    pub fn new(pair: Vec2) -> Self {
        Self { a: pair.x, b: pair.y, missed: (1.0 - pair.x - pair.y).max(0.0) }
    }
}

/// What microfacets with one Fresnel term reflect.
#[derive(Clone, Copy)]
pub struct Reflector {
    /// Reflectance at normal incidence.
    pub f0: Vec3,
    /// Reflectance at grazing angles.
    pub f90: f32,
    /// Reflectance, by several of them, of light that one has not let go, in the mean.
    pub several: Vec3,
}

impl Reflector {
    /// With several reflections by Fdez-Agüera, "A Multiple-Scattering Microfacet Model for
    /// Real-Time Image-based Lighting", JCGT 8(1), 2019: a geometric series of the mean.
    pub fn new(f0: Vec3, f90: f32, mean: Albedo) -> Self {
        let f_mean = f0 + (Vec3::splat(f90) - f0) * (1.0 / 21.0);
        Self { f90, ..Self::of_mean(f0, f_mean, mean) }
    }

    /// The same of another Fresnel term than Schlick's, with this mean over the hemisphere.
    pub fn of_mean(f0: Vec3, f_mean: Vec3, mean: Albedo) -> Self {
        let several = f_mean * f_mean * (1.0 - mean.missed) / (Vec3::ONE - f_mean * mean.missed);
        Self { f0, f90: 1.0, several }
    }

    /// Reflectance of one microfacet that is seen under a `cosine` (Schlick 1994).
    pub fn schlick(&self, cosine: f32) -> Vec3 {
        self.f0 + (Vec3::splat(self.f90) - self.f0) * grazing(cosine)
    }

    /// What one reflection leaves of a direction's light.
    pub fn once(&self, albedo: Albedo) -> Vec3 {
        self.f0 * albedo.a + albedo.b * self.f90
    }

    /// What gets past the microfacets.
    pub fn passes(&self, albedo: Albedo) -> Vec3 {
        Vec3::ONE - self.once(albedo) - self.several * albedo.missed
    }
}

/// How far Schlick's term has gone from normal incidence, 0, to grazing, 1.
pub fn grazing(cosine: f32) -> f32 {
    let rest = 1.0 - cosine;
    let square = rest * rest;
    square * square * rest
}
