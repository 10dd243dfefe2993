//! The filter `nfor`: planes in features, fitted to the neighbours of each pixel and collected from
//! all windows that a pixel is in (Bitterli et al., "Nonlinearly Weighted First-order Regression
//! for Denoising Monte Carlo Renderings", 2016).
//!
//! A mean over neighbours is right where the picture is constant. Where it follows what the camera
//! sees (a texture, a curve, the distance) or is a ramp, a plane is: it has terms for the place in
//! the picture, for albedo, normal and distance. Neighbours are weighed by their
//! [patches](super::patch_map) in one half for the values of the other, so that what no feature
//! shows is not fitted. Each plane is worth something at every pixel that it was fitted to, and
//! each pixel is the weighted mean of all planes it had a part in.

use super::features::{Features, UNMEASURED};
use super::patch_map::{WINDOW, weight};
use super::patches::place_near;
use crate::film::tiles::pixel_of_rank;
use crate::glam::{Vec3, Vec4};
use crate::memory::access::{Scatter, at, local, local_mut};
use crate::memory::device_struct;

/// Terms of a plane: a constant, two of place, three of albedo, three of normal, one of distance.
pub const TERMS: u32 = 10;
/// Elements of the lower half of a symmetric matrix of them.
const HALF: u32 = TERMS * (TERMS + 1) / 2;
/// What is added to the diagonal, by the sum of weights: slopes that the neighbours say nothing of
/// are 0.
const RIDGE: f32 = 1e-4;
/// How unevenly a plane follows its neighbours: the more, the less it does those that are like its
/// own pixel.
const EVENNESS: f32 = 0.25;
/// Weights below are none.
const SMALLEST_WEIGHT: f32 = 1e-4;

device_struct! {
    /// The parameters of [`fit_planes`] and [`collect_planes`]. 32 bytes.
    pub struct PlaneParams {
        /// Pixels of the picture.
        pub threads: u32,
        /// Picture width in pixels.
        pub width: u32,
        /// Picture height in pixels.
        pub height: u32,
        /// What distances of patches are multiplied by: `1 / k^2` of the paper, by that of which
        /// they were measured.
        pub sharpness: f32,
        /// Side of a pixel at distance 1 from the pinhole.
        pub pixel_pitch: f32,
        /// Unused; zero.
        pub pad0: u32,
        /// Unused; zero.
        pub pad1: u32,
        /// Unused; zero.
        pub pad2: u32,
    }
}

impl PlaneParams {
    fn place_near(&self, x: i32, y: i32) -> u32 {
        place_near(self.width, self.height, x, y)
    }

    /// First and last place of a row or column of `len` pixels in the window about a place.
    fn reach(place: i32, len: u32) -> (i32, i32) {
        let window = WINDOW as i32;
        ((place - window).max(0), (place + window).min(len as i32 - 1))
    }

    /// The terms of the plane about `centre` at a neighbour, all about 1 where they are large.
    fn terms(&self, centre: &Features, tap: &Features, dx: i32, dy: i32) -> [f32; TERMS as usize] {
        let reach = 1.0 / WINDOW as f32;
        let albedo = tap.albedo - centre.albedo;
        let normal = tap.normal - centre.normal;
        // In what the window covers there.
        let distance = (tap.distance - centre.distance) * reach / self.pixel_pitch;
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
            distance.clamp(-1.0, 1.0),
        ]
    }
}

/// Where the element of a row and a column, at most the row, lies.
fn element(row: u32, column: u32) -> u32 {
    row * (row + 1) / 2 + column
}

/// Kernel: the plane about pixel `lane` of one half, `values`, with weights by the distances of the
/// other's patches in `map`; all in rows. The term `t` of a plane lies `t` pictures behind its
/// first: the factors of red, green and blue. The last components of the first two terms say how
/// far the plane, at a neighbour of weight `w`, follows that one's value by `w`: a line in `1 - w`;
/// the first is below 0 where nothing is measured.
///
/// At the pixel itself it is known. For all neighbours together it is the number of terms that they
/// say something of.
pub fn fit_planes(
    lane: u32,
    params: &PlaneParams,
    features: &[Features],
    map: &[u32],
    values: &[Vec4],
    planes: &mut Scatter<'_, Vec4>,
) {
    let (x, y) = pixel_of_rank(lane, params.width, params.height);
    let (x, y) = (x as i32, y as i32);
    let (pixels, place) = (params.width * params.height, params.place_near(x, y));
    let centre = at(features, place);
    if centre.surface == UNMEASURED {
        planes.set(place, Vec4::NEG_ONE);
        return;
    }
    let mut matrix = [0.0_f32; HALF as usize];
    let (mut sums, mut squared_weights) = ([Vec3::ZERO; TERMS as usize], 0.0);
    let ((first_column, last_column), (first_row, last_row)) =
        (PlaneParams::reach(x, params.width), PlaneParams::reach(y, params.height));
    let mut row = first_row;
    while row <= last_row {
        let mut column = first_column;
        while column <= last_column {
            let (dx, dy) = (column - x, row - y);
            let there = params.place_near(column, row);
            let weight = weight(map, pixels, place, dx, dy, params.sharpness);
            if weight > SMALLEST_WEIGHT {
                let (tap, value) = (at(features, there), at(values, there));
                if value.w >= 0.0 && tap.surface == centre.surface {
                    let terms = params.terms(&centre, &tap, dx, dy);
                    add(&mut matrix, &mut sums, &terms, weight, value.truncate());
                    squared_weights += weight * weight;
                }
            }
            column += 1;
        }
        row += 1;
    }
    let weights = local(&matrix, 0);
    let (mut own, mut slope) = (-1.0, 0.0);
    if weights > 0.0 {
        let known = solve(&mut matrix, &mut sums);
        own = 1.0 / local(&matrix, 0).max(f32::MIN_POSITIVE);
        let rest = (known - own * weights).max(0.0);
        slope = rest / (weights * (1.0 + EVENNESS) - squared_weights);
    }
    let mut term = 0;
    while term < TERMS {
        let last = last_component(term, own, slope);
        planes.set(term * pixels + place, local(&sums, term).extend(last));
        term += 1;
    }
}

/// What the last component of a plane's term says.
fn last_component(term: u32, own: f32, slope: f32) -> f32 {
    if term == 0 {
        own
    } else if term == 1 {
        slope
    } else {
        0.0
    }
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

/// Solves the normal equations, of some weight: `sums` become the factors of the terms, and the
/// first element of the matrix the inverse of what the plane at its own pixel follows that by.
/// Returns the number of terms that the neighbours say something of.
fn solve(matrix: &mut [f32; HALF as usize], sums: &mut [Vec3; TERMS as usize]) -> f32 {
    let ridge = RIDGE * local(matrix, 0);
    let mut row = 1;
    while row < TERMS {
        *local_mut(matrix, element(row, row)) += ridge;
        row += 1;
    }
    // From the last to the second; what is left of the first is the constant's own equation.
    let (mut pivot, mut known) = (TERMS - 1, 1.0);
    while pivot > 0 {
        let diagonal = local(matrix, element(pivot, pivot)).max(ridge);
        known += 1.0 - ridge / diagonal;
        let sum = local(sums, pivot);
        let mut row = 0;
        while row < pivot {
            let factor = local(matrix, element(pivot, row)) / diagonal;
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
    let mut row = 0;
    while row < TERMS {
        let mut column = 0;
        while column < row {
            let known = local(sums, column) * local(matrix, element(row, column));
            *local_mut(sums, row) -= known;
            column += 1;
        }
        let least = if row == 0 { f32::MIN_POSITIVE } else { ridge };
        *local_mut(sums, row) /= local(matrix, element(row, row)).max(least);
        row += 1;
    }
    known
}

/// Kernel: pixel `lane` of a filtered half as all planes have it that it had a part in, in rank
/// order: the colour, and how far it follows the pixel's own. `values` is the half, in rows. What
/// is not measured stays as it is, with 1.
pub fn collect_planes(
    lane: u32,
    params: &PlaneParams,
    features: &[Features],
    map: &[u32],
    values: &[Vec4],
    planes: &[Vec4],
    filtered: &mut Vec4,
) {
    let (x, y) = pixel_of_rank(lane, params.width, params.height);
    let (x, y) = (x as i32, y as i32);
    let (pixels, place) = (params.width * params.height, params.place_near(x, y));
    let (own, value) = (at(features, place), at(values, place));
    let (mut color, mut weights, mut follows) = (Vec3::ZERO, 0.0, 0.0);
    let ((first_column, last_column), (first_row, last_row)) =
        (PlaneParams::reach(x, params.width), PlaneParams::reach(y, params.height));
    let mut row = first_row;
    while row <= last_row && value.w >= 0.0 {
        let mut column = first_column;
        while column <= last_column {
            let (dx, dy) = (x - column, y - row);
            let there = params.place_near(column, row);
            let weight = weight(map, pixels, there, dx, dy, params.sharpness);
            let centre = at(features, there);
            if weight > SMALLEST_WEIGHT && centre.surface == own.surface {
                let constant = at(planes, there);
                if constant.w >= 0.0 {
                    let terms = params.terms(&centre, &own, dx, dy);
                    let (mut value, mut term) = (constant, 1);
                    while term < TERMS {
                        value += at(planes, term * pixels + there) * local(&terms, term);
                        term += 1;
                    }
                    let slope = at(planes, pixels + there).w;
                    color += value.truncate() * weight;
                    weights += weight;
                    let follow = constant.w + slope * (1.0 + EVENNESS - weight);
                    follows += weight * (weight * follow).min(1.0);
                }
            }
            column += 1;
        }
        row += 1;
    }
    *filtered = if weights > 0.0 {
        (color / weights).max(Vec3::ZERO).extend((follows / weights).clamp(0.0, 1.0))
    } else {
        value.truncate().extend(1.0)
    };
}
