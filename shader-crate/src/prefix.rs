//! Sums over all elements and over those before each: in blocks of [`BLOCK`] elements, a workgroup of [`LANES`] lanes a block.
//!
//! Three launches make a prefix sum of any length: [`sum_blocks`] adds up each block, [`scan_blocks`] turns the blocks' sums into what
//! lies before each block, and a third kernel, whatever it wants the sums for, adds what lies before each element of
//! its own block (Billeter, Olsson, Assarsson, "Efficient Stream Compaction on Wide SIMD Many-Core Architectures", HPG
//! 2009). Sums are of integers, so their order does not matter.
//!
//! Lanes of a workgroup cooperate in **phases**. Each phase runs for all lanes, with a barrier after it; what a lane hands on to the
//! next phase or to other lanes lies in the workgroup's memory. Within a phase no lane reads what another writes.

use crate::access::Scatter;
use crate::device_struct;

/// Lanes of a workgroup.
pub const LANES: u32 = 256;
/// Elements of a lane.
pub const PER_LANE: u32 = 8;
/// Elements of a block.
pub const BLOCK: u32 = LANES * PER_LANE;
/// Phases of [`fold_step`] and of [`scan_step`] that it takes: the logarithm of [`LANES`].
pub const STEPS: u32 = 8;

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
    /// The lane's elements are this one and the [`PER_LANE`] - 1 after it, as far as there are so many.
    pub fn first_element(self) -> u32 {
        self.group * BLOCK + self.index * PER_LANE
    }
}

/// Whether lane `index` takes part in step `step` (from 0) of folding [`LANES`] values to one, and with which other lane: the values
/// of both are to be put into its own. After [`STEPS`] steps lane 0 has them all.
pub fn fold_partner(step: u32, index: u32) -> Option<u32> {
    let distance = LANES >> (step + 1);
    if index < distance { Some(index + distance) } else { None }
}

/// Step `step` (from 0) of adding up the values of all lanes in the first [`LANES`] words.
pub fn fold_sum<const N: usize>(step: u32, index: u32, memory: &mut [u32; N]) {
    if let Some(partner) = fold_partner(step, index) {
        memory[index as usize] += memory[partner as usize];
    }
}

/// Step `step` (from 0) of adding to each lane's value those of all lanes before it (Hillis, Steele 1986). The values start in the
/// first [`LANES`] words, go to and fro between these and the next, and are back after [`STEPS`] steps, an even number.
pub fn scan_step<const N: usize>(step: u32, index: u32, memory: &mut [u32; N]) {
    let (from, to) = if step & 1 == 0 { (0, LANES) } else { (LANES, 0) };
    let distance = 1 << step;
    let mut sum = memory[(from + index) as usize];
    if index >= distance {
        sum += memory[(from + index - distance) as usize];
    }
    memory[(to + index) as usize] = sum;
}

/// The sum of the values of all lanes before lane `index`, after [`scan_step`].
pub fn before<const N: usize>(index: u32, memory: &[u32; N]) -> u32 {
    if index == 0 { 0 } else { memory[index as usize - 1] }
}

/// Phases of [`sum_blocks`].
pub const SUM_PHASES: u32 = STEPS + 2;

/// Kernel, in phases: the sum of each block of `values`. Sums must be below 2^32.
pub fn sum_blocks(
    phase: u32,
    lane: Lane,
    params: &BlockParams,
    values: &[u32],
    sums: &mut Scatter<'_, u32>,
    memory: &mut [u32; 512],
) {
    if phase == 0 {
        // Neighbouring lanes read neighbouring elements.
        let (mut element, mut sum) = (lane.group * BLOCK + lane.index, 0);
        let mut k = 0;
        while k < PER_LANE {
            if element < params.elements {
                sum += values[element as usize];
            }
            element += LANES;
            k += 1;
        }
        memory[lane.index as usize] = sum;
    } else if phase <= STEPS {
        fold_sum(phase - 1, lane.index, memory);
    } else if lane.index == 0 {
        sums.set(lane.group, memory[0]);
    }
}

/// Phases of [`scan_blocks`].
pub const SCAN_PHASES: u32 = STEPS + 2;

/// Kernel, in phases, one workgroup: turns the sums of blocks into the sum of all blocks before each, and puts the sum of all, which must be
/// below 2^32, after the last.
pub fn scan_blocks(phase: u32, lane: Lane, params: &BlockParams, sums: &mut Scatter<'_, u32>, memory: &mut [u32; 512]) {
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
        memory[lane.index as usize] = sum;
    } else if phase <= STEPS {
        scan_step(phase - 1, lane.index, memory);
    } else {
        let mut sum = before(lane.index, memory);
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
