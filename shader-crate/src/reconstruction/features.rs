//! What the camera sees of a pixel, as filters compare it: the filter `features` (Rousselle, Manzi,
//! Zwicker, "Robust Denoising using Feature and Color Information", 2013) and the planes of
//! [`nfor`](super::nfor).
//!
//! Two pixels are unlike where a feature of theirs differs by more than it changes from pixel to
//! pixel about the first. Features are means over 8 to 32 rays, stratified like the samples, and
//! the film does not keep how they spread; so they are compared as they are, where the paper
//! filters them before and takes off their variances.

use crate::estimator::guide::{Guide, mean_of_squares, unpack_normal};
use crate::film::tiles::{pixel_of_rank, rank_of_pixel};
use crate::glam::Vec3;
use crate::math::elementary::ln;
use crate::memory::access::{Scatter, at};
use crate::memory::device_struct;

device_struct! {
    /// The parameters of [`describe_features`]. 32 bytes.
    pub struct FeatureParams {
        /// Pixels of the picture.
        pub threads: u32,
        /// Picture width in pixels.
        pub width: u32,
        /// Picture height in pixels.
        pub height: u32,
        /// Unused; zero.
        pub pad: u32,
        /// The camera's pinhole, in world units.
        pub origin: Vec3,
        /// Side of a pixel at distance 1 from the pinhole.
        pub pixel_pitch: f32,
    }
}

device_struct! {
    /// The features of a pixel. 48 bytes.
    pub struct Features {
        /// Mean reflectance of the first surface; zero where there is none.
        pub albedo: Vec3,
        /// Natural logarithm of its distance from the pinhole, in world units; 0 where there is
        /// none. So differences are relative, whatever the scene's units.
        pub distance: f32,
        /// Mean shading normal, of unit length; zero where there is no surface.
        pub normal: Vec3,
        /// 1 where the camera saw a surface, 0 where it saw none, and [`UNMEASURED`] where nothing
        /// is known of the pixel.
        pub surface: u32,
        /// Squared slopes, by pixel, of albedo, normal and distance, the mean over components.
        pub slopes: Vec3,
        /// Unused; zero.
        pub pad: u32,
    }
}

/// [`Features::surface`] of a pixel without a measurement.
pub const UNMEASURED: u32 = 2;

/// The negative logarithm of a weight that is none.
const UNLIKE: f32 = 1e4;

impl Features {
    /// Without slopes.
    fn of(guide: &Guide, origin: Vec3) -> Self {
        let mut features = Self {
            albedo: Vec3::ZERO,
            distance: 0.0,
            normal: Vec3::ZERO,
            surface: if guide.is_measured() { 0 } else { UNMEASURED },
            slopes: Vec3::ZERO,
            pad: 0,
        };
        if guide.is_measured() && guide.has_surface() {
            features.albedo = guide.albedo;
            features.distance = ln((guide.position - origin).length().max(f32::MIN_POSITIVE));
            features.normal = unpack_normal(guide.normal);
            features.surface = 1;
        }
        features
    }

    /// Those of the pixel at a column and a row.
    fn near(params: &FeatureParams, guides: &[Guide], x: u32, y: u32) -> Self {
        Self::of(&at(guides, rank_of_pixel(x, y, params.width, params.height)), params.origin)
    }

    /// The squared slopes along an axis, by the pixels on both sides: that to the one which differs
    /// less. An edge is none of the surface's own slope.
    fn slope(&self, one: &Self, other: &Self) -> Vec3 {
        self.squared_differences(one).min(self.squared_differences(other))
    }

    /// What the components of the slopes are of, squared.
    fn squared_differences(&self, other: &Self) -> Vec3 {
        let distance = self.distance - other.distance;
        Vec3::new(
            mean_of_squares(self.albedo - other.albedo),
            mean_of_squares(self.normal - other.normal),
            distance * distance,
        )
    }
}

/// Kernel: the features of pixel `lane` of the picture, in rows.
pub fn describe_features(
    lane: u32,
    params: &FeatureParams,
    guides: &[Guide],
    features: &mut Scatter<'_, Features>,
) {
    let FeatureParams { width, height, .. } = *params;
    let (x, y) = pixel_of_rank(lane, width, height);
    let mut own = Features::near(params, guides, x, y);
    let (left, right) = (before(x, width), after(x, width));
    let along_x = own
        .slope(&Features::near(params, guides, left, y), &Features::near(params, guides, right, y));
    let (top, bottom) = (before(y, height), after(y, height));
    let along_y = own
        .slope(&Features::near(params, guides, x, top), &Features::near(params, guides, x, bottom));
    own.slopes = along_x + along_y;
    features.set(y * width + x, own);
}

/// The pixel before one in a row or column of `len`; at its end the one on the other side.
fn before(place: u32, len: u32) -> u32 {
    if place > 0 { place - 1 } else { (place + 1).min(len - 1) }
}

/// The pixel after one, likewise.
fn after(place: u32, len: u32) -> u32 {
    if place + 1 < len { place + 1 } else { place - place.min(1) }
}

/// The largest squared difference of the features at two places in rows, by what the features
/// change from pixel to pixel at the first: `strength` is of that, squared, and `floor` the least
/// of it.
pub fn unlikeness(features: &[Features], here: u32, there: u32, strength: f32, floor: f32) -> f32 {
    let (here, there) = (at(features, here), at(features, there));
    let apart = here.squared_differences(&there) / (here.slopes.max(Vec3::splat(floor)) * strength);
    if here.surface == there.surface { apart.max_element() } else { UNLIKE }
}
