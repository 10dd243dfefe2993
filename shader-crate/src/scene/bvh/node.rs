//! Nodes, and the test of a ray against the boxes of a node's children.
//!
//! The nodes are those of the crate obvhs: 80 bytes, read here as five rows,
//!
//! ```text
//! 0: origin xyz (f32), exponents of the grid x | y | z and the mask of inner children (a byte each)
//! 1: first child node, first triangle, meta of children 0-3, of children 4-7
//! 2: min x of children 0-3, 4-7, max x of children 0-3, 4-7
//! 3, 4: the same for y and z
//! ```

use crate::glam::{UVec4, Vec3, Vec4};
use crate::math::UNIT_ROUNDOFF;
use crate::memory::access::at;
use crate::scene::ray::Ray;

/// Smallest magnitude of a direction's component in the box test: with it the reciprocal stays
/// finite and an axis-parallel ray gives large numbers of the right sign, not NaN.
const MIN_DIRECTION: f32 = 1e-18;
/// By how many roundings of the largest coordinate of its origin a ray is taken to be wide, see
/// [`BoxRay`].
pub const RAY_WIDTH: f32 = 32.0;
/// By how many roundings of its largest coordinate a triangle's box has to be wider than what its
/// test accepts, see [`BoxRay`].
pub const BOX_ROUNDINGS: f32 = 32.0;

/// One node, as it lies in memory.
#[derive(Clone, Copy)]
pub struct Node {
    grid: UVec4,
    children: UVec4,
    x: UVec4,
    y: UVec4,
    z: UVec4,
}

impl Node {
    /// Rows of one.
    pub const ROWS: u32 = 5;

    /// The node number `index`.
    pub fn load(rows: &[UVec4], index: u32) -> Self {
        let first = index * Self::ROWS;
        Self {
            grid: at(rows, first),
            children: at(rows, first + 1),
            x: at(rows, first + 2),
            y: at(rows, first + 3),
            z: at(rows, first + 4),
        }
    }

    /// Number of its first inner child; the others follow.
    pub fn first_child(&self) -> u32 {
        self.children.x
    }

    /// Number of the first triangle of its leaves.
    pub fn first_triangle(&self) -> u32 {
        self.children.y
    }

    /// A bit for each child slot that has an inner node.
    pub fn inner_mask(&self) -> u32 {
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
///
/// **No box hides a hit.** Let a triangle's test find a hit at `t` on a ray from `o` along `d`, let
/// `p` be the point that it computed, `u` = 2^-24, and `n` the plane's unit normal.
///
/// - `p` passed as inside the triangle, so it lies over what the test accepts, the triangle with
///   its own roundings.
/// - `p` lies off the plane by the error of `t` times `n . d`: three roundings of
///   `|n| . |o|`, three of `t |n| . |d|`, where `t |d| <= |o| + |p|`, and up to five of
///   `c - n . o`, where a driver's division has five. With `|n.x| + |n.y| + |n.z| <= sqrt(3)` that
///   is below 20 u of each of the largest coordinates of `o` and of `p`.
/// - In each axis `p` is `o + t d` but for a rounding of `t d` and one of the sum, and the test of
///   a plane of a box at `x` has an error of up to ten roundings of `x - o`, again in the plane's
///   place: below 12 u of each.
///
/// What is relative to `p` is in the boxes ([`BOX_ROUNDINGS`], and the steps of a node's grid, see
/// the host), what is relative to `o` is the width of the ray. Both are 32 u.
#[derive(Clone, Copy)]
pub struct BoxRay {
    /// Where it starts, in world units.
    pub origin: Vec3,
    /// One over each component of its direction, finite and not zero.
    pub inverse_direction: Vec3,
    /// Half of its width, in world units.
    pub width: f32,
    /// The place of child slot k in this ray's order is `k ^ octant`: bits 2, 1, 0 are set where x,
    /// y, z grow along the ray.
    pub octant: u32,
}

impl BoxRay {
    /// Prepares the tests of `ray`, which is so many `roundings` wide: [`RAY_WIDTH`], or as much as
    /// [instances](super::instance) ask for.
    #[inline(always)]
    pub fn new(ray: &Ray, roundings: f32) -> Self {
        let d = ray.direction;
        let inverse_direction =
            Vec3::new(finite_inverse(d.x), finite_inverse(d.y), finite_inverse(d.z));
        let grows = |inverse: f32, bit: u32| if inverse < 0.0 { 0 } else { bit };
        Self {
            origin: ray.origin,
            inverse_direction,
            width: roundings * UNIT_ROUNDOFF * ray.origin.abs().max_element(),
            octant: grows(inverse_direction.x, 4)
                | grows(inverse_direction.y, 2)
                | grows(inverse_direction.z, 1),
        }
    }

    /// The children of `node` that the ray enters before `t_max`: bit 24 + k for the inner child at
    /// place k, and a bit of the lower 24 for every triangle of a leaf.
    #[inline(always)]
    pub fn intersect(&self, node: &Node, t_max: f32) -> u32 {
        let scale = node.step() * self.inverse_direction;
        let offset = (node.origin() - self.origin) * self.inverse_direction;
        let width = self.inverse_direction.abs() * self.width;
        let (enters, leaves) = (offset - width, offset + width);
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
                larger(plane(near[0], scale.x, enters.x), plane(near[1], scale.y, enters.y)),
                larger(plane(near[2], scale.z, enters.z), Vec4::ZERO),
            );
            let leave = smaller(
                smaller(plane(far[0], scale.x, leaves.x), plane(far[1], scale.y, leaves.y)),
                smaller(plane(far[2], scale.z, leaves.z), Vec4::splat(t_max)),
            );
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
