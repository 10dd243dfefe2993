//! The hierarchy of the CPU, see [`raystream_shaders::scene::bvh::wide`]: a binary tree collapsed
//! into nodes of many children.
//!
//! Which descendants become the children of a node is chosen so that the expected cost of a ray is
//! least, by dynamic programming over the binary tree. After Ylitie, Karras and Laine, "Efficient
//! Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", HPG 2017, section 3.1.

use super::tree;
use glam::{UVec4, Vec3};
use obvhs::bvh2::Bvh2;
use rayon::prelude::*;
use raystream_shaders::scene::bvh::MAX_DEPTH;
use raystream_shaders::scene::bvh::planes::Planes;
use raystream_shaders::scene::bvh::wide::{
    Child, LEAF_TRIANGLES, Leaf, MAX_BESIDE, NUMBERS, Node, Tree,
};
use std::collections::VecDeque;

/// What a hierarchy is collapsed from.
pub struct Binary {
    /// A leaf for each piece, and children behind their parents.
    pub tree: Bvh2,
    /// What each piece is of.
    pub contents: Vec<Content>,
}

/// What a piece is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Content {
    /// The triangle of the leaf entry of this number.
    Triangle(u32),
    /// The instance of this number.
    Instance(u32),
}

/// What a leaf costs if a node costs 1. Measured: 0.4 is as good.
const LEAF_COST: f32 = 0.7;
/// Children of a node at most, of any tree.
const MOST_CHILDREN: usize = 16;

/// Collapses the hierarchies of a scene, its own first, into one of nodes with up to `N` children.
/// `planes` are the rows of all leaf entries, and `shapes` has for each instance the number of its
/// shape's hierarchy. [`None`] if a word has no room for the number of something.
pub fn collapse<const N: usize>(
    hierarchies: &[Binary],
    planes: &[UVec4],
    shapes: &[u32],
) -> Option<Tree<N>> {
    let plans: Vec<Plan> = hierarchies.par_iter().map(|it| Plan::of(&it.tree, it, N)).collect();
    let mut tree = Tree { nodes: Vec::new(), leaves: Vec::new(), roots: Vec::new() };
    let mut roots = Vec::with_capacity(plans.len());
    for (binary, plan) in hierarchies.iter().zip(plans) {
        roots.push(tree.nodes.len() as u32);
        let before = (tree.nodes.len(), tree.leaves.len());
        if !(Emission { tree: &mut tree, planes, binary }.emit(&binary.tree, &plan)) {
            // Too deep for the stack of a traversal; a tree that is halved cannot be.
            let halved = tree::bounded_again(&binary.tree, MAX_DEPTH);
            tree.nodes.truncate(before.0);
            tree.leaves.truncate(before.1);
            let plan = Plan::of(&halved, binary, N);
            Emission { tree: &mut tree, planes, binary }.emit(&halved, &plan);
        }
        if tree.nodes.len().max(tree.leaves.len()).max(shapes.len()) >= NUMBERS as usize {
            return None;
        }
    }
    tree.roots = shapes.iter().map(|&shape| roots[shape as usize]).collect();
    Some(tree)
}

/// What becomes of each node of a binary tree.
struct Plan {
    choices: Vec<Choice>,
}

#[derive(Clone, Copy)]
struct Choice {
    /// Of the children that stand for it, if there may be so many and one more: how many stand for
    /// its first child; 0 if one less is as good.
    firsts: [u8; MOST_CHILDREN],
    /// Whether it is a leaf where it is one child.
    is_leaf: bool,
}

impl Plan {
    /// The cheapest for nodes of up to `width` children.
    fn of(tree: &Bvh2, binary: &Binary, width: usize) -> Self {
        let nothing = Choice { firsts: [0; MOST_CHILDREN], is_leaf: true };
        let mut choices = vec![nothing; tree.nodes.len()];
        // Of so many children and one more.
        let mut costs = vec![[0.0_f32; MOST_CHILDREN]; tree.nodes.len()];
        let mut counts = vec![0_u32; tree.nodes.len()];
        for (index, node) in tree.nodes.iter().enumerate().rev() {
            let area = node.aabb().half_area();
            if node.is_leaf() {
                let piece = tree.primitive_indices[node.first_index as usize];
                let is_triangle = matches!(binary.contents[piece as usize], Content::Triangle(_));
                // An instance is a child of its own.
                counts[index] = if is_triangle { 1 } else { LEAF_TRIANGLES as u32 + 1 };
                costs[index] = [area * LEAF_COST; MOST_CHILDREN];
                continue;
            }
            let first = node.first_index as usize;
            let [left, right] = [costs[first], costs[first + 1]];
            counts[index] = counts[first].saturating_add(counts[first + 1]);
            // The best of all ways to share `children` out.
            let shared = |children: usize| {
                (1..children)
                    .map(|firsts| (left[firsts - 1] + right[children - firsts - 1], firsts as u8))
                    .fold((f32::INFINITY, 0), |best, way| if way.0 < best.0 { way } else { best })
            };
            let (of_node, firsts) = shared(width);
            let inner = area + of_node;
            let leaf = if counts[index] as usize <= LEAF_TRIANGLES {
                area * LEAF_COST
            } else {
                f32::INFINITY
            };
            let (choice, cost) = (&mut choices[index], &mut costs[index]);
            choice.is_leaf = leaf <= inner;
            (choice.firsts[0], cost[0]) = (firsts, inner.min(leaf));
            for children in 2..=width {
                let (least, firsts) = shared(children);
                let is_better = least < cost[children - 2];
                cost[children - 1] = if is_better { least } else { cost[children - 2] };
                choice.firsts[children - 1] = if is_better { firsts } else { 0 };
            }
        }
        Self { choices }
    }

    /// The children that a node is given, of `width` at most.
    fn children(&self, tree: &Bvh2, index: usize, width: usize) -> Vec<usize> {
        let node = tree.nodes[index];
        if self.choices[index].is_leaf {
            return vec![index];
        }
        let (first, firsts) = (node.first_index as usize, self.choices[index].firsts[0].into());
        let mut children = Vec::with_capacity(width);
        let mut pending = vec![(first + 1, width - firsts), (first, firsts)];
        while let Some((index, mut share)) = pending.pop() {
            let firsts = &self.choices[index].firsts;
            while share > 1 && firsts[share - 1] == 0 {
                share -= 1;
            }
            if share == 1 {
                children.push(index);
            } else {
                let first = tree.nodes[index].first_index as usize;
                let firsts = usize::from(firsts[share - 1]);
                pending.extend([(first + 1, share - firsts), (first, firsts)]);
            }
        }
        children
    }
}

/// The writing of one hierarchy behind the others.
struct Emission<'a, const N: usize> {
    tree: &'a mut Tree<N>,
    planes: &'a [UVec4],
    binary: &'a Binary,
}

impl<const N: usize> Emission<'_, N> {
    /// Whether no ray has more to visit than its stack has room for.
    fn emit(&mut self, from: &Bvh2, plan: &Plan) -> bool {
        let mut pending = VecDeque::new();
        let mut most_beside = 0;
        self.tree.nodes.push(Node::EMPTY);
        if !from.nodes.is_empty() {
            pending.push_back((0_usize, self.tree.nodes.len() - 1, 0_usize));
        }
        while let Some((index, to, beside)) = pending.pop_front() {
            let children = plan.children(from, index, N);
            let beside = beside + children.len() - 1;
            most_beside = most_beside.max(beside);
            let mut node = Node::EMPTY;
            for (place, &child) in children.iter().enumerate() {
                let bounds = from.nodes[child].aabb();
                let corners = [bounds.min, bounds.max].map(Vec3::from);
                for (row, plane) in node.planes.iter_mut().enumerate() {
                    plane[place] = corners[row % 2][row / 2];
                }
                let child = if plan.choices[child].is_leaf {
                    self.leaf(pieces_below(from, child))
                } else {
                    pending.push_back((child, self.tree.nodes.len(), beside));
                    self.tree.nodes.push(Node::EMPTY);
                    Child::Inner(self.tree.nodes.len() as u32 - 1)
                };
                node.children[place] = child.word();
            }
            self.tree.nodes[to] = node;
        }
        most_beside <= MAX_BESIDE
    }

    /// A leaf of these pieces, of which there may be several of a triangle.
    fn leaf(&mut self, pieces: Vec<u32>) -> Child {
        let mut entries = Vec::with_capacity(LEAF_TRIANGLES);
        for piece in pieces {
            match self.binary.contents[piece as usize] {
                Content::Triangle(entry) => entries.push(entry),
                Content::Instance(number) => return Child::Instance(number),
            }
        }
        entries.sort_unstable();
        entries.dedup();
        let mut leaf = Leaf::EMPTY;
        for (place, &entry) in entries.iter().enumerate() {
            let first = (entry * Planes::ROWS) as usize;
            let rows = &self.planes[first..first + Planes::ROWS as usize];
            let words = rows.iter().flat_map(UVec4::to_array);
            for (numbers, word) in leaf.planes.iter_mut().zip(words) {
                numbers[place] = f32::from_bits(word);
            }
            leaf.entries[place] = entry;
        }
        self.tree.leaves.push(leaf);
        Child::Leaf(self.tree.leaves.len() as u32 - 1)
    }
}

fn pieces_below(tree: &Bvh2, index: usize) -> Vec<u32> {
    let mut pieces = Vec::with_capacity(LEAF_TRIANGLES);
    let mut pending = vec![index];
    while let Some(index) = pending.pop() {
        let node = tree.nodes[index];
        let first = node.first_index as usize;
        if node.is_leaf() {
            pieces.push(tree.primitive_indices[first]);
        } else {
            pending.extend([first, first + 1]);
        }
    }
    pieces
}
