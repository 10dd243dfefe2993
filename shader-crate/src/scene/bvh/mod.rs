//! Traversal of the compressed wide BVH.
//!
//! Ylitie, Karras and Laine, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide
//! BVHs", HPG 2017. [`node`] tests a ray against the boxes of a node's children, [`planes`] against
//! the triangles of its leaves.
//!
//! A ray's work is two groups of bits. A **node group** is (first child, hits << 24 | inner mask):
//! bit 24 + k is a child still to visit, k its place in the order in which this ray's octant visits
//! children, nearest highest. A **triangle group** is (first triangle, a bit for each triangle
//! still to test).
//!
//! **The hit is a definition**, and not what an order of visits makes of it: of the triangles that
//! [`Planes::intersect`] finds in front of a ray, the one with the least distance, and of those
//! with the same distance the one that comes first in the scene. Boxes are wide enough for that
//! (see [`BoxRay`]), so every traversal of every hierarchy finds the same, and so does testing all
//! triangles.

pub mod node;
pub mod planes;

use crate::glam::{UVec2, UVec4};
use crate::memory::access::{at, local, local_mut, scratch};
use crate::memory::rows::{three_rows, word};
use crate::scene::ray::{Hit, NO_TRIANGLE, Ray};
use node::{BoxRay, Node};
use planes::{Plane, Planes};

/// Deepest hierarchy that can be traversed, in nodes on one path from the root: each of them leaves
/// at most one group on the stack. Whoever builds a [`BvhView`]'s buffer checks it.
pub const MAX_DEPTH: u32 = 32;

/// A node group's bits of children still to visit.
const PENDING: u32 = 0xff00_0000;

/// Which hit of a ray is looked for. Both are known when a kernel is compiled.
#[derive(Clone, Copy)]
pub struct Order {
    /// Any one, rather than the nearest.
    pub any: bool,
    /// Only those behind one that is given.
    pub behind: bool,
}

impl Order {
    /// The nearest one.
    pub const NEAREST: Self = Self { any: false, behind: false };
}

/// The BVH of a scene and the triangles in its leaves.
#[derive(Clone, Copy)]
pub struct BvhView<'a> {
    rows: &'a [UVec4],
    first_planes: u32,
    first_order: u32,
}

impl<'a> BvhView<'a> {
    /// Wraps the buffer of the nodes and, from row `first_planes` on, the triangles and, from row
    /// `first_order` on, the number of each in the scene, four to a row. There is at least the
    /// root, no path is longer than [`MAX_DEPTH`], and all indices are in range.
    pub fn new(rows: &'a [UVec4], first_planes: u32, first_order: u32) -> Self {
        Self { rows, first_planes, first_order }
    }

    /// The triangle that `ray` hits in `0 < t < ray.t_max`, by the `order`: the nearest, of several
    /// the first in the scene, unless any will do; behind `passed`, one of its hits, if that is
    /// asked for.
    ///
    /// In turns: a ray that has triangles to test tests two of them, one that has none visits a
    /// node first.
    ///
    /// Lanes of a GPU take their turns in step, so a turn takes as long as that of the busiest
    /// lane. Were all the triangles of a node tested in one turn, 32 diffuse rays in Sibenik, with
    /// 12 nodes and 6.5 triangles each, would take 20 turns with 106 tests, one lane in sixteen at
    /// work; by two a turn they take 26 turns with 47.
    #[inline(always)]
    pub fn traverse(&self, ray: &Ray, passed: &Hit, order: Order) -> Hit {
        let box_ray = BoxRay::new(ray);
        let mut hit = Hit::miss(ray.t_max);
        let mut stack = scratch::<UVec2, { MAX_DEPTH as usize }>();
        let mut stacked = 0;
        // As if the root were the only child of a node above it.
        let mut group = UVec2::new(0, 0x8000_0000);
        let mut is_last = false;
        let mut first_triangle = 0;
        let mut triangles = 0;
        loop {
            if triangles == 0 {
                let place = 31 - group.y.leading_zeros();
                let inner_mask = group.y;
                group.y &= !(1 << place);
                if group.y & PENDING != 0 {
                    *local_mut(&mut stack, stacked) = group;
                    stacked += 1;
                }
                let slot = (place ^ box_ray.octant) & 7;
                let preceding = (inner_mask & !(u32::MAX << slot) & 0xff).count_ones();
                let node = Node::load(self.rows, group.x + preceding);
                let hits = box_ray.intersect(&node, hit.t);
                group = UVec2::new(node.first_child(), hits & PENDING | node.inner_mask());
                triangles = hits & !PENDING;
                first_triangle = node.first_triangle();
                if group.y & PENDING == 0 {
                    if stacked == 0 {
                        is_last = true;
                    } else {
                        stacked -= 1;
                        group = local(&stack, stacked);
                    }
                }
            }
            if triangles != 0 {
                let first = first_triangle + triangles.trailing_zeros();
                triangles &= triangles - 1;
                // The last one alone is tested twice.
                let next = first_triangle + triangles.trailing_zeros();
                let second = if triangles == 0 { first } else { next };
                triangles &= triangles.wrapping_sub(1);
                // Both are loaded before one is tested, so that one latency hides the other.
                let planes = (self.planes(first), self.planes(second));
                self.test(&planes.0, ray, first, passed, order, &mut hit);
                self.test(&planes.1, ray, second, passed, order, &mut hit);
                if order.any && hit.is_some() {
                    // Nothing is left to do.
                    triangles = 0;
                    is_last = true;
                }
            }
            if is_last && triangles == 0 {
                return hit;
            }
        }
    }

    /// Makes triangle number `index`, whose planes these are, the hit of `ray` where it is the
    /// nearer one or, unless any will do, as near and earlier in the scene; if it must lie behind
    /// the hit `passed`, only then.
    #[inline(always)]
    pub fn test(
        &self,
        planes: &Planes,
        ray: &Ray,
        index: u32,
        passed: &Hit,
        order: Order,
        hit: &mut Hit,
    ) {
        let (t, u, v) = planes.intersect(ray.origin, ray.direction);
        let is_nearer = t > 0.0 && t < hit.t;
        let is_hit = is_nearer || !order.any && t == hit.t && self.precedes(index, hit.triangle);
        let is_behind =
            !order.behind || t > passed.t || t == passed.t && self.follows(index, passed.triangle);
        if is_hit && is_behind {
            *hit = Hit { t, u, v, triangle: index };
        }
    }

    /// Whether triangle number `index` is earlier in the scene than number `other`, if that is one.
    fn precedes(&self, index: u32, other: u32) -> bool {
        other != NO_TRIANGLE && self.scene_triangle(index) < self.scene_triangle(other)
    }

    /// Whether triangle number `index` is later in the scene than number `other`, if that is one.
    fn follows(&self, index: u32, other: u32) -> bool {
        other != NO_TRIANGLE && self.scene_triangle(other) < self.scene_triangle(index)
    }

    /// The number in the scene of the triangle number `index` in the order of the leaves.
    fn scene_triangle(&self, index: u32) -> u32 {
        word(self.rows, self.first_order, index)
    }

    /// The triangle number `index`, in the order of the leaves.
    #[inline(always)]
    pub fn planes(&self, index: u32) -> Planes {
        Planes { rows: three_rows(self.rows, self.first_planes + index * Planes::ROWS) }
    }

    /// The plane of the triangle number `index`.
    pub fn plane(&self, index: u32) -> Plane {
        Plane::from_row(at(self.rows, self.first_planes + index * Planes::ROWS))
    }
}
