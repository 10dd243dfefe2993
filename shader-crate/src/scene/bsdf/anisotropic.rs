//! Rough surfaces whose microfacets are steeper one way than the other, as those of brushed metal.
//!
//! The distribution and its masking are those of [`super::ggx`], stretched; how much of light one
//! microfacet sends on is looked up in a table of its own. It has, for [`ROUGHNESSES`] and
//! [`STRENGTHS`], [`AZIMUTHS`] (see [`azimuth_at`]) and [`COSINES`] (squares of equal steps), the
//! two terms of [`super::albedo`], a row for two neighbouring cosines; then for each strength the
//! means over the cosine-weighted hemisphere, a row for two neighbouring roughnesses.

use super::albedo::{between, cell};
use super::ggx::{Ggx, sample_visible};
use crate::glam::{UVec4, Vec2, Vec3};
use crate::math::elementary::pow;
use crate::memory::access::at;
use core::f32::consts::FRAC_1_PI;
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

/// Roughnesses of the table, from 0 to 1.
pub const ROUGHNESSES: u32 = 20;
/// Strengths of the table, from 0 to 1.
pub const STRENGTHS: u32 = 16;
/// Azimuths of the table, from across the grain to along it.
pub const AZIMUTHS: u32 = 12;
/// Cosines of the table, from 0 to 1.
pub const COSINES: u32 = 24;
/// Rows of the table before the means.
pub const DIRECTIONS: u32 = ROUGHNESSES * STRENGTHS * AZIMUTHS * (COSINES - 1);

/// The cosine to the grain of the azimuth at a `place` of the table, from 0 to 1: most of them lie
/// across the grain, where albedos change most.
pub fn azimuth_at(place: f32) -> f32 {
    place * place.sqrt()
}

/// The distribution. All vectors are unit vectors in the frame of the surface, whose normal is +z
/// and along whose grain is +x.
#[derive(Clone, Copy)]
pub struct Anisotropic {
    /// Slope of the roughness along the grain, in \[[`Ggx::SMOOTHEST`], 1\].
    pub along: f32,
    /// The same across it, no more than that.
    pub across: f32,
}

impl Anisotropic {
    /// The distribution of a `roughness` and a `strength`, both in [0, 1], as glTF's
    /// `KHR_materials_anisotropy` has it: across the grain that of the roughness, along it a rougher
    /// one.
    pub fn new(roughness: f32, strength: f32) -> Self {
        let across = Ggx::of_roughness(roughness).alpha;
        Self { along: across + (1.0 - across) * strength * strength, across }
    }

    /// See [`Ggx::distribution`].
    pub fn distribution(&self, h: Vec3) -> f32 {
        let (x, y) = (h.x / self.along, h.y / self.across);
        let stretched = x * x + y * y + h.z * h.z;
        FRAC_1_PI / (self.along * self.across * stretched * stretched)
    }

    /// Smith's auxiliary function of a direction.
    fn lambda(&self, w: Vec3) -> f32 {
        let (x, y) = (w.x * self.along, w.y * self.across);
        0.5 * ((1.0 + (x * x + y * y) / (w.z * w.z)).sqrt() - 1.0)
    }

    /// See [`Ggx::masking`].
    pub fn masking(&self, w: Vec3) -> f32 {
        1.0 / (1.0 + self.lambda(w))
    }

    /// See [`Ggx::masking_reflected`].
    pub fn masking_reflected(&self, o: Vec3, i: Vec3) -> f32 {
        1.0 / (1.0 + self.lambda(o) + self.lambda(i))
    }

    /// See [`sample_visible`].
    pub fn sample_visible(&self, o: Vec3, u: [f32; 2]) -> Vec3 {
        sample_visible(o, Vec2::new(self.along, self.across), u)
    }
}

/// The table. All results are pairs of `a` and `b`, see [`super::albedo`].
#[derive(Clone, Copy)]
pub struct AnisotropicAlbedos<'a> {
    /// The buffer.
    pub rows: &'a [UVec4],
    /// Row where the table begins.
    pub first: u32,
}

impl AnisotropicAlbedos<'_> {
    /// The albedo as `w` sees it, in the frame of [`Anisotropic`] and above the surface.
    pub fn directional(&self, roughness: f32, strength: f32, w: Vec3) -> Vec2 {
        let radius = (w.x * w.x + w.y * w.y).sqrt();
        let azimuth =
            if radius > 0.0 { pow((w.x.abs() / radius).min(1.0), 2.0 / 3.0) } else { 0.0 };
        let (rough, rough_share) = cell(roughness, ROUGHNESSES);
        let (strong, strong_share) = cell(strength, STRENGTHS);
        let smoother = self.of_roughness(rough, strong, strong_share, azimuth, w.z);
        let rougher = self.of_roughness(rough + 1, strong, strong_share, azimuth, w.z);
        smoother.lerp(rougher, rough_share)
    }

    fn of_roughness(&self, rough: u32, strong: u32, share: f32, azimuth: f32, z: f32) -> Vec2 {
        let first = (rough * STRENGTHS + strong) * AZIMUTHS;
        let weaker = self.of_azimuth(first, azimuth, z);
        let stronger = self.of_azimuth(first + AZIMUTHS, azimuth, z);
        weaker.lerp(stronger, share)
    }

    fn of_azimuth(&self, first: u32, azimuth: f32, z: f32) -> Vec2 {
        let (turned, turned_share) = cell(azimuth, AZIMUTHS);
        let (column, along) = cell(z.clamp(0.0, 1.0).sqrt(), COSINES);
        let row = self.first + (first + turned) * (COSINES - 1) + column;
        let here = between(at(self.rows, row), along);
        here.lerp(between(at(self.rows, row + COSINES - 1), along), turned_share)
    }

    /// The mean albedo.
    pub fn mean(&self, roughness: f32, strength: f32) -> Vec2 {
        let (rough, rough_share) = cell(roughness, ROUGHNESSES);
        let (strong, strong_share) = cell(strength, STRENGTHS);
        let row = self.first + DIRECTIONS + strong * (ROUGHNESSES - 1) + rough;
        let weaker = between(at(self.rows, row), rough_share);
        weaker.lerp(between(at(self.rows, row + ROUGHNESSES - 1), rough_share), strong_share)
    }
}
