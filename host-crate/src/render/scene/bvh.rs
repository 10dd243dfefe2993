//! Building the BVH, by the crate obvhs, and bringing it into the layout that the kernels read.

use super::geometry::SceneTriangle;
use crate::names::named;
use crate::render::error::RenderError;
use glam::{UVec4, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::builder::build_cwbvh_from_tris;
use raystream_shaders::scene::bvh::MAX_DEPTH;
use raystream_shaders::scene::bvh::node::Node;
use std::time::Duration;

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
    /// Where each leaf entry comes from: index into the triangles that were given. Splits repeat
    /// some.
    pub order: Vec<u32>,
}

/// Builds the hierarchy over `triangles`.
pub fn build(triangles: &[SceneTriangle], quality: BvhQuality) -> Result<Bvh, RenderError> {
    if triangles.is_empty() {
        // A root whose slots are all empty.
        return Ok(Bvh { nodes: vec![UVec4::ZERO; Node::ROWS as usize], order: Vec::new() });
    }
    let corners: Vec<_> = triangles
        .iter()
        .map(|t| {
            let [v0, v1, v2] = t.corners.map(Vec3A::from);
            obvhs::triangle::Triangle { v0, v1, v2 }
        })
        .collect();
    let parameters = match quality {
        BvhQuality::Fast => BvhBuildParams::very_fast_build(),
        BvhQuality::High => BvhBuildParams::very_slow_build(),
    };
    let bvh = build_cwbvh_from_tris(&corners, parameters, &mut Duration::default());
    let depth = depth(&bvh);
    if depth > MAX_DEPTH {
        return Err(RenderError::TooDeep { depth });
    }
    Ok(Bvh { nodes: bytemuck::pod_collect_to_vec(&bvh.nodes), order: bvh.primitive_indices })
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
