//! The filter `nlm`: non-local means, each half by weights of the other (Rousselle et al.,
//! "Adaptive Rendering with Non-Local Means Filtering", 2012).
//!
//! Two pixels are alike where the patches about them are: where squared differences, on average
//! over a patch of 7x7 pixels, are no larger than the variances explain. What one half takes for
//! alike weighs the pixels of the other, so that no weight depends on the noise that it is applied
//! to.
//!
//! The lanes of a workgroup share a tile of the picture. For each offset of the window they compute
//! the distances of all pixels of the tile and its border to those at the offset, sum these along
//! rows, and then each lane along its column: a patch costs 14 additions and not 49. They take
//! several offsets at once, since lanes wait at every barrier.

use super::PictureParams;
use super::halves::share_of_first;
use crate::estimator::filtered::FilteredPixel;
use crate::estimator::guide::{Guide, mean_of_squares};
use crate::film::tiles::rank_of_pixel;
use crate::glam::{Vec3, Vec4};
use crate::memory::access::{Scatter, at, local, local_mut};
use crate::memory::device_struct;
use crate::parallel::prefix::Lane;
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

/// Lanes of a workgroup, one for each pixel of its tile.
pub const LANES: u32 = TILE_WIDTH * TILE_HEIGHT;
/// Pixels of a workgroup's tile along x.
pub const TILE_WIDTH: u32 = 8;
/// Pixels of a workgroup's tile along y.
pub const TILE_HEIGHT: u32 = 16;
/// Pixels to each side that the filter sees.
pub const WINDOW: u32 = 10;
/// Pixels to each side that a patch has.
pub const PATCH: u32 = 3;

const SIDE: u32 = 2 * WINDOW + 1;
/// Offsets of the window.
const OFFSETS: u32 = SIDE * SIDE;
/// Offsets that lanes take at once: as many as their memory, of 16 KiB at most, has room for.
const AT_ONCE: u32 = 7;
/// Times that lanes do so.
const TURNS: u32 = OFFSETS.div_ceil(AT_ONCE);
/// Two for each turn, and one to add up the last and divide.
pub const PHASES: u32 = 2 * TURNS + 1;

/// Distances are of a tile and a border as wide as a patch needs.
const BORDERED_WIDTH: u32 = TILE_WIDTH + 2 * PATCH;
const BORDERED_HEIGHT: u32 = TILE_HEIGHT + 2 * PATCH;
/// Distances at an offset, and sums of these along rows.
const DISTANCES: u32 = BORDERED_WIDTH * BORDERED_HEIGHT;
const SUMS: u32 = TILE_WIDTH * BORDERED_HEIGHT;
/// Where the sums along rows begin, and the lanes' sums of weighted colours and of weights.
const ROW_SUMS: u32 = AT_ONCE * DISTANCES;
const TOTALS: u32 = ROW_SUMS + AT_ONCE * SUMS;

/// The memory of a workgroup, bits of f32: distances, sums along rows, four totals for each lane.
pub type Memory = [u32; (TOTALS + 4 * LANES) as usize];

/// Pixels of a patch.
const AREA: f32 = ((2 * PATCH + 1) * (2 * PATCH + 1)) as f32;
/// Differences within this many roundings count as none.
const RELATIVE_FLOOR: f32 = 1e-6;

device_struct! {
    /// The parameters of [`filter_half`]. 32 bytes.
    pub struct NlmParams {
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
        /// Tiles of a row of the launch, as a power of two: at least those that a row of the
        /// picture has. A division by a number that is not known beforehand would be checked, and a
        /// lane that may end there must not meet a barrier.
        pub row_shift: u32,
        /// Unused; zero.
        pub pad0: u32,
        /// Unused; zero.
        pub pad1: u32,
    }
}

impl NlmParams {
    /// For a picture of a size, see [`Self::strength`] and [`Self::explained`].
    pub fn new(width: u32, height: u32, strength: f32, explained: f32) -> Self {
        let row_shift = width.div_ceil(TILE_WIDTH).next_power_of_two().trailing_zeros();
        let threads = (height.div_ceil(TILE_HEIGHT) << row_shift) * LANES;
        Self { threads, width, height, strength, explained, row_shift, pad0: 0, pad1: 0 }
    }

    /// The pixel nearest to a place, which may be outside the picture: its place in rows.
    fn place_near(&self, x: i32, y: i32) -> u32 {
        place_near(self.width, self.height, x, y)
    }

    fn contains(&self, x: i32, y: i32) -> bool {
        x >= 0 && y >= 0 && x < self.width as i32 && y < self.height as i32
    }
}

/// The pixel of a picture of a size that is nearest to a place, which may be outside: its place in
/// rows.
pub fn place_near(width: u32, height: u32, x: i32, y: i32) -> u32 {
    let column = x.max(0).min(width as i32 - 1) as u32;
    let row = y.max(0).min(height as i32 - 1) as u32;
    row * width + column
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
pub fn distance(strength: f32, explained: f32, a: Vec4, b: Vec4) -> f32 {
    let (a_color, b_color) = (a.truncate(), b.truncate());
    let difference = mean_of_squares(a_color - b_color);
    let floor =
        RELATIVE_FLOOR * RELATIVE_FLOOR * (mean_of_squares(a_color) + mean_of_squares(b_color))
            + f32::MIN_POSITIVE;
    let noise = a.w + b.w;
    let excess = difference - explained * (a.w + a.w.min(b.w));
    if a.w < 0.0 || b.w < 0.0 { 0.0 } else { excess / (strength * noise + floor) }
}

/// Kernel, in phases: one half, `values`, filtered by the weights of the other, `weighers`, both in
/// rows. The result is in rank order: the colour, and the part that the pixel's own has in it. What
/// is not measured stays as it is, with a part of 1.
pub fn filter_half(
    phase: u32,
    lane: Lane,
    params: &NlmParams,
    weighers: &[Vec4],
    values: &[Vec4],
    filtered: &mut Scatter<'_, Vec4>,
    memory: &mut Memory,
) {
    let left = ((lane.group & ((1 << params.row_shift) - 1)) * TILE_WIDTH) as i32;
    let top = ((lane.group >> params.row_shift) * TILE_HEIGHT) as i32;
    let is_inside = params.contains(left, top);
    let turn = phase / 2;
    if phase & 1 == 0 {
        let x = left + (lane.index % TILE_WIDTH) as i32;
        let y = top + (lane.index / TILE_WIDTH) as i32;
        if params.contains(x, y) {
            if phase > 0 {
                add_neighbours(params, lane.index, x, y, (turn - 1) * AT_ONCE, values, memory);
            } else {
                clear_totals(lane.index, memory);
            }
            if turn == TURNS {
                let rank = rank_of_pixel(x as u32, y as u32, params.width, params.height);
                let value = at(values, params.place_near(x, y));
                filtered.set(rank, mean_of(lane.index, value, memory));
            }
        }
        if is_inside && turn < TURNS {
            measure_distances(params, lane.index, left, top, turn * AT_ONCE, weighers, memory);
        }
    } else if is_inside {
        sum_rows(lane.index, memory);
    }
}

/// How far an offset is along x and y.
fn step(offset: u32) -> (i32, i32) {
    ((offset % SIDE) as i32 - WINDOW as i32, (offset / SIDE) as i32 - WINDOW as i32)
}

/// Distances of the tile's pixels and its border's to those at the offsets from `first` on. Outside
/// the picture they are those of the nearest pixels in it.
fn measure_distances(
    params: &NlmParams,
    index: u32,
    left: i32,
    top: i32,
    first: u32,
    weighers: &[Vec4],
    memory: &mut Memory,
) {
    let mut place = index;
    while place < DISTANCES {
        let x = left + (place % BORDERED_WIDTH) as i32 - PATCH as i32;
        let y = top + (place / BORDERED_WIDTH) as i32 - PATCH as i32;
        let here = at(weighers, params.place_near(x, y));
        let mut k = 0;
        while k < AT_ONCE {
            let (dx, dy) = step(first + k);
            let there = at(weighers, params.place_near(x + dx, y + dy));
            *local_mut(memory, k * DISTANCES + place) =
                distance(params.strength, params.explained, here, there).to_bits();
            k += 1;
        }
        place += LANES;
    }
}

/// Sums of distances along rows of a patch.
fn sum_rows(index: u32, memory: &mut Memory) {
    let mut place = index;
    while place < AT_ONCE * SUMS {
        let (offset, place_in) = (place / SUMS, place % SUMS);
        let first =
            offset * DISTANCES + place_in / TILE_WIDTH * BORDERED_WIDTH + place_in % TILE_WIDTH;
        let (mut sum, mut k) = (0.0, 0);
        while k < 2 * PATCH + 1 {
            sum += f32::from_bits(local(memory, first + k));
            k += 1;
        }
        *local_mut(memory, ROW_SUMS + place) = sum.to_bits();
        place += LANES;
    }
}

/// Adds the pixels at the offsets from `first` on, weighed by how alike the patches are.
fn add_neighbours(
    params: &NlmParams,
    index: u32,
    x: i32,
    y: i32,
    first: u32,
    values: &[Vec4],
    memory: &mut Memory,
) {
    let (mut color, mut weights) = (Vec3::ZERO, 0.0);
    let mut offset = 0;
    while offset < AT_ONCE {
        let (dx, dy) = step(first + offset);
        let value = at(values, params.place_near(x + dx, y + dy));
        // Behind the last row of the window the last turn has nothing to add.
        if first + offset < OFFSETS && params.contains(x + dx, y + dy) && value.w >= 0.0 {
            let (mut sum, mut k) = (0.0, 0);
            while k < 2 * PATCH + 1 {
                let place = ROW_SUMS + offset * SUMS + index + k * TILE_WIDTH;
                sum += f32::from_bits(local(memory, place));
                k += 1;
            }
            let weight = (-(sum / AREA).max(0.0)).exp();
            color += value.truncate() * weight;
            weights += weight;
        }
        offset += 1;
    }
    let totals = TOTALS + index;
    add(memory, totals, color.x);
    add(memory, totals + LANES, color.y);
    add(memory, totals + 2 * LANES, color.z);
    add(memory, totals + 3 * LANES, weights);
}

fn add(memory: &mut Memory, place: u32, value: f32) {
    let total = local_mut(memory, place);
    *total = (f32::from_bits(*total) + value).to_bits();
}

fn clear_totals(index: u32, memory: &mut Memory) {
    let mut component = 0;
    while component < 4 {
        *local_mut(memory, TOTALS + component * LANES + index) = 0;
        component += 1;
    }
}

/// The mean of all that was added, if there was anything; the pixel's own weight is 1.
fn mean_of(index: u32, value: Vec4, memory: &Memory) -> Vec4 {
    let total = |component: u32| f32::from_bits(local(memory, TOTALS + component * LANES + index));
    let weights = total(3);
    if value.w >= 0.0 && weights > 0.0 {
        (Vec3::new(total(0), total(1), total(2)) / weights).extend(1.0 / weights)
    } else {
        value.truncate().extend(1.0)
    }
}

/// Kernel: puts the filtered halves of pixel `lane` together, as its mean is put together of the
/// measured ones.
pub fn join_halves(
    lane: u32,
    _: &PictureParams,
    guides: &[Guide],
    first: &[Vec4],
    filtered_first: &[Vec4],
    filtered_second: &[Vec4],
    filtered: &mut FilteredPixel,
) {
    let share = share_of_first(&at(guides, lane), at(first, lane));
    let joined = at(filtered_first, lane) * share + at(filtered_second, lane) * (1.0 - share);
    *filtered = FilteredPixel { color: joined.truncate(), own: joined.w };
}
