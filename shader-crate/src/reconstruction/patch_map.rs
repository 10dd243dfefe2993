//! Distances of patches, kept in memory for who asks for them more than once.
//!
//! For each pixel and each offset of a window of [`WINDOW`] pixels to each side there are 8 bits:
//! 228 bytes a pixel. They hold the root of the distance, since small distances must be known more
//! finely than large ones: a step changes a weight `exp(-d)` of one half by 2 %.

use super::patches::{
    DISTANCES, PatchParams, SUMS, measure_distances, patch_distance, place_in_tile, sum_rows,
};
use crate::glam::Vec4;
use crate::math::elementary::exp;
use crate::memory::access::{Scatter, at};
use crate::parallel::prefix::Lane;
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

/// Pixels to each side of the window.
pub const WINDOW: u32 = 7;
const SIDE: u32 = 2 * WINDOW + 1;
const OFFSETS: u32 = SIDE * SIDE;
/// Words of a pixel.
pub const WORDS: u32 = OFFSETS.div_ceil(PER_WORD);
const PER_WORD: u32 = 4;
/// Offsets that lanes take at once.
const AT_ONCE: u32 = 2 * PER_WORD;
const TURNS: u32 = OFFSETS.div_ceil(AT_ONCE);
/// Two for each turn, and one to write what the last has found.
pub const PHASES: u32 = 2 * TURNS + 1;
/// The memory of a workgroup, bits of f32: distances and sums along rows.
pub type Memory = [u32; (AT_ONCE * (DISTANCES + SUMS)) as usize];

/// The largest number of 8 bits: so far apart that the weight is none.
const FARTHEST: u32 = 255;
/// Steps of the root of a distance; the largest one is 3.04, whose weight is 1e-4.
const STEPS: f32 = 84.0;

/// Kernel, in phases: the distances of the patches of a half, in rows, to those of all neighbours
/// in the window, which is [`WINDOW`]. The word `w` of a pixel lies `w` pictures behind its first.
pub fn measure_patches(
    phase: u32,
    lane: Lane,
    params: &PatchParams,
    weighers: &[Vec4],
    map: &mut Scatter<'_, u32>,
    memory: &mut Memory,
) {
    let (left, top) = params.tile(lane);
    let is_inside = params.contains(left, top);
    let turn = phase / 2;
    if phase & 1 == 0 {
        let (x, y) = place_in_tile(lane.index);
        let (x, y) = (left + x, top + y);
        if params.contains(x, y) && turn > 0 {
            let pixels = params.width * params.height;
            let place = params.place_near(x, y);
            let mut half = 0;
            while half < 2 {
                let word = 2 * (turn - 1) + half;
                if word < WORDS {
                    let packed = pack(params, lane.index, half * PER_WORD, memory);
                    map.set(word * pixels + place, packed);
                }
                half += 1;
            }
        }
        if is_inside && turn < TURNS {
            let first = turn * AT_ONCE;
            let tile = (left, top);
            measure_distances::<AT_ONCE, _>(params, lane.index, tile, first, weighers, memory);
        }
    } else if is_inside {
        sum_rows::<AT_ONCE, _>(params, lane.index, memory);
    }
}

fn pack(params: &PatchParams, index: u32, first: u32, memory: &Memory) -> u32 {
    let (mut word, mut k) = (0, 0);
    while k < PER_WORD {
        let distance = patch_distance::<AT_ONCE, _>(params, index, first + k, memory);
        let steps = (distance.sqrt() * STEPS + 0.5).min(FARTHEST as f32) as u32;
        word |= steps << (8 * k);
        k += 1;
    }
    word
}

/// How alike the patch about the pixel at a place in rows and that about its neighbour at an offset
/// are, from 0 to 1: `exp(-sharpness d)` of their distance. The offset is within [`WINDOW`].
pub fn weight(map: &[u32], pixels: u32, place: u32, dx: i32, dy: i32, sharpness: f32) -> f32 {
    let reach = WINDOW as i32;
    let offset = ((dy + reach) * SIDE as i32 + dx + reach) as u32;
    let word = at(map, offset / PER_WORD * pixels + place);
    let steps = word >> (8 * (offset % PER_WORD)) & 0xff;
    let root = steps as f32 * (1.0 / STEPS);
    if steps < FARTHEST { exp(-sharpness * root * root) } else { 0.0 }
}
