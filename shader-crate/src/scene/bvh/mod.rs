//! Traversal of the compressed wide BVH.
//!
//! Ylitie, Karras and Laine, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide
//! BVHs", HPG 2017. [`node`] tests a ray against the boxes of a node's children, [`planes`] against
//! the triangles of its leaves.
//!
//! A ray's work is two groups of bits. A **node group** is (first child, hits << 24 | inner mask):
//! bit 24 + k is a child still to visit, k its place in the order in which this ray's octant visits
//! children, nearest highest. A **triangle group** is (first triangle, a bit for each triangle
//! still to test). Where shapes have [instances](instance), a ray goes through both levels of
//! hierarchies in the same loop.
//!
//! **The hit is a definition**, and not what an order of visits makes of it: of the triangles that
//! [`Planes::intersect`] finds in front of a ray, the one with the least distance, and of those
//! with the same distance the one that comes first in the scene. Boxes are wide enough for that
//! (see [`BoxRay`]), so every traversal of every hierarchy finds the same, and so does testing all
//! triangles.

pub mod instance;
pub mod node;
pub mod planes;
#[cfg(not(target_arch = "spirv"))]
pub mod wide;
mod work;

use crate::glam::{UVec2, UVec4, Vec3};
use crate::memory::access::{at, scratch};
use crate::memory::rows::{three_rows, word};
use crate::scene::abilities::{Abilities, INSTANCES};
use crate::scene::ray::{Hit, NO_TRIANGLE, Ray};
use instance::{InstanceView, NO_INSTANCE, Place, instance_of_leaf};
use node::{BoxRay, Node, RAY_WIDTH};
use planes::{Plane, Planes};
use work::{Space, Stack, Work, holds_instance, push, take_two, top};

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
pub struct BvhView<'a, A> {
    rows: &'a [UVec4],
    first_planes: u32,
    first_order: u32,
    instances: InstanceView<'a>,
    abilities: A,
    /// The hierarchy that takes the place of this one.
    #[cfg(not(target_arch = "spirv"))]
    wide: Option<&'a wide::WideBvh>,
}

impl<'a, A: Abilities> BvhView<'a, A> {
    /// Wraps the buffer of the nodes and, from row `first_planes` on, the triangles and, from row
    /// `first_order` on, the number of each in the scene, four to a row, and from `first_instance`
    /// on the [instances](instance). There is at least the root, no path is longer than
    /// [`MAX_DEPTH`], and all indices are in range.
    pub fn new(
        abilities: A,
        rows: &'a [UVec4],
        [first_planes, first_order, first_instance]: [u32; 3],
    ) -> Self {
        let instances = InstanceView { rows, first: first_instance };
        Self {
            rows,
            first_planes,
            first_order,
            instances,
            abilities,
            #[cfg(not(target_arch = "spirv"))]
            wide: None,
        }
    }

    /// The same, which traverses another hierarchy of the same triangles, if there is one.
    #[cfg(not(target_arch = "spirv"))]
    pub fn with_wide(self, wide: Option<&'a wide::WideBvh>) -> Self {
        Self { wide, ..self }
    }

    /// The triangle that `ray` hits in `0 < t < ray.t_max`, by the `order`: the nearest, of several
    /// the first in the scene, unless any will do; behind `passed`, one of its hits, if that is
    /// asked for.
    #[inline(always)]
    pub fn traverse(&self, ray: &Ray, passed: &Hit, order: Order) -> Hit {
        #[cfg(not(target_arch = "spirv"))]
        if let Some(wide) = self.wide {
            return wide.traverse(self, ray, passed, order);
        }
        self.traverse_compressed(ray, passed, order)
    }

    /// [`Self::traverse`] of the hierarchy that both devices have.
    ///
    /// In turns: a ray that has triangles to test tests two of them, one that has none visits a
    /// node first.
    ///
    /// Lanes of a GPU take their turns in step, so a turn takes as long as that of the busiest
    /// lane. Were all the triangles of a node tested in one turn, 32 diffuse rays in Sibenik, with
    /// 12 nodes and 6.5 triangles each, would take 20 turns with 106 tests, one lane in sixteen at
    /// work; by two a turn they take 26 turns with 47.
    #[inline(always)]
    fn traverse_compressed(&self, ray: &Ray, passed: &Hit, order: Order) -> Hit {
        let mut space = self.world(ray);
        let mut hit = Hit::miss(ray.t_max);
        let (mut stack, mut stack_inside): (Stack, Stack) = (scratch(), scratch());
        let (mut stacked, mut is_last) = (0, false);
        let mut group = Work::all_of(0).group;
        let (mut first_triangle, mut triangles) = (0, 0);
        loop {
            let is_inside = self.abilities.has(INSTANCES) && space.is_inside;
            if triangles == 0 {
                let place = 31 - group.y.leading_zeros();
                let inner_mask = group.y;
                group.y &= !(1 << place);
                if group.y & PENDING != 0 {
                    push(&mut stack, &mut stack_inside, is_inside, stacked, group);
                    stacked += 1;
                }
                let slot = (place ^ space.box_ray.octant) & 7;
                let preceding = (inner_mask & !(u32::MAX << slot) & 0xff).count_ones();
                let node = Node::load(self.rows, group.x + preceding);
                let hits = space.box_ray.intersect(&node, hit.t);
                group = UVec2::new(node.first_child(), hits & PENDING | node.inner_mask());
                triangles = hits & !PENDING;
                first_triangle = node.first_triangle();
                if group.y & PENDING == 0 {
                    if stacked == 0 {
                        is_last = true;
                    } else {
                        stacked -= 1;
                        group = top(&stack, &stack_inside, is_inside, stacked);
                    }
                }
            }
            if triangles != 0 {
                let (first, second) = take_two(first_triangle, &mut triangles);
                // Both are loaded before one is tested, so that one latency hides the other.
                let planes = (self.planes(first), self.planes(second));
                self.test(&planes.0, &space.ray, space.number(first), passed, order, &mut hit);
                self.test(&planes.1, &space.ray, space.number(second), passed, order, &mut hit);
                let left = Work { group, first_triangle, triangles, stacked, is_last };
                if order.any && hit.is_some() {
                    // Nothing is left to do.
                    triangles = 0;
                    is_last = true;
                } else if self.abilities.has(INSTANCES) && holds_instance(&planes) {
                    space = self.inside(ray, &planes, second, left);
                    Work { group, triangles, stacked, is_last, .. } = Work::all_of(space.root);
                }
            }
            let is_found = order.any && hit.is_some();
            if is_inside && is_last && triangles == 0 && !is_found {
                Work { group, first_triangle, triangles, stacked, is_last } = space.outside;
                space = self.world(ray);
            }
            if is_last && triangles == 0 {
                return hit;
            }
        }
    }

    /// Outside of all instances.
    #[inline(always)]
    fn world(&self, ray: &Ray) -> Space {
        let (box_ray, outside) = (BoxRay::new(ray, self.world_width()), Work::NOTHING);
        Space { ray: *ray, box_ray, root: 0, shift: 0, is_inside: false, outside }
    }

    /// By how many roundings a ray is wide there.
    #[inline(always)]
    fn world_width(&self) -> f32 {
        if self.abilities.has(INSTANCES) { self.instances.ray_width() } else { RAY_WIDTH }
    }

    /// In the instance that one of two leaf entries is, from where `ray` goes back to what it has
    /// `left`. If both are instances, that is one of them: the `second` in number.
    #[inline(always)]
    fn inside(&self, ray: &Ray, entries: &(Planes, Planes), second: u32, left: Work) -> Space {
        let (mut index, next) = (instance_of_leaf(&entries.0), instance_of_leaf(&entries.1));
        let mut outside = left;
        if index == NO_INSTANCE {
            index = next;
        } else if next != NO_INSTANCE && next != index {
            outside.triangles |= 1 << (second - left.first_triangle);
        }
        let ray = self.instances.ray(index, ray);
        let (root, shift) = (self.instances.span(index).root, self.instances.shift(index));
        let box_ray = BoxRay::new(&ray, RAY_WIDTH);
        Space { ray, box_ray, root, shift, is_inside: true, outside }
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
        self.consider(Hit { t, u, v, triangle: index }, passed, order, hit);
    }

    /// [`Self::test`] of a triangle that meets the ray there; in front of it if `t > 0`.
    #[inline(always)]
    fn consider(&self, candidate: Hit, passed: &Hit, order: Order, hit: &mut Hit) {
        let Hit { t, triangle, .. } = candidate;
        let is_nearer = t > 0.0 && t < hit.t;
        let is_hit = is_nearer || !order.any && t == hit.t && self.precedes(triangle, hit.triangle);
        let is_behind = !order.behind
            || t > passed.t
            || t == passed.t && self.follows(triangle, passed.triangle);
        if is_hit && is_behind {
            *hit = candidate;
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

    /// The number in the scene of the triangle that has this number as a [hit](Hit::triangle).
    pub fn scene_triangle(&self, number: u32) -> u32 {
        let Place { entry, instance } = self.place(number);
        let triangle = word(self.rows, self.first_order, entry);
        if instance == NO_INSTANCE {
            return triangle;
        }
        self.instances.span(instance).first_in_scene + triangle
    }

    /// Where what belongs to a hit of this number lies.
    #[inline(always)]
    pub fn place(&self, number: u32) -> Place {
        if self.abilities.has(INSTANCES) {
            self.instances.place(number)
        } else {
            Place { entry: number, instance: NO_INSTANCE }
        }
    }

    /// The table of instances.
    #[inline(always)]
    pub fn instances(&self) -> &InstanceView<'a> {
        &self.instances
    }

    /// Whether something is in an instance.
    #[inline(always)]
    pub fn is_in_instance(&self, place: &Place) -> bool {
        self.abilities.has(INSTANCES) && place.instance != NO_INSTANCE
    }

    /// A ray as what lies there is tested with it.
    #[inline(always)]
    pub fn ray_at(&self, place: &Place, ray: &Ray) -> Ray {
        if self.is_in_instance(place) { self.instances.ray(place.instance, ray) } else { *ray }
    }

    /// The leaf entry of this number, in the space that it is in.
    #[inline(always)]
    pub fn planes(&self, entry: u32) -> Planes {
        Planes { rows: three_rows(self.rows, self.first_planes + entry * Planes::ROWS) }
    }

    /// The plane of a leaf entry, in the space that it is in.
    #[inline(always)]
    pub fn plane_of_entry(&self, entry: u32) -> Plane {
        Plane::from_row(at(self.rows, self.first_planes + entry * Planes::ROWS))
    }

    /// The plane that lies there, in the world.
    #[inline(always)]
    pub fn plane_at(&self, place: &Place) -> Plane {
        let plane = self.plane_of_entry(place.entry);
        if !self.is_in_instance(place) {
            return plane;
        }
        let inward = self.instances.inward(place.instance);
        // normal . (M x + m) = offset
        let normal = inward.transposed(plane.normal);
        let moved = plane.offset - plane.normal.dot(inward.point(Vec3::ZERO));
        let length = normal.length();
        Plane { normal: normal / length, offset: moved / length }
    }

    /// The plane of what was hit, in the world.
    #[inline(always)]
    pub fn plane(&self, number: u32) -> Plane {
        self.plane_at(&self.place(number))
    }
}
