//! The filter `regression`: about each pixel, the plane in features that fits its neighbours best
//! (Moon et al., "Adaptive Rendering Based on Weighted Local Regression", 2014; Bitterli et al.,
//! "Nonlinearly Weighted First-order Regression for Denoising Monte Carlo Renderings", 2016).
//!
//! A mean over neighbours is right where the picture is constant. Where it follows what the camera
//! sees (a texture, a curve, the distance) or is a ramp, a plane is: it has terms for the place in
//! the picture, for albedo, normal and distance. Neighbours are weighed as by the filter
//! [`nlm`](super::nlm), with weights of one half for the values of the other, so that what no
//! feature shows is not fitted.

use super::nlm::{distance, place_near};
use crate::estimator::guide::{Guide, unpack_normal};
use crate::film::tiles::{pixel_of_rank, rank_of_pixel};
use crate::glam::{Vec3, Vec4};
use crate::memory::access::{at, local, local_mut};
use crate::memory::device_struct;
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

/// Terms of a plane: a constant, two of place, three of albedo, three of normal, one of distance.
const TERMS: u32 = 10;
/// Elements of the lower half of a symmetric matrix of them.
const HALF: u32 = TERMS * (TERMS + 1) / 2;
/// Pixels to each side of a patch.
const PATCH: i32 = 2;
/// Pixels of a patch.
const AREA: f32 = ((2 * PATCH + 1) * (2 * PATCH + 1)) as f32;
/// What is added to the diagonal, by the sum of weights: slopes that the neighbours say nothing of
/// are 0.
const RIDGE: f32 = 1e-4;
/// Weights below are none.
const SMALLEST_WEIGHT: f32 = 1e-4;

device_struct! {
    /// The parameters of [`regress_half`]. 48 bytes.
    pub struct RegressionParams {
        /// Pixels of the picture.
        pub threads: u32,
        /// Picture width in pixels.
        pub width: u32,
        /// Picture height in pixels.
        pub height: u32,
        /// Neighbours to each side that a plane is fitted to; at least 1.
        pub radius: u32,
        /// The camera's pinhole, in world units.
        pub origin: Vec3,
        /// Side of a pixel at distance 1 from the pinhole.
        pub pixel_pitch: f32,
        /// As [`NlmParams::strength`](super::nlm::NlmParams::strength).
        pub strength: f32,
        /// As [`NlmParams::explained`](super::nlm::NlmParams::explained).
        pub explained: f32,
        /// Unused; zero.
        pub pad0: u32,
        /// Unused; zero.
        pub pad1: u32,
    }
}

impl RegressionParams {
    /// The pixel nearest to a place, which may be outside the picture: its place in rows.
    fn place_near(&self, x: i32, y: i32) -> u32 {
        place_near(self.width, self.height, x, y)
    }

    /// How alike the patches about two pixels of a half are, from 0 to 1.
    fn weight(&self, weighers: &[Vec4], x: i32, y: i32, dx: i32, dy: i32) -> f32 {
        let (mut sum, mut row) = (0.0, -PATCH);
        while row <= PATCH {
            let mut column = -PATCH;
            while column <= PATCH {
                let here = at(weighers, self.place_near(x + column, y + row));
                let there = at(weighers, self.place_near(x + column + dx, y + row + dy));
                sum += distance(self.strength, self.explained, here, there);
                column += 1;
            }
            row += 1;
        }
        (-(sum / AREA).max(0.0)).exp()
    }
}

/// The plane's terms in a neighbour, all about 1 where they are large.
fn terms(
    params: &RegressionParams,
    centre: &Guide,
    tap: &Guide,
    dx: i32,
    dy: i32,
) -> [f32; TERMS as usize] {
    let reach = 1.0 / params.radius as f32;
    let albedo = tap.albedo - centre.albedo;
    let (mut normal, mut distance) = (Vec3::ZERO, 0.0);
    if centre.has_surface() && tap.has_surface() {
        normal = unpack_normal(tap.normal) - unpack_normal(centre.normal);
        let own = (centre.position - params.origin).length();
        let step = (tap.position - params.origin).length() - own;
        // In what the window covers there.
        distance = step * reach / (params.pixel_pitch * own);
        distance = distance.clamp(-1.0, 1.0);
    }
    [
        1.0,
        dx as f32 * reach,
        dy as f32 * reach,
        albedo.x,
        albedo.y,
        albedo.z,
        normal.x,
        normal.y,
        normal.z,
        distance,
    ]
}

/// Where the element of a row and a column, at most the row, lies.
fn element(row: u32, column: u32) -> u32 {
    row * (row + 1) / 2 + column
}

/// Kernel: one half, `values`, as planes fitted with the weights of the other, `weighers`, both in
/// rows, in pixel `lane`: the colour, and how far it follows the pixel's own. What is not measured
/// stays as it is, with 1.
pub fn regress_half(
    lane: u32,
    params: &RegressionParams,
    guides: &[Guide],
    weighers: &[Vec4],
    values: &[Vec4],
    filtered: &mut Vec4,
) {
    let (x, y) = pixel_of_rank(lane, params.width, params.height);
    let (x, y) = (x as i32, y as i32);
    let (centre, own) = (at(guides, lane), at(values, params.place_near(x, y)));
    *filtered = own.truncate().extend(1.0);
    if own.w < 0.0 || !centre.is_measured() {
        return;
    }
    let mut matrix = [0.0_f32; HALF as usize];
    let mut sums = [Vec3::ZERO; TERMS as usize];
    let reach = params.radius as i32;
    let (last_column, last_row) = (params.width as i32 - 1, params.height as i32 - 1);
    let mut row = (y - reach).max(0);
    while row <= (y + reach).min(last_row) {
        let mut column = (x - reach).max(0);
        while column <= (x + reach).min(last_column) {
            let (dx, dy) = (column - x, row - y);
            let rank = rank_of_pixel(column as u32, row as u32, params.width, params.height);
            let tap = at(guides, rank);
            let value = at(values, params.place_near(column, row));
            if value.w >= 0.0 && tap.has_surface() == centre.has_surface() {
                let weight = params.weight(weighers, x, y, dx, dy);
                if weight > SMALLEST_WEIGHT {
                    let terms = terms(params, &centre, &tap, dx, dy);
                    add(&mut matrix, &mut sums, &terms, weight, value.truncate());
                }
            }
            column += 1;
        }
        row += 1;
    }
    *filtered = solve(&mut matrix, &mut sums);
}

/// Adds a neighbour to the normal equations.
fn add(
    matrix: &mut [f32; HALF as usize],
    sums: &mut [Vec3; TERMS as usize],
    terms: &[f32; TERMS as usize],
    weight: f32,
    value: Vec3,
) {
    let (mut row, mut place) = (0, 0);
    while row < TERMS {
        let weighed = weight * local(terms, row);
        *local_mut(sums, row) += value * weighed;
        let mut column = 0;
        while column <= row {
            *local_mut(matrix, place) += weighed * local(terms, column);
            place += 1;
            column += 1;
        }
        row += 1;
    }
}

/// The plane at the pixel itself, where all terms but the constant are 0: the first of the
/// coefficients. How far it follows the pixel is the first element of the inverse matrix, the
/// pixel's own weight being 1. Both by symmetric elimination of all other terms.
fn solve(matrix: &mut [f32; HALF as usize], sums: &mut [Vec3; TERMS as usize]) -> Vec4 {
    let ridge = RIDGE * local(matrix, 0);
    let mut row = 1;
    while row < TERMS {
        *local_mut(matrix, element(row, row)) += ridge;
        row += 1;
    }
    // From the last to the second; what is left of the first is the answer.
    let mut pivot = TERMS - 1;
    while pivot > 0 {
        let diagonal = local(matrix, element(pivot, pivot));
        let inverse = if diagonal > 0.0 { 1.0 / diagonal } else { 0.0 };
        let sum = local(sums, pivot);
        let mut row = 0;
        while row < pivot {
            let factor = local(matrix, element(pivot, row)) * inverse;
            *local_mut(sums, row) -= sum * factor;
            let mut column = 0;
            while column <= row {
                let product = factor * local(matrix, element(pivot, column));
                *local_mut(matrix, element(row, column)) -= product;
                column += 1;
            }
            row += 1;
        }
        pivot -= 1;
    }
    let own = 1.0 / local(matrix, 0);
    (local(sums, 0) * own).extend(own.clamp(0.0, 1.0))
}
