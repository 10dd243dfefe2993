//! A vertex of a light path, in 64 bytes: four `uvec4`s.
//!
//! ```text
//! position xyz, media | triangle's normal xyz, norm | shading normal xyz, segments |
//! flux xyz, instance
//! ```
//!
//! What the words of a row are, [`crate::memory::rows`] says. What a diffuse surface sends to a
//! point depends on where its light came from through the flux alone, so the way it arrived is not
//! kept.

use crate::glam::{UVec4, Vec3};
use crate::memory::access::Scatter;
use crate::memory::rows::{row, vector};
use crate::scene::abilities::Abilities;
use crate::scene::bsdf::diffuse;
use crate::scene::media::Media;
use crate::scene::ray::SurfacePoint;
use crate::scene::surface::SurfaceView;

/// `uvec4`s of one vertex.
pub const ROWS_PER_VERTEX: u32 = 4;

/// A diffuse vertex of a light path.
#[cfg_attr(not(target_arch = "spirv"), derive(Debug, PartialEq))]
#[derive(Clone, Copy)]
pub struct LightVertex {
    /// Where it is, in world units.
    pub position: Vec3,
    /// What it is in.
    pub media: Media,
    /// Unit normal of the triangle, of either sign.
    pub geometric: Vec3,
    /// [`Subpath::norm`](super::mis::Subpath::norm) of the light path.
    pub norm: f32,
    /// Shading normal, unit length, on the side that the light came from and goes to.
    pub normal: Vec3,
    /// Segments of the light path, from 1.
    pub segments: u32,
    /// The flux that the path carries here times the BSDF (reflectance over pi): times cosine over
    /// squared distance, what it adds to the irradiance of a point that sees it; linear Rec.709.
    pub flux: Vec3,
    /// The instance that it is on, or [`NO_INSTANCE`](crate::scene::bvh::instance::NO_INSTANCE).
    pub instance: u32,
}

impl LightVertex {
    /// The four rows of the buffer.
    pub fn to_rows(&self) -> [UVec4; 4] {
        [
            row(self.position, self.media.0),
            row(self.geometric, self.norm.to_bits()),
            row(self.normal, self.segments),
            row(self.flux, self.instance),
        ]
    }

    /// Unpacks the four rows.
    pub fn from_rows(rows: [UVec4; 4]) -> Self {
        Self {
            position: vector(rows[0]),
            media: Media(rows[0].w),
            geometric: vector(rows[1]),
            norm: f32::from_bits(rows[1].w),
            normal: vector(rows[2]),
            segments: rows[2].w,
            flux: vector(rows[3]),
            instance: rows[3].w,
        }
    }

    /// Density per solid angle with which the path from the light would go on in `direction`.
    pub fn pdf(&self, direction: Vec3) -> f32 {
        diffuse::pdf(self.normal, direction)
    }

    /// Where it is, and how a ray leaves it.
    pub fn point(&self, surfaces: &SurfaceView<'_, impl Abilities>) -> SurfacePoint {
        let clearance = surfaces.clearance(self.instance);
        SurfacePoint { position: self.position, normal: self.geometric, clearance }
    }

    /// Writes it from row `first` on.
    pub fn store(&self, rows: &mut Scatter<'_, UVec4>, first: u32) {
        let [a, b, c, d] = self.to_rows();
        rows.set(first, a);
        rows.set(first + 1, b);
        rows.set(first + 2, c);
        rows.set(first + 3, d);
    }
}
