//! Where a ray is among hierarchies, and what it has left to do.

use super::MAX_DEPTH;
use super::instance::{NO_INSTANCE, instance_of_leaf};
use super::node::BoxRay;
use super::planes::Planes;
use crate::glam::UVec2;
use crate::memory::access::{local, local_mut};
use crate::scene::ray::Ray;

/// Where a ray is: in the world, or in the space of an instance's shape.
#[derive(Clone, Copy)]
pub struct Space {
    /// The ray there.
    pub ray: Ray,
    /// What boxes there are tested with.
    pub box_ray: BoxRay,
    /// Number of the root among the nodes.
    pub root: u32,
    /// What is added to the number of a leaf entry there to make that of a hit.
    pub shift: u32,
    pub is_inside: bool,
    /// What is left to do outside of the instance.
    pub outside: Work,
}

impl Space {
    /// The number of a hit of this leaf entry.
    #[inline(always)]
    pub fn number(&self, entry: u32) -> u32 {
        entry.wrapping_add(self.shift)
    }
}

/// What a ray has left to do in one hierarchy, beside what is on its stack.
#[derive(Clone, Copy)]
pub struct Work {
    /// The node group at hand.
    pub group: UVec2,
    /// The first triangle of the triangle group at hand.
    pub first_triangle: u32,
    /// The bits of the triangle group at hand.
    pub triangles: u32,
    /// Groups on the stack.
    pub stacked: u32,
    /// Whether no node is left.
    pub is_last: bool,
}

impl Work {
    /// None.
    pub const NOTHING: Self =
        Self { group: UVec2::ZERO, first_triangle: 0, triangles: 0, stacked: 0, is_last: true };

    /// All of the hierarchy whose `root` is the node of this number.
    #[inline(always)]
    pub fn all_of(root: u32) -> Self {
        // As if the root were the only child of a node above it.
        let group = UVec2::new(root, 0x8000_0000);
        Self { group, first_triangle: 0, triangles: 0, stacked: 0, is_last: false }
    }
}

/// A stack of node groups.
pub type Stack = [UVec2; MAX_DEPTH as usize];

/// Puts a group on the stack of the space that a ray is in, as number `stacked`.
#[inline(always)]
pub fn push(outer: &mut Stack, inner: &mut Stack, is_inside: bool, stacked: u32, group: UVec2) {
    if is_inside {
        *local_mut(inner, stacked) = group;
    } else {
        *local_mut(outer, stacked) = group;
    }
}

/// The group of number `stacked` on that stack.
#[inline(always)]
pub fn top(outer: &Stack, inner: &Stack, is_inside: bool, stacked: u32) -> UVec2 {
    if is_inside { local(inner, stacked) } else { local(outer, stacked) }
}

/// The numbers of the first two triangles of a group, which are taken from its bits. The last one
/// alone comes twice.
#[inline(always)]
pub fn take_two(first_triangle: u32, triangles: &mut u32) -> (u32, u32) {
    let first = first_triangle + triangles.trailing_zeros();
    *triangles &= *triangles - 1;
    let next = first_triangle + triangles.trailing_zeros();
    let second = if *triangles == 0 { first } else { next };
    *triangles &= triangles.wrapping_sub(1);
    (first, second)
}

/// Whether one of two leaf entries is an instance.
#[inline(always)]
pub fn holds_instance(entries: &(Planes, Planes)) -> bool {
    instance_of_leaf(&entries.0) != NO_INSTANCE || instance_of_leaf(&entries.1) != NO_INSTANCE
}
