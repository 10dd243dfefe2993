//! The way of one ray through the hierarchy.

use super::super::node::{BoxRay, RAY_WIDTH};
use super::super::{BvhView, Order};
#[cfg(target_arch = "x86_64")]
use super::lanes::{Avx2, Avx512, One256, One512};
use super::lanes::{Baseline, Lanes, Two128};
use super::{INSTANCE, LEAF, LEAF_TRIANGLES, Leaf, MAX_BESIDE, NUMBERS, Node, Tree, WAY_OUT};
use crate::glam::Vec3;
use crate::scene::abilities::{Abilities, INSTANCES};
use crate::scene::ray::{Hit, Ray};
use arrayvec::ArrayVec;

/// What a ray has still to visit, and where it enters that.
#[derive(Clone, Copy)]
struct Pending {
    child: u32,
    t: f32,
}

/// Room for what lies beside the path of a ray in the scene's hierarchy and in a shape's, and for
/// the way out of that.
type Stack = ArrayVec<Pending, { 2 * MAX_BESIDE + 2 }>;

/// [`traverse`] by registers of 128 bits.
pub fn simd128<A: Abilities, const ANY: bool, const BEHIND: bool>(
    proof: Baseline,
    tree: &Tree<8>,
    view: &BvhView<'_, A>,
    ray: &Ray,
    passed: &Hit,
) -> Hit {
    let proofs = (proof, proof);
    traverse::<A, Two128, Two128, 8, ANY, BEHIND>(proofs, tree, view, ray, passed)
}

/// [`traverse`] by registers of 256 bits.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt")]
pub fn avx2<A: Abilities, const ANY: bool, const BEHIND: bool>(
    proof: Avx2,
    tree: &Tree<8>,
    view: &BvhView<'_, A>,
    ray: &Ray,
    passed: &Hit,
) -> Hit {
    let proofs = (proof, proof);
    traverse::<A, One256, One256, 8, ANY, BEHIND>(proofs, tree, view, ray, passed)
}

/// [`traverse`] by registers of 512 bits.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512vl,avx2,bmi1,bmi2,lzcnt,popcnt")]
pub fn avx512<A: Abilities, const ANY: bool, const BEHIND: bool>(
    proof: Avx512,
    tree: &Tree<16>,
    view: &BvhView<'_, A>,
    ray: &Ray,
    passed: &Hit,
) -> Hit {
    let proofs = (proof, proof.avx2());
    traverse::<A, One512, One256, 16, ANY, BEHIND>(proofs, tree, view, ray, passed)
}

/// The hit of a ray by [`BvhView::traverse`]: nearest children first, each tested against the ray
/// up to the nearest hit so far.
///
/// `B` are the lanes of boxes, `T` those of triangles.
#[inline(always)]
fn traverse<A, B, T, const N: usize, const ANY: bool, const BEHIND: bool>(
    proofs: (B::Proof, T::Proof),
    tree: &Tree<N>,
    view: &BvhView<'_, A>,
    ray: &Ray,
    passed: &Hit,
) -> Hit
where
    A: Abilities,
    B: Lanes<N>,
    T: Lanes<LEAF_TRIANGLES>,
{
    let order = Order { any: ANY, behind: BEHIND };
    let outside = Space::<B, T, N>::new(proofs, ray, view.world_width(), 0);
    let mut space = outside;
    let mut hit = Hit::miss(ray.t_max);
    let mut stack = Stack::new();
    let mut current = 0;
    loop {
        if current < NUMBERS {
            let node = &tree.nodes[current as usize];
            let (entered, enter) = space.enter(proofs.0, node, hit.t);
            if entered != 0 {
                current = push_all_but_nearest::<N, ANY>(&mut stack, node, entered, enter);
                continue;
            }
        } else if current < INSTANCE {
            let leaf = &tree.leaves[(current - LEAF) as usize];
            space.test(proofs.1, leaf, view, passed, order, &mut hit);
            if ANY && hit.is_some() {
                return hit;
            }
        } else if view.abilities.has(INSTANCES) {
            if current == WAY_OUT {
                space = outside;
            } else {
                let index = current - INSTANCE;
                let shift = view.instances.shift(index);
                let inside = view.instances.ray(index, ray);
                space = Space::new(proofs, &inside, RAY_WIDTH, shift);
                stack.push(Pending { child: WAY_OUT, t: f32::NEG_INFINITY });
                current = tree.roots[index as usize];
                continue;
            }
        }
        loop {
            let Some(next) = stack.pop() else { return hit };
            current = next.child;
            // Any hit ends the search, so nothing is nearer.
            if ANY || next.t <= hit.t {
                break;
            }
        }
    }
}

/// Puts all children of a node that a ray has `entered` on the stack, farthest first, but for the
/// nearest, which it returns. If any hit will do their order does not matter.
#[inline(always)]
fn push_all_but_nearest<const N: usize, const ANY: bool>(
    stack: &mut Stack,
    node: &Node<N>,
    mut entered: u32,
    enter: impl FnOnce() -> [f32; N],
) -> u32 {
    let first = entered.trailing_zeros() as usize % N;
    entered &= entered - 1;
    if entered == 0 {
        return node.children[first];
    }
    let distances = if ANY { [0.0; N] } else { enter() };
    let mut nearest = Pending { child: node.children[first], t: distances[first] };
    let base = stack.len();
    while entered != 0 {
        let place = entered.trailing_zeros() as usize % N;
        entered &= entered - 1;
        let mut farther = Pending { child: node.children[place], t: distances[place] };
        if !ANY && farther.t < nearest.t {
            core::mem::swap(&mut nearest, &mut farther);
        }
        stack.push(farther);
        if ANY {
            continue;
        }
        let mut at = stack.len() - 1;
        while at > base && stack[at - 1].t < farther.t {
            stack[at] = stack[at - 1];
            at -= 1;
        }
        stack[at] = farther;
    }
    nearest.child
}

/// A ray in the world or in the space of a shape, as the tests take it.
#[derive(Clone, Copy)]
struct Space<B, T, const N: usize> {
    /// The planes that the ray meets first, for each axis, and those that it meets last: rows of
    /// [`Node::planes`].
    near: [usize; 3],
    far: [usize; 3],
    /// Where the ray begins, moved towards where it goes by its width, and against that.
    ahead: [B; 3],
    behind: [B; 3],
    inverse_direction: [B; 3],
    origin: [T; 3],
    direction: [T; 3],
    /// What is added to the number of a leaf's entry to make that of a hit.
    shift: u32,
}

impl<B: Lanes<N>, T: Lanes<LEAF_TRIANGLES>, const N: usize> Space<B, T, N> {
    /// That of `ray`, which is so many `roundings` wide. See [`BoxRay`], which has the proof: its
    /// width is here in the origin, whose rounding it has room for.
    #[inline(always)]
    fn new(proofs: (B::Proof, T::Proof), ray: &Ray, roundings: f32, shift: u32) -> Self {
        let BoxRay { origin, inverse_direction, width, .. } = BoxRay::new(ray, roundings);
        let forwards = Vec3::ONE.copysign(inverse_direction) * width;
        let boxes = |v: Vec3| v.to_array().map(|x| B::splat(proofs.0, x));
        let triangles = |v: Vec3| v.to_array().map(|x| T::splat(proofs.1, x));
        let backwards = inverse_direction.to_array().map(|x| usize::from(x < 0.0));
        Self {
            near: core::array::from_fn(|axis| 2 * axis + backwards[axis]),
            far: core::array::from_fn(|axis| 2 * axis + 1 - backwards[axis]),
            ahead: boxes(origin + forwards),
            behind: boxes(origin - forwards),
            inverse_direction: boxes(inverse_direction),
            origin: triangles(ray.origin),
            direction: triangles(ray.direction),
            shift,
        }
    }

    /// A bit for each child of a node that the ray enters up to `t_max`, and where it does.
    #[inline(always)]
    fn enter(
        &self,
        proof: B::Proof,
        node: &Node<N>,
        t_max: f32,
    ) -> (u32, impl FnOnce() -> [f32; N]) {
        let plane = |row: usize, origin: B, axis: usize| {
            (B::load(proof, &node.planes[row]) - origin) * self.inverse_direction[axis]
        };
        let near = |axis: usize| plane(self.near[axis], self.ahead[axis], axis);
        let far = |axis: usize| plane(self.far[axis], self.behind[axis], axis);
        let enter = near(0).max(near(1)).max(near(2).max(B::splat(proof, 0.0)));
        let leave = far(0).min(far(1)).min(far(2).min(B::splat(proof, t_max)));
        (B::bits(enter.le(leave)), move || enter.to_array())
    }

    /// [`BvhView::test`] for all triangles of a leaf.
    #[inline(always)]
    fn test(
        &self,
        proof: T::Proof,
        leaf: &Leaf,
        view: &BvhView<'_, impl Abilities>,
        passed: &Hit,
        order: Order,
        hit: &mut Hit,
    ) {
        let row = |row: usize| T::load(proof, &leaf.planes[row]);
        let dot = |first: usize, [x, y, z]: [T; 3]| {
            row(first) * x + row(first + 1) * y + row(first + 2) * z
        };
        let t = (row(3) - dot(0, self.origin)) / dot(0, self.direction);
        let point: [T; 3] =
            core::array::from_fn(|axis| self.origin[axis] + self.direction[axis] * t);
        let u = dot(4, point) + row(7);
        let v = dot(8, point) + row(11);
        let [zero, one] = [0.0, 1.0].map(|x| T::splat(proof, x));
        let inside = zero.le(u) & zero.le(v) & (u + v).le(one);
        let mut found = T::bits(inside & zero.lt(t) & t.le(T::splat(proof, hit.t)));
        if found == 0 {
            return;
        }
        let (t, u, v) = (t.to_array(), u.to_array(), v.to_array());
        while found != 0 {
            let place = found.trailing_zeros() as usize % LEAF_TRIANGLES;
            found &= found - 1;
            let triangle = leaf.entries[place].wrapping_add(self.shift);
            let candidate = Hit { t: t[place], u: u[place], v: v[place], triangle };
            view.consider(candidate, passed, order, hit);
        }
    }
}
