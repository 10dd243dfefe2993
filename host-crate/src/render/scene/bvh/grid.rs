//! Boxes of children as their nodes store them: on a grid of 256 planes, which has to have room for
//! the roundings of the test besides.

use glam::{Vec3, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::node::CwBvhNode;

/// So many steps of its grid a box is wider at least. The test of a plane of the grid has an error
/// of some seven roundings (2^-24) of the distances along the grid, which are up to 2 * 255 steps.
const SLACK: f64 = 1.0 / 2048.0;
/// The last plane of a grid.
const LAST: f64 = 255.0;

/// The boxes of a node's children, by their slot; none where a slot is empty.
type Children = [Option<Aabb>; 8];

/// Computes the boxes of all nodes anew, with slack, from those of the `pieces` in their leaves.
pub fn round_outwards(bvh: &mut CwBvh, pieces: &[Aabb]) {
    let mut boxes = vec![Aabb::empty(); bvh.nodes.len()];
    // Children come after their parents.
    for index in (0..bvh.nodes.len()).rev() {
        let node = bvh.nodes[index];
        let children =
            children_of(&node, &boxes, |leaf| pieces[bvh.primitive_indices[leaf] as usize]);
        let union = |all: Aabb, child: &Aabb| all.union(child);
        boxes[index] = children.iter().flatten().fold(Aabb::empty(), union);
        store(&mut bvh.nodes[index], &boxes[index], &children);
    }
}

fn children_of(node: &CwBvhNode, nodes: &[Aabb], piece: impl Fn(usize) -> Aabb) -> Children {
    let mut next = node.child_base_idx as usize;
    std::array::from_fn(|slot| {
        let meta = node.child_meta[slot];
        if node.imask >> slot & 1 == 1 {
            next += 1;
            Some(nodes[next - 1])
        } else if meta != 0 {
            let first = node.primitive_base_idx as usize + usize::from(meta & 0x1f);
            let count = (meta >> 5).count_ones() as usize;
            (first..first + count).map(&piece).reduce(|all, piece| all.union(&piece))
        } else {
            None
        }
    })
}

fn store(node: &mut CwBvhNode, all: &Aabb, children: &Children) {
    let [low, high] = [all.min, all.max].map(|corner| Vec3::from(corner).as_dvec3());
    let grids = [0, 1, 2].map(|axis| Grid::around(low[axis], high[axis]));
    node.p = Vec3::from_array(grids.map(|grid| grid.origin));
    node.e = grids.map(|grid| grid.exponent);
    let planes = [
        (&mut node.child_min_x, &mut node.child_max_x),
        (&mut node.child_min_y, &mut node.child_max_y),
        (&mut node.child_min_z, &mut node.child_max_z),
    ];
    for (axis, (lows, highs)) in planes.into_iter().enumerate() {
        for (slot, child) in children.iter().enumerate() {
            if let Some(child) = child {
                let of = |corner: Vec3A| f64::from(corner[axis]);
                (lows[slot], highs[slot]) = grids[axis].enclose(of(child.min), of(child.max));
            }
        }
    }
}

/// A grid along an axis.
#[derive(Clone, Copy)]
struct Grid {
    origin: f32,
    /// Of its step, biased as an f32's.
    exponent: u8,
}

impl Grid {
    /// The finest grid that encloses an interval.
    fn around(low: f64, high: f64) -> Self {
        let mut exponent = 1;
        loop {
            let step = Self { origin: 0.0, exponent }.step();
            let origin = below(low - SLACK * step);
            let grid = Self { origin, exponent };
            if (high - f64::from(origin)) / step + SLACK <= LAST || exponent == 254 {
                return grid;
            }
            exponent += 1;
        }
    }

    fn step(&self) -> f64 {
        f64::from(f32::from_bits(u32::from(self.exponent) << 23))
    }

    /// The planes about an interval that it encloses.
    fn enclose(&self, low: f64, high: f64) -> (u8, u8) {
        let place = |x: f64| (x - f64::from(self.origin)) / self.step();
        ((place(low) - SLACK).floor() as u8, (place(high) + SLACK).ceil() as u8)
    }
}

/// The largest f32 that is not above `x`.
fn below(x: f64) -> f32 {
    let rounded = x as f32;
    if f64::from(rounded) > x { rounded.next_down() } else { rounded }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_grid_encloses_with_slack() {
        for (low, high) in [
            (0.0, 1.0),
            (-1e9, 1e9),
            (1.0, 1.000_001),
            (-3e-6, 4e-6),
            (1000.0, 1255.0),
            (0.0, 255.0),
        ] {
            let grid = Grid::around(low, high);
            for (a, b) in [(low, high), (low, low), (high, high), (0.5 * (low + high), high)] {
                let (first, last) = grid.enclose(a, b);
                let plane = |k: u8| f64::from(grid.origin) + f64::from(k) * grid.step();
                let slack = 0.99 * SLACK * grid.step();
                assert!(plane(first) <= a - slack && plane(last) >= b + slack, "{low} {high}");
                assert!(plane(last) - plane(first) <= b - a + 2.1 * grid.step());
            }
            assert!(grid.step() <= (high - low) / 100.0, "{low} {high}");
        }
    }
}
