//! The light vertex cache: the vertices of all light paths of a round, close together.
//!
//! Each light path writes its vertices to memory of its own and says how many there are; after a
//! prefix sum over these counts (see [`crate::parallel::prefix`]) it is known where the vertices of
//! each path go. So the cache holds the vertices in the order of their paths, no two lanes write to
//! one place, and given the same paths it is the same, bit for bit, on every device.
//!
//! ```text
//! row 0: number of vertices, 0, 0, 0 | 4 rows of vertex 0 | 4 rows of vertex 1 | ...
//! ```

use super::light_vertex::{LightVertex, ROWS_PER_VERTEX};
use crate::glam::UVec4;
use crate::math::wide::multiply;
use crate::memory::access::{Scatter, at, local_mut};
use crate::memory::device_struct;
use crate::parallel::prefix::{Lane, Memory, PER_LANE, sum_before, sum_groups, sum_values};

/// Rows before the first vertex.
pub const HEADER_ROWS: u32 = 1;

device_struct! {
    /// The parameters of [`gather_vertices`], which begin as those of the sums do. 32 bytes.
    pub struct GatherParams {
        /// Lanes: [`LANES`](crate::parallel::prefix::LANES) for each block of light paths.
        pub threads: u32,
        /// Light paths.
        pub paths: u32,
        /// Blocks of light paths.
        pub blocks: u32,
        /// Vertices that the scratch memory has for each light path.
        pub vertices_per_path: u32,
        /// Unused; zero.
        pub pad0: u32,
        /// Unused; zero.
        pub pad1: u32,
        /// Unused; zero.
        pub pad2: u32,
        /// Unused; zero.
        pub pad3: u32,
    }
}

/// Kernel, in phases: copies the vertices of all light paths from their `scratch` memory to the
/// `cache`. `offsets` are the numbers of vertices before each block of light paths.
pub fn gather_vertices(
    phase: u32,
    lane: Lane,
    params: &GatherParams,
    counts: &[u32],
    offsets: &[u32],
    scratch: &[UVec4],
    cache: &mut Scatter<'_, UVec4>,
    memory: &mut Memory,
) {
    let first = lane.first_element().min(params.paths);
    let end = (first + PER_LANE).min(params.paths);
    if phase == 0 {
        *local_mut(memory, lane.index) = sum_values(counts, first, end);
    } else if phase == 1 {
        sum_groups(lane, memory);
    } else {
        if lane.group == 0 && lane.index == 0 {
            cache.set(0, UVec4::new(at(offsets, params.blocks), 0, 0, 0));
        }
        let before = at(offsets, lane.group) + sum_before(lane, memory);
        let mut to = HEADER_ROWS + before * ROWS_PER_VERTEX;
        let mut path = first;
        while path < end {
            let mut from = path * params.vertices_per_path * ROWS_PER_VERTEX;
            let last = from + at(counts, path) * ROWS_PER_VERTEX;
            while from < last {
                cache.set(to, at(scratch, from));
                from += 1;
                to += 1;
            }
            path += 1;
        }
    }
}

/// The cache of a round.
#[derive(Clone, Copy)]
pub struct LightCache<'a> {
    rows: &'a [UVec4],
}

impl<'a> LightCache<'a> {
    /// Wraps the buffer.
    pub fn new(rows: &'a [UVec4]) -> Self {
        Self { rows }
    }

    /// Number of vertices.
    pub fn len(&self) -> u32 {
        at(self.rows, 0).x
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The vertex number `index`.
    pub fn get(&self, index: u32) -> LightVertex {
        let first = HEADER_ROWS + index * ROWS_PER_VERTEX;
        LightVertex::from_rows([
            at(self.rows, first),
            at(self.rows, first + 1),
            at(self.rows, first + 2),
            at(self.rows, first + 3),
        ])
    }

    /// One of its vertices (there must be some), each as likely as the others, by 32 random `bits`.
    pub fn draw(&self, bits: u32) -> LightVertex {
        self.get(multiply(bits, self.len()).high)
    }
}
