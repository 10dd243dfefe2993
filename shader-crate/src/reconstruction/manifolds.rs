//! The filter `manifolds`: a wide bilateral filter over features, by values on a few manifolds
//! (Gastal, Oliveira, "Adaptive Manifolds for Real-Time High-Dimensional Filtering", 2012).
//!
//! Pixels lie in a space of seven dimensions, their features. A manifold gives every place of the
//! picture a point there, smoothly. All pixels are splatted onto it, by how near they are; blurred
//! along it, by a recursive filter that slows down where the manifold is steep; and sliced off it
//! again. The sum over a tree of manifolds, each about what those above it are far from, is the
//! bilateral filter, at a cost that does not depend on its width.
//!
//! A manifold is kept as sums over pixels: of albedos and distances in `low`, of normals in `high`,
//! whose last component is the sum of weights. All arrays but the result are in rows.

use super::PictureParams;
use super::features::{Features, UNMEASURED};
use crate::estimator::filtered::FilteredPixel;
use crate::estimator::guide::Guide;
use crate::glam::{Vec3, Vec4};
use crate::math::dot;
use crate::math::elementary::{exp, pow};
use crate::memory::access::{Scatter, at};
use crate::memory::device_struct;
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

/// What is 1 in the space: of albedos, of normals, and of the logarithm of distances.
const ALBEDO_SIGMA: f32 = 0.1;
const NORMAL_SIGMA: f32 = 0.25;
const DISTANCE_SIGMA: f32 = 0.1;
/// The least sum of weights: where pixels are too far for a manifold to be about any, it is at the
/// origin, where no pixel is.
const LEAST: f32 = 1e-30;

/// A squared distance beyond all.
const FAR: f32 = 1e30;

/// Lanes of [`find_direction`].
pub const ADDERS: u32 = 1024;

device_struct! {
    /// The parameters of the filter's kernels. 32 bytes.
    pub struct ManifoldParams {
        /// Lanes: pixels; or rows or columns, of [`blur_along`]; or [`ADDERS`].
        pub threads: u32,
        /// Picture width in pixels.
        pub width: u32,
        /// Picture height in pixels.
        pub height: u32,
        /// The manifold, in a tree as a heap: the children of `k` are `2 k + 1` and `2 k + 2`.
        pub node: u32,
        /// 1: [`blur_along`] goes along rows; 0: along columns.
        pub along_rows: u32,
        /// What a blur keeps from one pixel to the next: `exp(-sqrt(2) / sigma)`.
        pub feedback: f32,
        /// Pixels that a step of 1 in the space is as far as; 0 for a blur that does not look at
        /// the manifold.
        pub steepness: f32,
        /// Unused; zero.
        pub pad: u32,
    }
}

/// A point of the space, or a difference of two.
#[derive(Clone, Copy)]
struct Point {
    /// Albedo and distance.
    low: Vec4,
    normal: Vec3,
}

impl Point {
    fn of_pixel(features: &Features) -> Self {
        Self {
            low: (features.albedo * (1.0 / ALBEDO_SIGMA))
                .extend(features.distance * (1.0 / DISTANCE_SIGMA)),
            normal: features.normal * (1.0 / NORMAL_SIGMA),
        }
    }

    fn of_sums(low: Vec4, high: Vec4) -> Self {
        let weight = high.w.max(LEAST);
        Self { low: low / weight, normal: high.truncate() / weight }
    }

    fn minus(&self, other: &Self) -> Self {
        Self { low: self.low - other.low, normal: self.normal - other.normal }
    }

    fn dot(&self, other: &Self) -> f32 {
        dot(self.low, other.low) + self.normal.dot(other.normal)
    }

    /// How much a pixel that is so far from a manifold is on it, from 0 to 1.
    fn nearness(&self) -> f32 {
        exp(-0.5 * self.dot(self))
    }
}

/// Kernel: the colour of pixel `lane` of the picture, in rank order, with 1 as the last component;
/// zeros where nothing is measured. It belongs to the first manifold, and nothing of it has been
/// filtered.
pub fn begin_manifolds(
    lane: u32,
    params: &PictureParams,
    guides: &[Guide],
    colors: &mut Scatter<'_, Vec4>,
    sums: &mut Scatter<'_, Vec4>,
    near: &mut Scatter<'_, Vec4>,
    clusters: &mut Scatter<'_, u32>,
) {
    let guide = at(guides, lane);
    let place = params.row_index(lane);
    let color = if guide.is_measured() { guide.color.extend(1.0) } else { Vec4::ZERO };
    colors.set(place, color);
    sums.set(place, Vec4::ZERO);
    near.set(place, Vec4::new(FAR, 0.0, 0.0, 0.0));
    clusters.set(place, 0);
}

/// Kernel: what pixel `lane` adds to a manifold before its blur: itself, if it is of the manifold's
/// cluster, by how far it is from the manifold above, `parent`. The first has all, entirely.
pub fn begin_manifold(
    lane: u32,
    params: &ManifoldParams,
    features: &[Features],
    clusters: &[u32],
    parent_low: &[Vec4],
    parent_high: &[Vec4],
    low: &mut Vec4,
    high: &mut Vec4,
) {
    let features = at(features, lane);
    let pixel = Point::of_pixel(&features);
    let mut weight = 0.0;
    if features.surface != UNMEASURED && at(clusters, lane) == params.node {
        weight = 1.0;
        if params.node > 0 {
            let parent = Point::of_sums(at(parent_low, lane), at(parent_high, lane));
            weight -= pixel.minus(&parent).nearness();
        }
    }
    *low = pixel.low * weight;
    *high = (pixel.normal * weight).extend(weight);
}

/// Kernel: blurs values along row or column `lane`, there and back, by a recursive filter that
/// slows down where the manifold is steep.
pub fn blur_along(
    lane: u32,
    params: &ManifoldParams,
    low: &[Vec4],
    high: &[Vec4],
    values: &mut Scatter<'_, Vec4>,
) {
    let ManifoldParams { width, height, .. } = *params;
    let (first, step, len) =
        if params.along_rows != 0 { (lane * width, 1, width) } else { (lane, width, height) };
    let mut passed = values.get(first);
    let mut k = 1;
    while k < len {
        let place = first + k * step;
        let keep = keep(params, low, high, place, place - step);
        let value = values.get(place);
        passed = value + (passed - value) * keep;
        values.set(place, passed);
        k += 1;
    }
    let mut k = len - 1;
    while k > 0 {
        k -= 1;
        let place = first + k * step;
        let keep = keep(params, low, high, place, place + step);
        let value = values.get(place);
        passed = value + (passed - value) * keep;
        values.set(place, passed);
    }
}

/// What a blur keeps from one place to the next.
fn keep(params: &ManifoldParams, low: &[Vec4], high: &[Vec4], here: u32, there: u32) -> f32 {
    let mut length = 1.0;
    if params.steepness > 0.0 {
        let here = Point::of_sums(at(low, here), at(high, here));
        let step = here.minus(&Point::of_sums(at(low, there), at(high, there)));
        length = (1.0 + params.steepness * params.steepness * step.dot(&step)).sqrt();
    }
    pow(params.feedback, length)
}

/// Kernel: what pixel `lane` splats onto a manifold.
pub fn splat_pixels(
    lane: u32,
    _: &ManifoldParams,
    features: &[Features],
    colors: &[Vec4],
    low: &[Vec4],
    high: &[Vec4],
    splat: &mut Vec4,
) {
    let pixel = Point::of_pixel(&at(features, lane));
    let manifold = Point::of_sums(at(low, lane), at(high, lane));
    *splat = at(colors, lane) * pixel.minus(&manifold).nearness();
}

/// Kernel: adds what lies on a manifold at pixel `lane`, `blurred`, to its sums. Of `near` the
/// first component is the least squared distance of a manifold so far, the second a sum of squared
/// nearnesses.
pub fn slice_manifold(
    lane: u32,
    _: &ManifoldParams,
    features: &[Features],
    low: &[Vec4],
    high: &[Vec4],
    blurred: &[Vec4],
    sum: &mut Vec4,
    near: &mut Vec4,
) {
    let pixel = Point::of_pixel(&at(features, lane));
    let distance = pixel.minus(&Point::of_sums(at(low, lane), at(high, lane)));
    let nearness = distance.nearness();
    *sum += at(blurred, lane) * nearness;
    near.x = near.x.min(distance.dot(&distance));
    near.y += nearness * nearness;
}

/// Kernel: a part of the direction in which the pixels of a cluster are far from their manifold:
/// one step of a power iteration, over every [`ADDERS`]th pixel.
pub fn find_direction(
    lane: u32,
    params: &ManifoldParams,
    features: &[Features],
    clusters: &[u32],
    low: &[Vec4],
    high: &[Vec4],
    direction_low: &mut Vec4,
    direction_high: &mut Vec4,
) {
    // Any direction will do that is not at right angles to what is sought.
    let start = Point { low: Vec4::new(0.5, -0.3, 0.4, 0.6), normal: Vec3::new(-0.4, 0.7, 0.3) };
    let mut sum = Point { low: Vec4::ZERO, normal: Vec3::ZERO };
    let mut place = lane;
    while place < params.width * params.height {
        let features = at(features, place);
        if features.surface != UNMEASURED && at(clusters, place) == params.node {
            let manifold = Point::of_sums(at(low, place), at(high, place));
            let away = Point::of_pixel(&features).minus(&manifold);
            let along = away.dot(&start);
            sum.low += away.low * along;
            sum.normal += away.normal * along;
        }
        place += ADDERS;
    }
    *direction_low = sum.low;
    *direction_high = sum.normal.extend(0.0);
}

/// Kernel, of one lane: puts the parts of a direction together, into its first two elements.
pub fn join_direction(
    lane: u32,
    _: &ManifoldParams,
    parts_low: &[Vec4],
    parts_high: &[Vec4],
    direction: &mut Scatter<'_, Vec4>,
) {
    let (mut low, mut high, mut part) = (Vec4::ZERO, Vec4::ZERO, 0);
    while part < ADDERS {
        low += at(parts_low, part);
        high += at(parts_high, part);
        part += 1;
    }
    direction.set(2 * lane, low);
    direction.set(2 * lane + 1, high);
}

/// Kernel: gives pixel `lane` of a cluster to one of the two below it, by the side of the manifold
/// that it is on.
pub fn split_cluster(
    lane: u32,
    params: &ManifoldParams,
    features: &[Features],
    low: &[Vec4],
    high: &[Vec4],
    direction: &[Vec4],
    cluster: &mut u32,
) {
    if *cluster == params.node {
        let manifold = Point::of_sums(at(low, lane), at(high, lane));
        let away = Point::of_pixel(&at(features, lane)).minus(&manifold);
        let direction = Point { low: at(direction, 0), normal: at(direction, 1).truncate() };
        let side = if away.dot(&direction) < 0.0 { 1 } else { 2 };
        *cluster = 2 * params.node + side;
    }
}

/// Kernel: pixel `lane` of the picture, in rank order, by its sums over manifolds. The farther all
/// manifolds are, the more it keeps its own colour.
pub fn finish_manifolds(
    lane: u32,
    params: &ManifoldParams,
    guides: &[Guide],
    sums: &[Vec4],
    near: &[Vec4],
    filtered: &mut FilteredPixel,
) {
    let guide = at(guides, lane);
    let ManifoldParams { threads, width, height, .. } = *params;
    let place = PictureParams { threads, first_rank: 0, width, height }.row_index(lane);
    let (sum, near) = (at(sums, place), at(near, place));
    *filtered = FilteredPixel { color: guide.color, own: 1.0 };
    if guide.is_measured() && sum.w > LEAST {
        let part = exp(-0.5 * near.x);
        let color = guide.color + (sum.truncate() / sum.w - guide.color) * part;
        // What the blur, there and back along both axes, leaves of a pixel in its own place.
        let stays = (1.0 - params.feedback) / (1.0 + params.feedback);
        let own = (near.y * stays * stays / sum.w).min(1.0);
        *filtered = FilteredPixel { color, own: 1.0 + (own - 1.0) * part };
    }
}
