//! The filter `learned`: a joint bilateral filter, of which a small network sets the parameters of
//! each pixel (after Kalantari et al., "A Machine Learning Approach for Filtering Monte Carlo
//! Noise", 2015).
//!
//! How wide a filter should be, and how much it should look at each feature, depends on what is
//! there: a texture that the albedo knows, a shadow that nothing knows, much noise or little. A
//! [`description`] of twenty numbers says so of each pixel, the [`network`] makes eight of them,
//! and [`filter`] is the filter that these are the parameters of: that of the estimator
//! [`bilateral`](crate::estimator::bilateral), with one more factor. It compares colours which have
//! been smoothed over a few pixels of the same surface; their noise is less, and the edge of a
//! shadow is seen earlier.

pub mod description;
pub mod filter;
pub mod network;
pub mod surroundings;

use crate::glam::Vec4;
use crate::math::elementary::exp;
use crate::memory::device_struct;

/// The least and the largest that the network's outputs count as; they multiply by e to this power.
///
/// What pixels differ by beyond three standard errors is never noise: a path of rare brightness
/// brings its pixel to one. So tolerances have a bound, and slopes of the pixels' own colours
/// another, and whatever the network says, nothing that is clearly bright runs into its neighbours.
pub const LEAST: [Vec4; 2] = [Vec4::splat(-5.0), Vec4::new(-1.5, -5.0, -5.0, -5.0)];
/// See [`LEAST`].
pub const LARGEST: [Vec4; 2] = [Vec4::splat(5.0), Vec4::new(5.0, 0.8, 5.0, 0.8)];

device_struct! {
    /// The filter of one pixel. 48 bytes.
    pub struct PixelFilter {
        /// By what the negative logarithms of the weights by pixel distance, world distance,
        /// normals and albedos are multiplied, each of a Gaussian of the standard deviation in
        /// [`FilterParams`](crate::estimator::bilateral::FilterParams); above 0.
        pub features: Vec4,
        /// How fast weights fall off with what colours differ by beyond noise, and how much of that
        /// counts as noise: slope and tolerance of the pixels' own colours, then those of smoothed
        /// ones. Tolerances are by the variance of the difference, slopes by its inverse.
        pub colors: Vec4,
        /// How far the pixel's smoothed colour follows its own, from 0 to 1.
        pub own: f32,
        /// Unused; zero.
        pub pad0: u32,
        /// Unused; zero.
        pub pad1: u32,
        /// Unused; zero.
        pub pad2: u32,
    }
}

impl PixelFilter {
    /// What outputs of 0 stand for: the filter of the estimator `bilateral`, to which the smoothed
    /// colours add little.
    const COLORS: Vec4 = Vec4::new(0.5, 4.0, 0.05, 4.0);

    /// Of the network's outputs: logarithms of the features' factors, then of the colours'.
    pub fn new(outputs: [Vec4; 2], own: f32) -> Self {
        let power = |outputs: Vec4, least: Vec4, largest: Vec4| {
            let outputs = outputs.max(least).min(largest);
            Vec4::new(exp(outputs.x), exp(outputs.y), exp(outputs.z), exp(outputs.w))
        };
        let [features, colors] = outputs;
        Self {
            features: power(features, LEAST[0], LARGEST[0]),
            colors: power(colors, LEAST[1], LARGEST[1]) * Self::COLORS,
            own,
            pad0: 0,
            pad1: 0,
            pad2: 0,
        }
    }
}
