//! Building the BVH, by the crate obvhs, and bringing it into the layout that the kernels read.
//!
//! The hit of a ray is what testing all triangles would find (see
//! [`raystream_shaders::scene::bvh`]), so boxes have to be wide enough for the roundings of both
//! tests, and the hierarchy no deeper than the traversal's stack, whatever the triangles are:
//!
//! - `pieces` are the boxes of triangles, or of parts of large ones, widened;
//! - `tree` makes a binary tree of them that is never deep;
//! - `grid` rounds the boxes of its wide form outwards, which all devices have;
//! - [`wide`] makes the form of it that the CPU traverses.

mod grid;
mod pieces;
mod tree;
pub mod wide;

use self::pieces::Pieces;
use super::scene_triangle::SceneTriangle;
use crate::names::named;
use glam::{UVec4, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::bvh2_to_cwbvh::bvh2_to_cwbvh;
use raystream_shaders::scene::bvh::MAX_DEPTH;
use raystream_shaders::scene::bvh::node::Node;

/// How long to build for how fast a traversal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BvhQuality {
    /// Milliseconds, for previews and tests.
    Fast,
    /// The default: splits large triangles and reinserts subtrees.
    #[default]
    High,
}

named! {
    BvhQuality {
        Fast: "fast",
        High: "high",
    }
}

/// The hierarchy and the triangles in the order of its leaves.
pub struct Bvh {
    /// [`Node::ROWS`] rows for each node; at least the root.
    pub nodes: Vec<UVec4>,
    /// Where each leaf entry comes from: index into the triangles that were given, and after these
    /// into the boxes. Splits repeat some.
    pub order: Vec<u32>,
    /// The box around all; around the origin where there is nothing.
    pub bounds: Aabb,
    /// The binary tree that it was made from, and the index of what each of its pieces is of, as
    /// in `order`.
    pub binary: (Bvh2, Vec<u32>),
}

/// Triangles in a leaf, at most: what a node's meta byte can say.
const TRIANGLES_PER_LEAF: u32 = 3;
/// How deep the binary tree may be. A wide node takes in three levels of it, so the first will
/// nearly always do, and the last one always.
const DEPTHS: [u32; 3] = [128, 64, MAX_DEPTH];

/// Builds the hierarchy over `triangles` and the `boxes` of what else is in its leaves. It is at
/// most [`MAX_DEPTH`] deep.
pub fn build(triangles: &[SceneTriangle], boxes: &[Aabb], quality: BvhQuality) -> Bvh {
    if triangles.is_empty() && boxes.is_empty() {
        // A root whose slots are all empty.
        let nodes = vec![UVec4::ZERO; Node::ROWS as usize];
        let bounds = Aabb::new(Vec3A::ZERO, Vec3A::ZERO);
        return Bvh { nodes, order: Vec::new(), bounds, binary: Default::default() };
    }
    let parameters = match quality {
        BvhQuality::Fast => BvhBuildParams::very_fast_build(),
        BvhQuality::High => BvhBuildParams::very_slow_build(),
    };
    let mut pieces = Pieces::of(triangles, parameters.pre_split);
    pieces.add(boxes, triangles.len() as u32);
    let tree = tree::build(&pieces.boxes, parameters);
    let (mut bvh, mut bounded) = Default::default();
    for depth in DEPTHS {
        bounded = tree::bound_depth(&tree, &pieces.boxes, depth);
        let per_leaf = parameters.max_prims_per_leaf.clamp(1, TRIANGLES_PER_LEAF);
        bvh = bvh2_to_cwbvh(&bounded, per_leaf, true, false);
        if self::depth(&bvh) <= MAX_DEPTH {
            break;
        }
    }
    grid::round_outwards(&mut bvh, &pieces.boxes);
    let order = bvh.primitive_indices.iter().map(|&piece| pieces.triangles[piece as usize]);
    let bounds = pieces.boxes.iter().fold(Aabb::empty(), |all, piece| all.union(piece));
    Bvh {
        order: order.collect(),
        nodes: bytemuck::pod_collect_to_vec(&bvh.nodes),
        bounds,
        binary: (bounded, pieces.triangles),
    }
}

/// Nodes on the longest path from the root.
fn depth(bvh: &CwBvh) -> u32 {
    let mut deepest = 0;
    let mut pending = vec![(0_u32, 1_u32)];
    while let Some((index, depth)) = pending.pop() {
        deepest = deepest.max(depth);
        let node = &bvh.nodes[index as usize];
        let children = node.imask.count_ones();
        pending.extend(
            (node.child_base_idx..node.child_base_idx + children).map(|child| (child, depth + 1)),
        );
    }
    deepest
}

#[cfg(test)]
mod tests {
    use super::wide::{Binary, Content, collapse};
    use super::*;
    use glam::Vec3;
    use raystream_shaders::scene::bvh::wide::{Child, MAX_BESIDE, Tree};
    use raystream_shaders::scene::triangle::NO_ATTRIBUTES;

    /// The two halves of a quad.
    fn quad(corner: Vec3, u: Vec3, v: Vec3) -> [SceneTriangle; 2] {
        [[corner, corner + u, corner + u + v], [corner, corner + u + v, corner + v]].map(
            |corners| SceneTriangle { corners, material: 0, attributes: NO_ATTRIBUTES, number: 0 },
        )
    }

    /// Asserts that the wide form has all triangles in leaves, each within all boxes above it, and
    /// asks no more of a stack than there is.
    fn assert_wide_form<const N: usize>(
        triangles: &[SceneTriangle],
        bvh: &Bvh,
        tree: Bvh2,
        what: &str,
    ) {
        let contents = bvh.binary.1.iter().map(|&piece| Content::Triangle(piece)).collect();
        let order: Vec<u32> = (0..triangles.len() as u32).collect();
        let planes = super::super::triangles::planes(triangles, &order);
        let wide: Tree<N> = collapse(&[Binary { tree, contents }], &planes, &[]).expect(what);
        let mut found = vec![Vec::new(); triangles.len()];
        let everywhere = Aabb::new(Vec3A::NEG_INFINITY, Vec3A::INFINITY);
        let mut pending = vec![(0_u32, everywhere, 0)];
        while let Some((word, around, beside)) = pending.pop() {
            assert!(beside <= MAX_BESIDE, "{what}: {beside}");
            if let Some(leaf) = word.checked_sub(Child::Leaf(0).word()) {
                let leaf = &wide.leaves[leaf as usize];
                let entries = leaf.entries.iter().zip(leaf.planes[0]);
                let entries = entries.filter(|(_, number)| !number.is_nan());
                entries.for_each(|(&entry, _)| found[entry as usize].push(around));
                continue;
            }
            let node = &wide.nodes[word as usize];
            let is_child = |&place: &usize| node.planes[0][place] <= node.planes[1][place];
            let children: Vec<usize> = (0..N).filter(is_child).collect();
            for &place in &children {
                let corner =
                    |side: usize| Vec3A::from([0, 2, 4].map(|r| node.planes[r + side][place]));
                let bounds = around.intersection(&Aabb::new(corner(0), corner(1)));
                pending.push((node.children[place], bounds, beside + children.len() - 1));
            }
        }
        for (triangle, boxes) in triangles.iter().zip(&found) {
            let corners = triangle.corners.map(Vec3A::from);
            // Those of pieces together have it all; of a whole one each of its corners.
            let is_covered = |corner: &Vec3A| boxes.iter().any(|it| it.contains_point(*corner));
            assert!(corners.iter().all(is_covered), "{what}: {corners:?}");
        }
    }

    fn assert_traversable(triangles: &[SceneTriangle], what: &str) {
        for quality in [BvhQuality::Fast, BvhQuality::High] {
            let bvh = build(triangles, &[], quality);
            let nodes = bytemuck::cast_slice(&bvh.nodes).to_vec();
            let wide = CwBvh { nodes, ..CwBvh::default() };
            assert!(depth(&wide) <= MAX_DEPTH, "{what}: {}", depth(&wide));
            let mut found = bvh.order.clone();
            found.sort_unstable();
            found.dedup();
            assert_eq!(found.len(), triangles.len(), "{what}: triangles in leaves");
            // As it is, and halved as a tree is that would be too deep.
            let again = |depth| tree::bounded_again(&bvh.binary.0, depth);
            for depth in [u32::MAX, MAX_DEPTH] {
                assert_wide_form::<8>(triangles, &bvh, again(depth), what);
                assert_wide_form::<16>(triangles, &bvh, again(depth), what);
            }
        }
    }

    #[test]
    fn triangles_in_one_place_are_no_deep_hierarchy() {
        for count in [10, 200, 30_000] {
            let copies: Vec<_> =
                (0..count).flat_map(|_| quad(Vec3::ZERO, Vec3::X, Vec3::Y)).collect();
            assert_traversable(&copies, "copies");
            let nearly: Vec<_> = (0..count)
                .flat_map(|k| quad(Vec3::Z * (k as f32 * 1e-7), Vec3::X, Vec3::Y))
                .collect();
            assert_traversable(&nearly, "decals");
            let nested: Vec<_> = (0..count)
                .flat_map(|k| {
                    let size = 1.0 + k as f32 / count as f32;
                    quad(Vec3::splat(-0.5 * size), Vec3::X * size, Vec3::ONE * size)
                })
                .collect();
            assert_traversable(&nested, "one in another");
            let fan: Vec<_> = (0..count)
                .map(|k| {
                    let rim = |k: i32| {
                        let angle = k as f32 / count as f32;
                        Vec3::new(angle.cos(), angle.sin(), 0.0)
                    };
                    let corners = [Vec3::ZERO, rim(k), rim(k + 1)];
                    SceneTriangle { corners, material: 0, attributes: NO_ATTRIBUTES, number: 0 }
                })
                .collect();
            assert_traversable(&fan, "a fan");
        }
        let growing: Vec<_> = (-60..60)
            .flat_map(|k| {
                let size = 1.6_f32.powi(k);
                quad(Vec3::splat(-0.5 * size), Vec3::X * size, Vec3::Y * size)
            })
            .collect();
        assert_traversable(&growing, "sizes of all orders");
    }
}
