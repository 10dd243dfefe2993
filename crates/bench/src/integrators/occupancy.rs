//! How many lanes have a path, over iterations of a segment each.
//!
//! Integrators whose paths advance in step count them as they go. For the two others they follow
//! from the lengths of the stream's paths, as if all segments took the same time:
//!
//! - `megakernel`: a group of [`GROUP`] lanes that run in step is held until its longest path has
//!   ended;
//! - `regeneration`: as many lanes as can be resident begin, and a lane whose path has ended takes
//!   the next slot.

use raystream_shaders::film::Contribution;
use raystream_shaders::film::stream::{NO_PIXEL, Slot};

/// Lanes that run in step: 32 on most GPUs.
pub const GROUP: usize = 32;

/// The lanes of one iteration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lanes {
    /// Those that have a path.
    pub active: u64,
    /// Those that are occupied: they have a path, or wait for others of their group.
    pub held: u64,
}

/// Segments of each slot's path: the rays of a render that samples no lights.
pub fn lengths(slots: &[Slot], without_shadow_rays: &[Contribution]) -> Vec<u32> {
    let length = |(slot, c): (&Slot, &Contribution)| if slot.rank == NO_PIXEL { 0 } else { c.rays };
    slots.iter().zip(without_shadow_rays).map(length).collect()
}

/// A stream of paths of these lengths in the megakernel, all at once.
pub fn megakernel(lengths: &[u32]) -> Vec<Lanes> {
    let longest = lengths.iter().copied().max().unwrap_or_default();
    // Changes first, then sums from the end: how many last until each iteration.
    let mut lanes = vec![Lanes { active: 0, held: 0 }; longest as usize];
    for group in lengths.chunks(GROUP) {
        for &length in group.iter().filter(|&&length| length > 0) {
            lanes[length as usize - 1].active += 1;
        }
        let held = group.iter().copied().max().unwrap_or_default();
        if held > 0 {
            lanes[held as usize - 1].held += group.len() as u64;
        }
    }
    for iteration in (1..lanes.len()).rev() {
        let later = lanes[iteration];
        lanes[iteration - 1].active += later.active;
        lanes[iteration - 1].held += later.held;
    }
    lanes
}

/// The same in `resident` lanes that take slot after slot.
pub fn regeneration(lengths: &[u32], resident: usize) -> Vec<Lanes> {
    let longest = lengths.iter().copied().max().unwrap_or_default() as usize;
    // Lanes whose path ends before the iteration of this number, counted around a ring.
    let mut ends = vec![0_u64; longest + 1];
    let mut next = lengths.iter().copied().filter(|&length| length > 0);
    let mut free = resident as u64;
    let mut active = 0;
    let mut iterations = Vec::new();
    for iteration in 0.. {
        let ended = std::mem::take(&mut ends[iteration % (longest + 1)]);
        active -= ended;
        free += ended;
        for length in next.by_ref().take(free as usize) {
            ends[(iteration + length as usize) % (longest + 1)] += 1;
            active += 1;
            free -= 1;
        }
        if active == 0 {
            break;
        }
        iterations.push(Lanes { active, held: active });
    }
    iterations
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_group_is_held_by_its_longest_path() {
        let mut lengths = vec![1; GROUP];
        lengths[7] = 3;
        // Another group, cut off by the end of the stream, with an empty slot.
        lengths.extend([2, 2, 0]);
        let lanes = |active, held| Lanes { active, held };
        assert_eq!(megakernel(&lengths), [lanes(34, 35), lanes(3, 35), lanes(1, 32)]);
        assert!(megakernel(&[]).is_empty() && megakernel(&[0, 0]).is_empty());
    }

    #[test]
    fn lanes_take_slot_after_slot() {
        let active = |lengths: &[u32], resident| -> Vec<u64> {
            regeneration(lengths, resident).into_iter().map(|lanes| lanes.active).collect()
        };
        // Lane 0: 3, then 2; lane 1: 1, 1, 1, 4.
        assert_eq!(active(&[3, 1, 1, 0, 1, 2, 4], 2), [2, 2, 2, 2, 2, 1, 1]);
        assert_eq!(active(&[3, 1, 2], 8), [3, 2, 1]);
        assert!(active(&[], 8).is_empty());
        // No segment is lost.
        let lengths: Vec<u32> =
            (0..1000).map(|k| raystream_shaders::math::random::hash(k) % 9).collect();
        assert_eq!(
            active(&lengths, 60).iter().sum::<u64>(),
            lengths.iter().map(|&l| u64::from(l)).sum::<u64>()
        );
    }
}
