//! Traversal of the compressed wide BVH.
//!
//! Ylitie, Karras and Laine, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide
//! BVHs", HPG 2017. The nodes are those of the crate obvhs: 80 bytes, read here as five `uvec4`s,
//!
//! ```text
//! 0: origin xyz (f32), exponents of the grid x | y | z and the mask of inner children (a byte each)
//! 1: first child node, first triangle, meta of children 0-3, of children 4-7
//! 2: min x of children 0-3, 4-7, max x of children 0-3, 4-7
//! 3, 4: the same for y and z
//! ```
//!
//! A ray's work is two groups of bits. A **node group** is (first child, hits << 24 | inner mask):
//! bit 24 + k is a child still to visit, k its place in the order in which this ray's octant visits
//! children, nearest highest. A **triangle group** is (first triangle, a bit for each triangle
//! still to test).

use crate::glam::{UVec2, UVec4, Vec3, Vec4};
use crate::memory::access::{at, local, local_mut, scratch};
use crate::scene::ray::{Hit, Ray};
use crate::scene::triangle::TriangleView;

/// `uvec4`s of one node.
pub const ROWS_PER_NODE: u32 = 5;
/// Deepest hierarchy that can be traversed, in nodes on one path from the root: each of them leaves
/// at most one group on the stack. Whoever builds a [`BvhView`]'s buffer checks it.
pub const MAX_DEPTH: u32 = 32;

/// A node group's bits of children still to visit.
const PENDING: u32 = 0xff00_0000;
/// Smallest magnitude of a direction's component in the box test: with it the reciprocal stays
/// finite and an axis-parallel ray gives large numbers of the right sign, not NaN.
const MIN_DIRECTION: f32 = 1e-18;
/// Widens a box's exit by the roundings of its test, so that a ray through an edge that two boxes
/// share hits one.
const WIDEN: f32 = 1.000_001;

/// The BVH of a scene and the triangles in its leaves.
#[derive(Clone, Copy)]
pub struct BvhView<'a> {
    nodes: &'a [UVec4],
    triangles: TriangleView<'a>,
}

impl<'a> BvhView<'a> {
    /// Wraps the buffers. `nodes` has at least the root, no path longer than [`MAX_DEPTH`], and
    /// only indices that are in range.
    pub fn new(nodes: &'a [UVec4], triangles: &'a [UVec4]) -> Self {
        Self { nodes, triangles: TriangleView::new(triangles) }
    }

    /// The nearest triangle that `ray` hits in `0 < t < ray.t_max`.
    pub fn closest_hit(&self, ray: &Ray) -> Hit {
        self.traverse::<false>(ray)
    }

    /// Whether `ray` hits any triangle in `0 < t < ray.t_max`.
    pub fn is_occluded(&self, ray: &Ray) -> bool {
        self.traverse::<true>(ray).is_some()
    }

    /// In turns: a ray that has triangles to test tests two of them, one that has none visits a
    /// node first.
    ///
    /// Lanes of a GPU take their turns in step, so a turn takes as long as that of the busiest
    /// lane. Were all the triangles of a node tested in one turn, 32 diffuse rays in Sibenik, with
    /// 12 nodes and 6.5 triangles each, would take 20 turns with 106 tests, one lane in sixteen at
    /// work; by two a turn they take 26 turns with 47.
    #[inline(always)]
    fn traverse<const ANY_HIT: bool>(&self, ray: &Ray) -> Hit {
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
                let node = self.node(group.x + preceding);
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
                let second = if triangles == 0 {
                    first
                } else {
                    first_triangle + triangles.trailing_zeros()
                };
                triangles &= triangles.wrapping_sub(1);
                // Both are loaded before one is tested, so that one latency hides the other.
                let planes = (self.triangles.planes(first), self.triangles.planes(second));
                planes.0.test(ray, first, &mut hit);
                planes.1.test(ray, second, &mut hit);
                if ANY_HIT && hit.is_some() {
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

    fn node(&self, index: u32) -> Node {
        let first = index * ROWS_PER_NODE;
        Node {
            grid: at(self.nodes, first),
            children: at(self.nodes, first + 1),
            x: at(self.nodes, first + 2),
            y: at(self.nodes, first + 3),
            z: at(self.nodes, first + 4),
        }
    }
}

/// One node, as it lies in memory.
#[derive(Clone, Copy)]
struct Node {
    grid: UVec4,
    children: UVec4,
    x: UVec4,
    y: UVec4,
    z: UVec4,
}

impl Node {
    fn first_child(&self) -> u32 {
        self.children.x
    }

    fn first_triangle(&self) -> u32 {
        self.children.y
    }

    fn inner_mask(&self) -> u32 {
        self.grid.w >> 24
    }

    /// Corner of the grid of child boxes.
    fn origin(&self) -> Vec3 {
        Vec3::new(
            f32::from_bits(self.grid.x),
            f32::from_bits(self.grid.y),
            f32::from_bits(self.grid.z),
        )
    }

    /// Step of the grid of child boxes.
    fn step(&self) -> Vec3 {
        let e = self.grid.w;
        Vec3::new(
            f32::from_bits((e & 0xff) << 23),
            f32::from_bits((e >> 8 & 0xff) << 23),
            f32::from_bits((e >> 16 & 0xff) << 23),
        )
    }
}

/// What the box test needs of a ray.
#[derive(Clone, Copy)]
struct BoxRay {
    origin: Vec3,
    inverse_direction: Vec3,
    /// The place of child slot k in this ray's order is `k ^ octant`: bits 2, 1, 0 are set where x,
    /// y, z grow along the ray.
    octant: u32,
}

impl BoxRay {
    fn new(ray: &Ray) -> Self {
        let d = ray.direction;
        let inverse_direction =
            Vec3::new(finite_inverse(d.x), finite_inverse(d.y), finite_inverse(d.z));
        let grows = |inverse: f32, bit: u32| if inverse < 0.0 { 0 } else { bit };
        Self {
            origin: ray.origin,
            inverse_direction,
            octant: grows(inverse_direction.x, 4)
                | grows(inverse_direction.y, 2)
                | grows(inverse_direction.z, 1),
        }
    }

    /// The children of `node` that the ray enters before `t_max`: bit 24 + k for the inner child at
    /// place k, and a bit of the lower 24 for every triangle of a leaf.
    #[inline(always)]
    fn intersect(&self, node: &Node, t_max: f32) -> u32 {
        let scale = node.step() * self.inverse_direction;
        let offset = (node.origin() - self.origin) * self.inverse_direction;
        // Near and far planes: min and max swap where the ray runs backwards.
        let order = |planes: UVec4, inverse: f32| {
            if inverse < 0.0 { UVec4::new(planes.z, planes.w, planes.x, planes.y) } else { planes }
        };
        let x = order(node.x, self.inverse_direction.x);
        let y = order(node.y, self.inverse_direction.y);
        let z = order(node.z, self.inverse_direction.z);

        let entered = |near: [u32; 3], far: [u32; 3]| {
            let plane =
                |word: u32, scale: f32, offset: f32| bytes(word) * scale + Vec4::splat(offset);
            let enter = larger(
                larger(plane(near[0], scale.x, offset.x), plane(near[1], scale.y, offset.y)),
                larger(plane(near[2], scale.z, offset.z), Vec4::ZERO),
            );
            let leave = smaller(
                smaller(plane(far[0], scale.x, offset.x), plane(far[1], scale.y, offset.y)),
                smaller(plane(far[2], scale.z, offset.z), Vec4::splat(t_max)),
            ) * WIDEN;
            (enter, leave)
        };
        let meta = [node.children.z, node.children.w];
        self.place(meta[0], entered([x.x, y.x, z.x], [x.z, y.z, z.z]))
            | self.place(meta[1], entered([x.y, y.y, z.y], [x.w, y.w, z.w]))
    }

    /// The bits of four children, of those that are entered (`enter <= leave`).
    ///
    /// `meta` has a byte for each. Of a leaf its upper three bits are as many ones as it has
    /// triangles, and the lower five say where the first of them stands; an inner child has a
    /// single one and stands at 24 + its slot; an empty slot is zero.
    #[inline(always)]
    fn place(&self, meta: u32, (enter, leave): (Vec4, Vec4)) -> u32 {
        let inner = (meta & meta << 1) >> 4 & 0x0101_0101;
        // Inner children move to their place in this ray's order.
        let places = meta ^ (inner * self.octant);
        let bits = |child: u32, enter: f32, leave: f32| {
            let byte = meta >> (8 * child);
            if enter <= leave { (byte >> 5 & 7) << (places >> (8 * child) & 0x1f) } else { 0 }
        };
        bits(0, enter.x, leave.x)
            | bits(1, enter.y, leave.y)
            | bits(2, enter.z, leave.z)
            | bits(3, enter.w, leave.w)
    }
}

/// `1 / x`, finite also for zeros, of x's sign.
fn finite_inverse(x: f32) -> f32 {
    let magnitude = x.abs().max(MIN_DIRECTION);
    1.0 / if x < 0.0 { -magnitude } else { magnitude }
}

/// The four bytes of a word, lowest first.
#[inline(always)]
fn bytes(word: u32) -> Vec4 {
    UVec4::new(word & 0xff, word >> 8 & 0xff, word >> 16 & 0xff, word >> 24).as_vec4()
}

/// The larger of two numbers, by component, once 0 is among those compared; until then, of two
/// negative ones either.
///
/// Read as integers, floats that are not negative keep their order, and negative ones come before
/// them. A GPU compares integers faster (NVIDIA's find the largest of three at once), a processor's
/// vectors floats.
#[inline(always)]
fn larger(a: Vec4, b: Vec4) -> Vec4 {
    #[cfg(not(target_arch = "spirv"))]
    return a.max(b);
    #[cfg(target_arch = "spirv")]
    by_bits(a, b, i32::max)
}

/// The smaller of two numbers, by component; of two negative ones either.
#[inline(always)]
fn smaller(a: Vec4, b: Vec4) -> Vec4 {
    #[cfg(not(target_arch = "spirv"))]
    return a.min(b);
    #[cfg(target_arch = "spirv")]
    by_bits(a, b, i32::min)
}

#[cfg(target_arch = "spirv")]
#[inline(always)]
fn by_bits(a: Vec4, b: Vec4, choose: impl Fn(i32, i32) -> i32) -> Vec4 {
    let choose =
        |a: f32, b: f32| f32::from_bits(choose(a.to_bits() as i32, b.to_bits() as i32) as u32);
    Vec4::new(choose(a.x, b.x), choose(a.y, b.y), choose(a.z, b.z), choose(a.w, b.w))
}
