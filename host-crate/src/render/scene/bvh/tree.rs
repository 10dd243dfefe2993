//! The binary tree that a hierarchy is made of.
//!
//! obvhs clusters neighbours, which makes good trees of surfaces. Of boxes in one place it makes a
//! chain, one pair at a time: that takes the square of their number, and nothing can traverse it.
//! Such boxes are therefore given to it as one, and what it makes too deep is halved instead.

use glam::Vec3A;
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::PlocBuilder;
use std::collections::HashMap;

/// So many boxes are in one place if more are.
const CROWD: usize = 16;

/// A tree whose leaves are groups of boxes.
pub struct Tree {
    nodes: Vec<Bvh2Node>,
    /// The boxes of each leaf.
    groups: Vec<Vec<u32>>,
}

/// Clusters `boxes`, of which there is at least one.
pub fn build(boxes: &[Aabb], parameters: BvhBuildParams) -> Tree {
    let groups = groups(boxes);
    let bounds: Vec<Aabb> = groups
        .iter()
        .map(|group| group.iter().fold(Aabb::empty(), |all, &k| all.union(&boxes[k as usize])))
        .collect();
    let mut tree = PlocBuilder::with_capacity(bounds.len()).build(
        parameters.ploc_search_distance,
        &bounds,
        (0..bounds.len() as u32).collect(),
        parameters.sort_precision,
        parameters.search_depth_threshold,
    );
    tree.uses_spatial_splits = parameters.pre_split;
    ReinsertionOptimizer::default().run(&mut tree, parameters.reinsertion_batch_ratio, None);
    let leaf = |node: Bvh2Node| match node.is_leaf() {
        true => {
            let first_index = tree.primitive_indices[node.first_index as usize];
            Bvh2Node { first_index, ..node }
        }
        false => node,
    };
    Tree { nodes: tree.nodes.iter().map(|&node| leaf(node)).collect(), groups }
}

/// The boxes by where they are: those of about the same extents in about the same place together,
/// if they are many.
fn groups(boxes: &[Aabb]) -> Vec<Vec<u32>> {
    let mut places: HashMap<[i32; 6], u32> = HashMap::new();
    for piece in boxes {
        *places.entry(place(piece)).or_default() += 1;
    }
    places.retain(|_, count| *count as usize > CROWD);
    let mut groups: Vec<Vec<u32>> = Vec::with_capacity(boxes.len());
    let mut crowds: HashMap<[i32; 6], usize> = HashMap::new();
    for (index, piece) in (0..).zip(boxes) {
        let place = place(piece);
        if !places.contains_key(&place) {
            groups.push(vec![index]);
        } else if let Some(&group) = crowds.get(&place) {
            groups[group].push(index);
        } else {
            crowds.insert(place, groups.len());
            groups.push(vec![index]);
        }
    }
    groups
}

/// The powers of two of a box's extents, and its centre in eighths of them.
fn place(piece: &Aabb) -> [i32; 6] {
    let extents = (piece.max - piece.min).to_array();
    let largest = extents.into_iter().fold(f32::MIN_POSITIVE, f32::max);
    let centre = ((piece.max + piece.min) * 0.5).to_array();
    let mut place = [0; 6];
    for axis in 0..3 {
        // A flat box is in the place of others that are nearly so.
        let exponent = extents[axis].max(largest / 1024.0).log2().floor();
        place[axis] = exponent as i32;
        // Saturates far away, where an f32 has no such digits anyway.
        place[3 + axis] =
            (f64::from(centre[axis]) / f64::from(exponent - 3.0).exp2()).floor() as i32;
    }
    place
}

/// `tree` with a leaf for each of `boxes`, no leaf below more than `depth` nodes, which must be at
/// least the logarithm of their number. What would be deeper is halved by medians.
pub fn bound_depth(tree: &Tree, boxes: &[Aabb], depth: u32) -> Bvh2 {
    let mut bounded = Bounded {
        boxes,
        nodes: Vec::with_capacity(2 * boxes.len()),
        pieces: Vec::with_capacity(boxes.len()),
    };
    let sizes = tree.sizes();
    bounded.nodes.push(Bvh2Node::default());
    let mut pending = vec![(0_usize, 0_usize, depth)];
    while let Some((from, to, depth)) = pending.pop() {
        let node = tree.nodes[from];
        let first = node.first_index as usize;
        let fits = |child: usize| halvings(sizes[child].pieces) < depth;
        let is_kept =
            !node.is_leaf() && (sizes[from].height <= depth || fits(first) && fits(first + 1));
        if is_kept {
            let children = bounded.pair();
            bounded.nodes[to] = Bvh2Node::new(*node.aabb(), 0, children as u32);
            pending.push((first, children, depth - 1));
            pending.push((first + 1, children + 1, depth - 1));
        } else {
            bounded.halve(tree.pieces_below(from), to);
        }
    }
    Bvh2 { nodes: bounded.nodes, primitive_indices: bounded.pieces, ..Bvh2::default() }
}

/// A tree with a leaf for each piece, no deeper than `depth`, of one that may be.
pub fn bounded_again(deep: &Bvh2, depth: u32) -> Bvh2 {
    let mut boxes = vec![Aabb::empty(); deep.primitive_indices.len()];
    let mut nodes = deep.nodes.clone();
    for node in nodes.iter_mut().filter(|node| node.is_leaf()) {
        node.first_index = deep.primitive_indices[node.first_index as usize];
        boxes[node.first_index as usize] = *node.aabb();
    }
    let groups = (0..boxes.len() as u32).map(|piece| vec![piece]).collect();
    bound_depth(&Tree { nodes, groups }, &boxes, depth)
}

/// What is below a node.
#[derive(Clone, Copy, Default)]
struct Size {
    /// Boxes.
    pieces: usize,
    /// Nodes above the deepest of them.
    height: u32,
}

impl Tree {
    fn sizes(&self) -> Vec<Size> {
        let mut order = vec![0_usize];
        let mut next = 0;
        while next < order.len() {
            let node = self.nodes[order[next]];
            if !node.is_leaf() {
                order.extend([node.first_index as usize, node.first_index as usize + 1]);
            }
            next += 1;
        }
        let mut sizes = vec![Size::default(); self.nodes.len()];
        for &index in order.iter().rev() {
            let node = self.nodes[index];
            let first = node.first_index as usize;
            sizes[index] = if node.is_leaf() {
                let pieces = self.groups[first].len();
                Size { pieces, height: halvings(pieces) }
            } else {
                let [a, b] = [sizes[first], sizes[first + 1]];
                Size { pieces: a.pieces + b.pieces, height: a.height.max(b.height) + 1 }
            };
        }
        sizes
    }

    fn pieces_below(&self, index: usize) -> Vec<u32> {
        let mut pieces = Vec::new();
        let mut pending = vec![index];
        while let Some(index) = pending.pop() {
            let node = self.nodes[index];
            let first = node.first_index as usize;
            if node.is_leaf() {
                pieces.extend(&self.groups[first]);
            } else {
                pending.extend([first, first + 1]);
            }
        }
        pieces
    }
}

/// How often so many boxes are halved until each is alone.
fn halvings(pieces: usize) -> u32 {
    pieces.next_power_of_two().trailing_zeros()
}

/// A tree under way.
struct Bounded<'a> {
    boxes: &'a [Aabb],
    nodes: Vec<Bvh2Node>,
    pieces: Vec<u32>,
}

impl Bounded<'_> {
    /// Two new nodes beside each other; the index of the first.
    fn pair(&mut self) -> usize {
        self.nodes.extend([Bvh2Node::default(); 2]);
        self.nodes.len() - 2
    }

    /// Makes node `to` of `pieces`, halved where they differ most.
    fn halve(&mut self, mut pieces: Vec<u32>, to: usize) {
        let mut pending = vec![(0..pieces.len(), to)];
        while let Some((range, to)) = pending.pop() {
            let part = &mut pieces[range.clone()];
            let bounds =
                part.iter().fold(Aabb::empty(), |all, &k| all.union(&self.boxes[k as usize]));
            if let &mut [piece] = part {
                self.nodes[to] = Bvh2Node::new(bounds, 1, self.pieces.len() as u32);
                self.pieces.push(piece);
                continue;
            }
            let (side, axis) = widest(part, self.boxes);
            let key = |&k: &u32| corner(&self.boxes[k as usize], side)[axis];
            let middle = part.len() / 2;
            part.select_nth_unstable_by(middle, |a, b| key(a).total_cmp(&key(b)).then(a.cmp(b)));
            let children = self.pair();
            self.nodes[to] = Bvh2Node::new(bounds, 0, children as u32);
            let middle = range.start + middle;
            pending.push((range.start..middle, children));
            pending.push((middle..range.end, children + 1));
        }
    }
}

/// The side (0: low, 1: high) and axis whose coordinate differs most among the boxes of `part`.
fn widest(part: &[u32], boxes: &[Aabb]) -> (usize, usize) {
    let spread = |side: usize| {
        let corners = || part.iter().map(|&k| corner(&boxes[k as usize], side));
        let low = corners().fold(Vec3A::INFINITY, Vec3A::min);
        (corners().fold(Vec3A::NEG_INFINITY, Vec3A::max) - low).to_array()
    };
    let spreads = [spread(0), spread(1)];
    let mut widest = (0, 0);
    for side in 0..2 {
        for axis in 0..3 {
            if spreads[side][axis] > spreads[widest.0][widest.1] {
                widest = (side, axis);
            }
        }
    }
    widest
}

fn corner(piece: &Aabb, side: usize) -> Vec3A {
    if side == 0 { piece.min } else { piece.max }
}
