//! The filter `nlm`: non-local means, each half by weights of the other (Rousselle et al.,
//! "Adaptive Rendering with Non-Local Means Filtering", 2012).
//!
//! What one half takes for [alike](super::patches) weighs the pixels of the other, so that no
//! weight depends on the noise that it is applied to. Filters that know more of two pixels than
//! their colours ask for it by `Unlikeness`.

use super::PictureParams;
use super::features::{Features, unlikeness};
use super::halves::share_of_first;
use super::patches::{
    DISTANCES, LANES, PatchParams, SUMS, measure_distances, patch_distance, place_in_tile, sum_rows,
};
use crate::estimator::filtered::FilteredPixel;
use crate::estimator::guide::Guide;
use crate::film::tiles::rank_of_pixel;
use crate::glam::{Vec3, Vec4};
use crate::math::elementary::exp;
use crate::memory::access::{Scatter, at, local, local_mut};
use crate::parallel::prefix::Lane;

/// Pixels to each side that the filter sees at most.
pub const LARGEST_WINDOW: u32 = 10;
const LARGEST_SIDE: u32 = 2 * LARGEST_WINDOW + 1;
/// Offsets that lanes take at once: as many as their memory, of 16 KiB at most, has room for.
const AT_ONCE: u32 = 7;
/// Two for each time that lanes do so, and one to add up the last and divide.
pub const PHASES: u32 = 2 * (LARGEST_SIDE * LARGEST_SIDE).div_ceil(AT_ONCE) + 1;
/// Where the lanes' sums of weighted colours and of weights begin.
const TOTALS: u32 = AT_ONCE * (DISTANCES + SUMS);

/// The memory of a workgroup, bits of f32: distances, sums along rows, four totals for each lane.
pub type Memory = [u32; (TOTALS + 4 * LANES) as usize];

/// What two pixels are apart in beside their patches. It is of buffers, and owns none: no type of a
/// kernel may hold a pointer.
trait Unlikeness {
    /// What is known of each pixel, in rows.
    type Known: Copy;

    /// The negative logarithm of the largest weight that the pixel at a place in rows may have
    /// about another.
    fn exponent(params: &PatchParams, known: &[Self::Known], here: u32, there: u32) -> f32;
}

/// Of pixels of which nothing is known; their values are what is given for it.
struct Nothing;

impl Unlikeness for Nothing {
    type Known = Vec4;

    fn exponent(_: &PatchParams, _: &[Vec4], _: u32, _: u32) -> f32 {
        0.0
    }
}

/// Of features.
struct ByFeatures;

impl Unlikeness for ByFeatures {
    type Known = Features;

    fn exponent(params: &PatchParams, known: &[Features], here: u32, there: u32) -> f32 {
        unlikeness(known, here, there, params.feature_strength, params.feature_floor)
    }
}

/// Kernel, in phases: one half, `values`, filtered by the weights of the other, `weighers`, both in
/// rows. The result is in rank order: the colour, and the part that the pixel's own has in it. What
/// is not measured stays as it is, with a part of 1. The window has at most [`LARGEST_WINDOW`].
pub fn filter_half(
    phase: u32,
    lane: Lane,
    params: &PatchParams,
    weighers: &[Vec4],
    values: &[Vec4],
    filtered: &mut Scatter<'_, Vec4>,
    memory: &mut Memory,
) {
    step::<Nothing>(phase, lane, params, values, weighers, values, filtered, memory);
}

/// Kernel, in phases: the same, where neighbours count for no more than their features, in rows,
/// let them; the filter [`features`](super::features).
pub fn filter_half_by_features(
    phase: u32,
    lane: Lane,
    params: &PatchParams,
    features: &[Features],
    weighers: &[Vec4],
    values: &[Vec4],
    filtered: &mut Scatter<'_, Vec4>,
    memory: &mut Memory,
) {
    step::<ByFeatures>(phase, lane, params, features, weighers, values, filtered, memory);
}

/// A phase of the kernels.
#[inline(always)]
fn step<U: Unlikeness>(
    phase: u32,
    lane: Lane,
    params: &PatchParams,
    known: &[U::Known],
    weighers: &[Vec4],
    values: &[Vec4],
    filtered: &mut Scatter<'_, Vec4>,
    memory: &mut Memory,
) {
    let (left, top) = params.tile(lane);
    let is_inside = params.contains(left, top);
    let turns = params.offsets().div_ceil(AT_ONCE);
    let turn = phase / 2;
    if phase & 1 == 0 {
        let (x, y) = place_in_tile(lane.index);
        let (x, y) = (left + x, top + y);
        if params.contains(x, y) && turn <= turns {
            if phase > 0 {
                let first = (turn - 1) * AT_ONCE;
                add_neighbours::<U>(params, known, lane.index, (x, y), first, values, memory);
            } else {
                clear_totals(lane.index, memory);
            }
            if turn == turns {
                let rank = rank_of_pixel(x as u32, y as u32, params.width, params.height);
                let value = at(values, params.place_near(x, y));
                filtered.set(rank, mean_of(lane.index, value, memory));
            }
        }
        if is_inside && turn < turns {
            let first = turn * AT_ONCE;
            measure_distances::<AT_ONCE, _>(
                params,
                lane.index,
                (left, top),
                first,
                weighers,
                memory,
            );
        }
    } else if is_inside && turn < turns {
        sum_rows::<AT_ONCE, _>(params, lane.index, memory);
    }
}

/// Adds the pixels at the offsets from `first` on, weighed by how alike they are.
#[inline(always)]
fn add_neighbours<U: Unlikeness>(
    params: &PatchParams,
    known: &[U::Known],
    index: u32,
    (x, y): (i32, i32),
    first: u32,
    values: &[Vec4],
    memory: &mut Memory,
) {
    let here = params.place_near(x, y);
    let (mut color, mut weights) = (Vec3::ZERO, 0.0);
    let mut k = 0;
    while k < AT_ONCE {
        let (dx, dy) = params.step(first + k);
        let there = params.place_near(x + dx, y + dy);
        let value = at(values, there);
        // Behind the last row of the window the last turn has nothing to add.
        if first + k < params.offsets() && params.contains(x + dx, y + dy) && value.w >= 0.0 {
            let apart = patch_distance::<AT_ONCE, _>(params, index, k, memory);
            let weight = exp(-apart.max(U::exponent(params, known, here, there)));
            color += value.truncate() * weight;
            weights += weight;
        }
        k += 1;
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
