//! Sums over all elements and over those before each: in blocks of [`BLOCK`] elements, a workgroup
//! of [`LANES`] lanes a block.
//!
//! Three launches make a prefix sum of any length: [`sum_blocks`] adds up each block,
//! [`scan_blocks`] turns the blocks' sums into what lies before each block, and a third kernel,
//! whatever it wants the sums for, adds what lies before each element of its own block (Billeter,
//! Olsson, Assarsson, "Efficient Stream Compaction on Wide SIMD Many-Core Architectures", HPG
//! 2009). Sums are of integers, so their order does not matter.
//!
//! Lanes of a workgroup cooperate in **phases**. Each phase runs for all lanes, with a barrier
//! after it; what a lane hands on to the next phase or to other lanes lies in the workgroup's
//! memory. Within a phase no lane reads what another writes.

use crate::memory::access::{Scatter, at, local, local_mut};
use crate::memory::device_struct;

/// Lanes of a workgroup.
pub const LANES: u32 = 256;
/// Elements of a lane.
pub const PER_LANE: u32 = 4;
/// Elements of a block.
pub const BLOCK: u32 = LANES * PER_LANE;
/// Lanes of a group: sums over a workgroup are made of sums over groups, in few phases.
pub const GROUP: u32 = 16;
/// Phases of every kernel over sums: each lane's own part, the groups' sums, and what it is all
/// for.
pub const PHASES: u32 = 3;

/// The memory of a workgroup: a word for each lane, and after these one for each group.
pub type Memory = [u32; (LANES + LANES / GROUP) as usize];

device_struct! {
    /// The parameters of a kernel over blocks. 16 bytes.
    pub struct BlockParams {
        /// Lanes: [`LANES`] for each block.
        pub threads: u32,
        /// Elements.
        pub elements: u32,
        /// Blocks: `elements / BLOCK`, rounded up.
        pub blocks: u32,
        /// Unused; zero.
        pub pad: u32,
    }
}

impl BlockParams {
    /// One workgroup for each block of `elements` elements.
    pub fn per_block(elements: u32) -> Self {
        let blocks = elements.div_ceil(BLOCK);
        Self { threads: blocks * LANES, elements, blocks, pad: 0 }
    }

    /// One workgroup for all the blocks together.
    pub fn one_workgroup(elements: u32) -> Self {
        Self { threads: LANES, ..Self::per_block(elements) }
    }
}

/// Which lane of which workgroup runs.
#[derive(Clone, Copy)]
pub struct Lane {
    /// Number of the workgroup, which is that of its block.
    pub group: u32,
    /// Number of the lane in its workgroup, below [`LANES`].
    pub index: u32,
}

impl Lane {
    /// The lane's elements are this one and the [`PER_LANE`] - 1 after it, as far as there are so
    /// many.
    pub fn first_element(self) -> u32 {
        self.group * BLOCK + self.index * PER_LANE
    }
}

/// The sum of `count` words from `first` on.
fn sum(memory: &Memory, first: u32, count: u32) -> u32 {
    let (mut sum, mut k) = (0, 0);
    while k < count {
        sum += local(memory, first + k);
        k += 1;
    }
    sum
}

/// Puts the sum over each [`GROUP`] lanes of the values in the first [`LANES`] words behind these.
pub fn sum_groups(lane: Lane, memory: &mut Memory) {
    if lane.index < LANES / GROUP {
        *local_mut(memory, LANES + lane.index) = sum(memory, lane.index * GROUP, GROUP);
    }
}

/// The sum over all lanes, a phase after [`sum_groups`].
pub fn sum_of_all(memory: &Memory) -> u32 {
    sum(memory, LANES, LANES / GROUP)
}

/// The phases after the first of a kernel that wants the sum of each block, once each lane's part
/// is in the memory.
pub fn finish_block_sum(phase: u32, lane: Lane, sums: &mut Scatter<'_, u32>, memory: &mut Memory) {
    if phase == 1 {
        sum_groups(lane, memory);
    } else if lane.index == 0 {
        sums.set(lane.group, sum_of_all(memory));
    }
}

/// The sum of the values from `first` to before `end`.
pub fn sum_values(values: &[u32], first: u32, end: u32) -> u32 {
    let (mut sum, mut element) = (0, first);
    while element < end {
        sum += at(values, element);
        element += 1;
    }
    sum
}

/// The sum over the lanes before this one, a phase after [`sum_groups`].
pub fn sum_before(lane: Lane, memory: &Memory) -> u32 {
    let group = lane.index / GROUP;
    sum(memory, LANES, group) + sum(memory, group * GROUP, lane.index % GROUP)
}

/// Kernel, in phases: the sum of each block of `values`. Sums must be below 2^32.
pub fn sum_blocks(
    phase: u32,
    lane: Lane,
    params: &BlockParams,
    values: &[u32],
    sums: &mut Scatter<'_, u32>,
    memory: &mut Memory,
) {
    if phase == 0 {
        // Neighbouring lanes read neighbouring elements.
        let (mut element, mut sum) = (lane.group * BLOCK + lane.index, 0);
        let mut k = 0;
        while k < PER_LANE {
            if element < params.elements {
                sum += at(values, element);
            }
            element += LANES;
            k += 1;
        }
        *local_mut(memory, lane.index) = sum;
    } else {
        finish_block_sum(phase, lane, sums, memory);
    }
}

/// Kernel, in phases, one workgroup: turns the sums of blocks into the sum of all blocks before
/// each, and puts the sum of all, which must be below 2^32, after the last.
pub fn scan_blocks(
    phase: u32,
    lane: Lane,
    params: &BlockParams,
    sums: &mut Scatter<'_, u32>,
    memory: &mut Memory,
) {
    // Each lane has a stretch of consecutive blocks.
    let stretch = params.blocks.div_ceil(LANES);
    let first = (lane.index * stretch).min(params.blocks);
    let end = (first + stretch).min(params.blocks);
    if phase == 0 {
        let mut sum = 0;
        let mut block = first;
        while block < end {
            sum += sums.get(block);
            block += 1;
        }
        *local_mut(memory, lane.index) = sum;
    } else if phase == 1 {
        sum_groups(lane, memory);
    } else {
        let mut sum = sum_before(lane, memory);
        let mut block = first;
        while block < end {
            let own = sums.get(block);
            sums.set(block, sum);
            sum += own;
            block += 1;
        }
        if lane.index == LANES - 1 {
            sums.set(params.blocks, sum);
        }
    }
}
