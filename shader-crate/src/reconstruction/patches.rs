//! How alike the patches about pixels are: what non-local filters weigh neighbours by (Rousselle et
//! al., "Adaptive Rendering with Non-Local Means Filtering", 2012).
//!
//! Two pixels are alike where the patches about them are: where squared differences, on average
//! over a patch, are no larger than the variances explain.
//!
//! The lanes of a workgroup share a tile of the picture. For each offset of the window they compute
//! the distances of all pixels of the tile and its border to those at the offset, sum these along
//! rows, and then each lane along its column: a patch of 7x7 pixels costs 14 additions and not 49.
//! They take several offsets at once, since lanes wait at every barrier.

use super::PictureParams;
use crate::estimator::guide::mean_of_squares;
use crate::glam::Vec4;
use crate::memory::access::{Scatter, at, local, local_mut};
use crate::memory::device_struct;
use crate::parallel::prefix::Lane;

/// Lanes of a workgroup, one for each pixel of its tile.
pub const LANES: u32 = TILE_WIDTH * TILE_HEIGHT;
/// Pixels of a workgroup's tile along x.
pub const TILE_WIDTH: u32 = 8;
/// Pixels of a workgroup's tile along y.
pub const TILE_HEIGHT: u32 = 16;
/// Pixels to each side that a patch has at most.
pub const LARGEST_PATCH: u32 = 3;

/// Distances are of a tile and a border as wide as a patch needs.
const BORDERED_WIDTH: u32 = TILE_WIDTH + 2 * LARGEST_PATCH;
const BORDERED_HEIGHT: u32 = TILE_HEIGHT + 2 * LARGEST_PATCH;
/// Distances at an offset.
pub const DISTANCES: u32 = BORDERED_WIDTH * BORDERED_HEIGHT;
/// Sums of these along rows.
pub const SUMS: u32 = TILE_WIDTH * BORDERED_HEIGHT;

/// Differences within this many roundings count as none.
const RELATIVE_FLOOR: f32 = 1e-6;
/// The floor of a mean of squares, per sum of the squares of three components.
const MEAN_FLOOR: f32 = RELATIVE_FLOOR * RELATIVE_FLOOR * (1.0 / 3.0);

device_struct! {
    /// The parameters of kernels that compare patches. 48 bytes.
    pub struct PatchParams {
        /// Lanes: [`LANES`] for each tile.
        pub threads: u32,
        /// Picture width in pixels.
        pub width: u32,
        /// Picture height in pixels.
        pub height: u32,
        /// Deviations that differences are measured by, squared: the smaller, the fewer pixels are
        /// alike. Above 0.
        pub strength: f32,
        /// How many variances are taken off squared differences.
        pub explained: f32,
        /// Pixels to each side of a patch, at most [`LARGEST_PATCH`].
        pub patch: u32,
        /// Pixels to each side that the filter sees.
        pub window: u32,
        /// Tiles of a row of the launch, as a power of two: at least those that a row of the
        /// picture has. A division by a number that is not known beforehand would be checked, and a
        /// lane that may end there must not meet a barrier.
        pub row_shift: u32,
        /// As `strength`, for [features](super::features); above 0 where a kernel looks at them.
        pub feature_strength: f32,
        /// The least squared difference of features that `feature_strength` is applied to.
        pub feature_floor: f32,
        /// Unused; zero.
        pub pad0: u32,
        /// Unused; zero.
        pub pad1: u32,
    }
}

impl PatchParams {
    /// For a picture of a size, without features; see [`Self::strength`] and the fields after it.
    pub fn new(
        (width, height): (u32, u32),
        strength: f32,
        explained: f32,
        patch: u32,
        window: u32,
    ) -> Self {
        let row_shift = width.div_ceil(TILE_WIDTH).next_power_of_two().trailing_zeros();
        let threads = (height.div_ceil(TILE_HEIGHT) << row_shift) * LANES;
        Self {
            threads,
            width,
            height,
            strength,
            explained,
            patch,
            window,
            row_shift,
            feature_strength: 1.0,
            feature_floor: 1.0,
            pad0: 0,
            pad1: 0,
        }
    }

    /// The place in rows of the pixel nearest to a place, which may be outside the picture.
    pub fn place_near(&self, x: i32, y: i32) -> u32 {
        place_near(self.width, self.height, x, y)
    }

    /// Whether a place is in the picture.
    pub fn contains(&self, x: i32, y: i32) -> bool {
        x >= 0 && y >= 0 && x < self.width as i32 && y < self.height as i32
    }

    /// Left and top of a workgroup's tile.
    pub fn tile(&self, lane: Lane) -> (i32, i32) {
        let column = lane.group & ((1 << self.row_shift) - 1);
        let row = lane.group >> self.row_shift;
        ((column * TILE_WIDTH) as i32, (row * TILE_HEIGHT) as i32)
    }

    /// Offsets of the window.
    pub fn offsets(&self) -> u32 {
        let side = 2 * self.window + 1;
        side * side
    }

    /// How far an offset is along x and y. The quotient is taken in floats, see
    /// [`Self::row_shift`]; with a half it is never near a whole number.
    pub fn step(&self, offset: u32) -> (i32, i32) {
        let side = 2 * self.window + 1;
        let row = ((offset as f32 + 0.5) / side as f32) as u32;
        let reach = self.window as i32;
        ((offset - row * side) as i32 - reach, row as i32 - reach)
    }
}

/// The pixel of a picture of a size that is nearest to a place, which may be outside: its place in
/// rows.
pub fn place_near(width: u32, height: u32, x: i32, y: i32) -> u32 {
    let column = x.max(0).min(width as i32 - 1) as u32;
    let row = y.max(0).min(height as i32 - 1) as u32;
    row * width + column
}

/// Where a lane's pixel lies in its tile.
pub fn place_in_tile(index: u32) -> (i32, i32) {
    ((index % TILE_WIDTH) as i32, (index / TILE_WIDTH) as i32)
}

/// Kernel: a half from rank order into rows, where neighbours are found faster.
pub fn half_in_rows(
    lane: u32,
    params: &PictureParams,
    half: &[Vec4],
    rows: &mut Scatter<'_, Vec4>,
) {
    rows.set(params.row_index(lane), at(half, lane));
}

/// How far two pixels of a half differ beyond what their variances explain, over these: below 0
/// where they are closer to each other than noise is on average.
fn distance(strength: f32, explained: f32, a: Vec4, b: Vec4) -> f32 {
    let (a_color, b_color) = (a.truncate(), b.truncate());
    let difference = mean_of_squares(a_color - b_color);
    let floor =
        MEAN_FLOOR * (a_color.length_squared() + b_color.length_squared()) + f32::MIN_POSITIVE;
    let noise = a.w + b.w;
    let excess = difference - explained * (a.w + a.w.min(b.w));
    if a.w < 0.0 || b.w < 0.0 { 0.0 } else { excess / (strength * noise + floor) }
}

/// Distances of the tile's pixels and its border's to those at the `AT_ONCE` offsets from `first`
/// on. Outside the picture they are those of the nearest pixels in it. They lie at the beginning of
/// the memory.
pub fn measure_distances<const AT_ONCE: u32, const N: usize>(
    params: &PatchParams,
    index: u32,
    (left, top): (i32, i32),
    first: u32,
    weighers: &[Vec4],
    memory: &mut [u32; N],
) {
    let border = LARGEST_PATCH as i32;
    let mut place = index;
    while place < DISTANCES {
        let x = left + (place % BORDERED_WIDTH) as i32 - border;
        let y = top + (place / BORDERED_WIDTH) as i32 - border;
        let here = at(weighers, params.place_near(x, y));
        let mut k = 0;
        while k < AT_ONCE {
            let (dx, dy) = params.step(first + k);
            let there = at(weighers, params.place_near(x + dx, y + dy));
            *local_mut(memory, k * DISTANCES + place) =
                distance(params.strength, params.explained, here, there).to_bits();
            k += 1;
        }
        place += LANES;
    }
}

/// Sums of distances along rows of a patch, which lie behind the distances.
pub fn sum_rows<const AT_ONCE: u32, const N: usize>(
    params: &PatchParams,
    index: u32,
    memory: &mut [u32; N],
) {
    let (skipped, side) = (LARGEST_PATCH - params.patch, 2 * params.patch + 1);
    let mut place = index;
    while place < AT_ONCE * SUMS {
        let (offset, place_in) = (place / SUMS, place % SUMS);
        let first = offset * DISTANCES
            + place_in / TILE_WIDTH * BORDERED_WIDTH
            + place_in % TILE_WIDTH
            + skipped;
        let (mut sum, mut k) = (0.0, 0);
        while k < side {
            sum += f32::from_bits(local(memory, first + k));
            k += 1;
        }
        *local_mut(memory, AT_ONCE * DISTANCES + place) = sum.to_bits();
        place += LANES;
    }
}

/// The mean distance over the patch of lane `index` at the offset `k` of those at once, at least 0.
pub fn patch_distance<const AT_ONCE: u32, const N: usize>(
    params: &PatchParams,
    index: u32,
    k: u32,
    memory: &[u32; N],
) -> f32 {
    let (skipped, side) = (LARGEST_PATCH - params.patch, 2 * params.patch + 1);
    let first = AT_ONCE * DISTANCES + k * SUMS + index + skipped * TILE_WIDTH;
    let (mut sum, mut row) = (0.0, 0);
    while row < side {
        sum += f32::from_bits(local(memory, first + row * TILE_WIDTH));
        row += 1;
    }
    (sum / (side * side) as f32).max(0.0)
}
