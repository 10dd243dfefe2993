//! Stream compaction: the places of what is to be kept, close together and in order.
//!
//! Reduce ([`sum_blocks`](crate::parallel::prefix::sum_blocks) over the flags), scan
//! ([`scan_blocks`](crate::parallel::prefix::scan_blocks)), scatter ([`scatter_kept`]): Billeter,
//! Olsson, Assarsson, "Efficient Stream Compaction on Wide SIMD Many-Core Architectures", HPG 2009.

use crate::memory::access::{Scatter, at, local_mut};
use crate::parallel::prefix::{
    BlockParams, Lane, Memory, PER_LANE, sum_before, sum_groups, sum_values,
};

/// Kernel, in phases: writes the indices of all elements whose flag in `keep` is 1 (the others' is
/// 0) to `kept`, in order. `offsets` are the numbers of kept elements before each block.
pub fn scatter_kept(
    phase: u32,
    lane: Lane,
    params: &BlockParams,
    keep: &[u32],
    offsets: &[u32],
    kept: &mut Scatter<'_, u32>,
    memory: &mut Memory,
) {
    let first = lane.first_element().min(params.elements);
    let end = (first + PER_LANE).min(params.elements);
    if phase == 0 {
        *local_mut(memory, lane.index) = sum_values(keep, first, end);
    } else if phase == 1 {
        sum_groups(lane, memory);
    } else {
        let mut place = at(offsets, lane.group) + sum_before(lane, memory);
        let mut element = first;
        while element < end {
            if at(keep, element) == 1 {
                kept.set(place, element);
                place += 1;
            }
            element += 1;
        }
    }
}
