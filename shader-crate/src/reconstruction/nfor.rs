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
use crate::glam::{Mat3, Vec3, Vec4};
use crate::memory::access::{Scatter, at, local, local_mut};
use crate::memory::device_struct;

/// Terms of a plane: a constant, two of place in the picture and one of distance, three of albedo,
/// three of normal.
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
    fn terms(&self, centre: &Features, tap: &Features, dx: i32, dy: i32) -> Terms {
        let reach = 1.0 / WINDOW as f32;
        // In what the window covers there.
        let distance = (tap.distance - centre.distance) * reach / self.pixel_pitch;
        Terms {
            place: Vec3::new(dx as f32 * reach, dy as f32 * reach, distance.clamp(-1.0, 1.0)),
            albedo: tap.albedo - centre.albedo,
            normal: tap.normal - centre.normal,
        }
    }
}

/// The terms of a plane at a neighbour but for the constant.
struct Terms {
    /// Columns and rows to the right and down, and the distance from the camera.
    place: Vec3,
    albedo: Vec3,
    normal: Vec3,
}

/// The normal equations: sums of products of the terms of neighbours, with one another and with
/// colours, by weights.
///
/// Each sum has a name, since what an index finds is in a GPU's memory and not in its registers:
/// with arrays, planes took ten times as long.
struct Equations {
    weights: f32,
    place: Vec3,
    albedo: Vec3,
    normal: Vec3,
    // The first word's terms are the rows.
    place_place: Mat3,
    albedo_place: Mat3,
    albedo_albedo: Mat3,
    normal_place: Mat3,
    normal_albedo: Mat3,
    normal_normal: Mat3,
    color: Vec3,
    color_place: Mat3,
    color_albedo: Mat3,
    color_normal: Mat3,
}

/// The products of all components of two vectors, those of the first as rows.
fn products(rows: Vec3, columns: Vec3) -> Mat3 {
    Mat3::from_cols(rows * columns.x, rows * columns.y, rows * columns.z)
}

impl Equations {
    /// Without neighbours.
    fn new() -> Self {
        Self {
            weights: 0.0,
            place: Vec3::ZERO,
            albedo: Vec3::ZERO,
            normal: Vec3::ZERO,
            place_place: Mat3::ZERO,
            albedo_place: Mat3::ZERO,
            albedo_albedo: Mat3::ZERO,
            normal_place: Mat3::ZERO,
            normal_albedo: Mat3::ZERO,
            normal_normal: Mat3::ZERO,
            color: Vec3::ZERO,
            color_place: Mat3::ZERO,
            color_albedo: Mat3::ZERO,
            color_normal: Mat3::ZERO,
        }
    }

    /// Adds a neighbour.
    fn add(&mut self, terms: &Terms, weight: f32, color: Vec3) {
        let Terms { place, albedo, normal } = *terms;
        let weighed =
            Terms { place: place * weight, albedo: albedo * weight, normal: normal * weight };
        self.weights += weight;
        self.place += weighed.place;
        self.albedo += weighed.albedo;
        self.normal += weighed.normal;
        self.place_place += products(weighed.place, place);
        self.albedo_place += products(weighed.albedo, place);
        self.albedo_albedo += products(weighed.albedo, albedo);
        self.normal_place += products(weighed.normal, place);
        self.normal_albedo += products(weighed.normal, albedo);
        self.normal_normal += products(weighed.normal, normal);
        self.color += color * weight;
        self.color_place += products(color, weighed.place);
        self.color_albedo += products(color, weighed.albedo);
        self.color_normal += products(color, weighed.normal);
    }

    /// The lower half of the matrix, row by row.
    #[rustfmt::skip]
    fn matrix(&self) -> [f32; HALF as usize] {
        let (p, a, n) = (self.place, self.albedo, self.normal);
        let (pp, aa, nn) = (self.place_place, self.albedo_albedo, self.normal_normal);
        // Their rows.
        let [ap, np, na] = [self.albedo_place, self.normal_place, self.normal_albedo];
        let (ap, np, na) = (ap.transpose(), np.transpose(), na.transpose());
        let (ax, ay, az) = (ap.x_axis, ap.y_axis, ap.z_axis);
        let (nx, ny, nz) = (np.x_axis, np.y_axis, np.z_axis);
        let (mx, my, mz) = (na.x_axis, na.y_axis, na.z_axis);
        [
            self.weights,
            p.x, pp.x_axis.x,
            p.y, pp.x_axis.y, pp.y_axis.y,
            p.z, pp.x_axis.z, pp.y_axis.z, pp.z_axis.z,
            a.x, ax.x, ax.y, ax.z, aa.x_axis.x,
            a.y, ay.x, ay.y, ay.z, aa.x_axis.y, aa.y_axis.y,
            a.z, az.x, az.y, az.z, aa.x_axis.z, aa.y_axis.z, aa.z_axis.z,
            n.x, nx.x, nx.y, nx.z, mx.x, mx.y, mx.z, nn.x_axis.x,
            n.y, ny.x, ny.y, ny.z, my.x, my.y, my.z, nn.x_axis.y, nn.y_axis.y,
            n.z, nz.x, nz.y, nz.z, mz.x, mz.y, mz.z, nn.x_axis.z, nn.y_axis.z, nn.z_axis.z,
        ]
    }

    /// The right sides.
    #[rustfmt::skip]
    fn sums(&self) -> [Vec3; TERMS as usize] {
        let (place, albedo, normal) = (self.color_place, self.color_albedo, self.color_normal);
        [
            self.color,
            place.x_axis, place.y_axis, place.z_axis,
            albedo.x_axis, albedo.y_axis, albedo.z_axis,
            normal.x_axis, normal.y_axis, normal.z_axis,
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
    let (mut equations, mut squared_weights) = (Equations::new(), 0.0);
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
                    equations.add(&terms, weight, value.truncate());
                    squared_weights += weight * weight;
                }
            }
            column += 1;
        }
        row += 1;
    }
    let (mut matrix, mut sums) = (equations.matrix(), equations.sums());
    let weights = equations.weights;
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
                    let first = at(planes, pixels + there);
                    let slope = first.w;
                    let value = constant
                        + first * terms.place.x
                        + at(planes, 2 * pixels + there) * terms.place.y
                        + at(planes, 3 * pixels + there) * terms.place.z
                        + at(planes, 4 * pixels + there) * terms.albedo.x
                        + at(planes, 5 * pixels + there) * terms.albedo.y
                        + at(planes, 6 * pixels + there) * terms.albedo.z
                        + at(planes, 7 * pixels + there) * terms.normal.x
                        + at(planes, 8 * pixels + there) * terms.normal.y
                        + at(planes, 9 * pixels + there) * terms.normal.z;
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
