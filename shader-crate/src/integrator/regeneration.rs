//! The integrator `regeneration`: a fixed number of threads, each of which takes the next slot of
//! the stream as soon as its path has ended.
//!
//! Novak, Havran, Dachsbacher, "Path Regeneration for Interactive Path Tracing", Eurographics 2010.
//! A group of lanes that run in step goes on to the next segment together, some of its lanes in the
//! midst of a path, some at the first segment of a new one; none waits for the longest path of the
//! group, as in [`trace_paths`](crate::integrator::megakernel::trace_paths).

use crate::film::Contribution;
use crate::film::stream::{NO_PIXEL, Slot};
use crate::integrator::params::PathParams;
use crate::integrator::path::Path;
use crate::memory::access::{Atomics, Scatter, at};
use crate::scene::SceneView;
use crate::scene::abilities::Abilities;

/// A thread takes no more slots once it has traced this many segments; then another one starts.
/// Enough for a GPU's resident threads to share a long stream, and few enough for drivers that end
/// a thread's loops after some number of turns (Mesa's llvmpipe: 65535).
pub const SEGMENTS: u32 = 128;

/// Kernel: traces the paths of the slots that this lane is the first to take, until there are none
/// left or it has traced [`SEGMENTS`] segments. The first of `taken` counts those that have been
/// taken; 0 at first.
pub fn regenerate_paths(
    _: u32,
    params: &PathParams,
    scene: &SceneView<'_, impl Abilities>,
    slots: &[Slot],
    contributions: &mut Scatter<'_, Contribution>,
    taken: &mut Atomics<'_>,
) {
    // Overwritten before it is used: the lane has no path yet.
    let (mut number, nobody) = (0, Slot { rank: 0, sample: 0 });
    let mut numbers = params.numbers(nobody);
    let mut path = Path::begin(params, scene, nobody, &numbers);
    let mut is_under_way = false;
    let mut segments = 0;
    // One loop over segments, not one over paths around one over segments: lanes in step meet at
    // the next segment, whichever path it is of.
    loop {
        if !is_under_way {
            if segments >= SEGMENTS {
                return;
            }
            number = taken.add(0, 1);
            if number >= slots.len() as u32 {
                return;
            }
            let slot = at(slots, number);
            if slot.rank != NO_PIXEL {
                numbers = params.numbers(slot);
                path = Path::begin(params, scene, slot, &numbers);
                is_under_way = true;
            } else {
                contributions.set(number, Contribution::NOTHING);
            }
        }
        segments += 1;
        if is_under_way && !path.extend(params, scene, &numbers) {
            contributions.set(number, path.contribution());
            is_under_way = false;
        }
    }
}
