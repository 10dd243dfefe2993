//! The hierarchy of the CPU, and the way of a ray through it.
//!
//! A GPU has thousands of rays to hide how long memory takes, and little of it near: its nodes are
//! small. A processor has one ray and wide registers: it tests that against all children of a node
//! at once, and against the eight triangles of a leaf, so its nodes hold what the instructions take
//! as they take it. Ylitie et al.'s nodes, decoded on a CPU, took 1.5 to 2.7 times as long a path
//! (docs/PERFORMANCE.md).
//!
//! The hit of a ray is a definition (see [`super`]), so it is the same, bit for bit, as what the
//! other traversal and a test of all triangles find: `tests/scene/traversal.rs`.
//!
//! - [`lanes`]: numbers side by side, and which processor has how many;
//! - `traversal`: the loop.

pub mod lanes;
mod traversal;

use super::{BvhView, Order};
use crate::scene::abilities::Abilities;
use crate::scene::ray::{Hit, Ray};
use std::sync::Arc;
use std::vec::Vec;

/// Triangles of a leaf at most.
pub const LEAF_TRIANGLES: usize = 8;

/// What a child of a node is, in a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Child {
    /// The node of this number.
    Inner(u32),
    /// The leaf of this number.
    Leaf(u32),
    /// The instance of this number.
    Instance(u32),
}

/// The two highest bits of a word say what it is; so many numbers there are at most.
pub const NUMBERS: u32 = 1 << 30;
const LEAF: u32 = NUMBERS;
const INSTANCE: u32 = 2 * NUMBERS;
/// What is on a stack where a ray leaves an instance.
const WAY_OUT: u32 = 3 * NUMBERS;

impl Child {
    /// As a word; the number is below [`NUMBERS`].
    pub fn word(self) -> u32 {
        match self {
            Self::Inner(number) => number,
            Self::Leaf(number) => LEAF | number,
            Self::Instance(number) => INSTANCE | number,
        }
    }
}

/// The boxes of a node's children, and what they are: aligned so that no register is loaded from
/// two lines of the cache.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub struct Node<const N: usize> {
    /// Low x, high x, low y, high y, low z, high z of each child, in world units or those of the
    /// shape. What is no child is entered by no ray: its low sides are infinite, and its high sides
    /// are minus that.
    pub planes: [[f32; N]; 6],
    /// See [`Child::word`].
    pub children: [u32; N],
}

impl<const N: usize> Node<N> {
    /// Without children.
    pub const EMPTY: Self = Self {
        planes: [
            [f32::INFINITY; N],
            [f32::NEG_INFINITY; N],
            [f32::INFINITY; N],
            [f32::NEG_INFINITY; N],
            [f32::INFINITY; N],
            [f32::NEG_INFINITY; N],
        ],
        children: [0; N],
    };
}

/// The triangles of a leaf: the numbers of their [`Planes`](super::planes::Planes), each beside
/// those of the others.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub struct Leaf {
    /// The twelve numbers of the three rows. Where there is no triangle they are NaN.
    pub planes: [[f32; LEAF_TRIANGLES]; 12],
    /// The entries that the triangles have in the other hierarchy's leaves.
    pub entries: [u32; LEAF_TRIANGLES],
}

impl Leaf {
    /// Without triangles.
    pub const EMPTY: Self =
        Self { planes: [[f32::NAN; LEAF_TRIANGLES]; 12], entries: [0; LEAF_TRIANGLES] };
}

/// The hierarchies of a scene and its shapes, whose nodes have up to `N` children.
pub struct Tree<const N: usize> {
    /// The nodes; the first is the root of the scene's own hierarchy.
    pub nodes: Vec<Node<N>>,
    /// The leaves.
    pub leaves: Vec<Leaf>,
    /// Of each instance the number of its shape's root.
    pub roots: Vec<u32>,
}

/// So many children, less one for each node on the way there, lie beside a path from a root to a
/// leaf at most. Whoever builds a [`Tree`] checks it.
pub const MAX_BESIDE: usize = 480;

/// A [`Tree`], of the width that a processor takes at once.
#[derive(Clone)]
pub enum WideBvh {
    /// For registers of 128 bits.
    Simd128(lanes::Baseline, Arc<Tree<8>>),
    /// For registers of 256 bits.
    #[cfg(target_arch = "x86_64")]
    Avx2(lanes::Avx2, Arc<Tree<8>>),
    /// For registers of 512 bits.
    #[cfg(target_arch = "x86_64")]
    Avx512(lanes::Avx512, Arc<Tree<16>>),
}

impl WideBvh {
    /// [`BvhView::traverse`]; `view` is that of the same scene.
    #[inline(always)]
    pub fn traverse(
        &self,
        view: &BvhView<'_, impl Abilities>,
        ray: &Ray,
        passed: &Hit,
        order: Order,
    ) -> Hit {
        match (order.any, order.behind) {
            (false, false) => self.find::<false, false>(view, ray, passed),
            (false, true) => self.find::<false, true>(view, ray, passed),
            (true, false) => self.find::<true, false>(view, ray, passed),
            (true, true) => self.find::<true, true>(view, ray, passed),
        }
    }

    /// Likewise for an order that is known when it is compiled.
    #[inline(always)]
    fn find<const ANY: bool, const BEHIND: bool>(
        &self,
        view: &BvhView<'_, impl Abilities>,
        ray: &Ray,
        passed: &Hit,
    ) -> Hit {
        match self {
            Self::Simd128(proof, tree) => {
                traversal::simd128::<_, ANY, BEHIND>(*proof, tree, view, ray, passed)
            }
            #[cfg(target_arch = "x86_64")]
            Self::Avx2(proof, tree) => {
                // SAFETY: there is a proof that the processor has the instructions.
                unsafe { traversal::avx2::<_, ANY, BEHIND>(*proof, tree, view, ray, passed) }
            }
            #[cfg(target_arch = "x86_64")]
            Self::Avx512(proof, tree) => {
                // SAFETY: there is a proof that the processor has the instructions.
                unsafe { traversal::avx512::<_, ANY, BEHIND>(*proof, tree, view, ray, passed) }
            }
        }
    }
}
