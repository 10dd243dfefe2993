//! Instances: shapes that stand in the scene at several places, and once in memory.
//!
//! The hierarchy of the scene has in its leaves, beside triangles, instances: rows of a triangle's
//! size that no ray hits, and that name an instance. A ray that comes to one goes on with the nodes
//! of the shape, in the space of the shape, and comes back for what it has left to do outside. Its
//! direction keeps the length that the transform gives it, so distances are those of the world.
//!
//! A hit has a **number**. Up to that of the leaf entries of the scene's own hierarchy it is that
//! of an entry; above, each instance has as many numbers as its shape has entries.
//!
//! ```text
//! header:   instances, leaf entries of the scene's own hierarchy, width of rays in roundings, 0
//! instance: x, y, z of a point in the shape's space: gradient in the world, offset
//!           | first node, first number, first entry, first number in the scene
//!           | x, y, z of a point in the world: gradient in the shape's space, offset
//!           | clearance: factor, spread in world units; scale, is mirrored
//! leaf:     1 0 0, 0 | 0 0 0, -1 | mark, instance, 0, 0
//! ```

use super::planes::Planes;
use crate::glam::{UVec4, Vec3};
use crate::math::packed::{NO_TANGENT, Tangent};
use crate::memory::access::at;
use crate::memory::rows::{float, row, three_rows, vector};
use crate::scene::ray::Ray;
use crate::scene::triangle::{Attributes, Tangents};
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

/// The instance of what is in the scene itself.
pub const NO_INSTANCE: u32 = u32::MAX;

/// A word that no triangle has at this place: no number.
const MARK: u32 = u32::MAX;

/// The rows of a leaf that stands for instance number `index`: as a triangle, none that is hit.
pub fn leaf_rows(index: u32) -> [UVec4; Planes::ROWS as usize] {
    [row(Vec3::X, 0), row(Vec3::ZERO, (-1.0_f32).to_bits()), UVec4::new(MARK, index, 0, 0)]
}

/// The instance that a leaf's rows stand for; [`NO_INSTANCE`] if they are a triangle.
#[inline(always)]
pub fn instance_of_leaf(leaf: &Planes) -> u32 {
    let [_, _, last] = leaf.rows;
    if last.x == MARK { last.y } else { NO_INSTANCE }
}

/// An affine map, as three rows.
#[derive(Clone, Copy)]
pub struct Affine {
    /// The gradient of each coordinate, and its offset.
    pub rows: [UVec4; 3],
}

impl Affine {
    /// Where a point goes.
    #[inline(always)]
    pub fn point(&self, p: Vec3) -> Vec3 {
        let [x, y, z] = self.rows;
        self.vector(p) + Vec3::new(float(x), float(y), float(z))
    }

    /// Where a vector goes.
    #[inline(always)]
    pub fn vector(&self, v: Vec3) -> Vec3 {
        let [x, y, z] = self.rows;
        Vec3::new(vector(x).dot(v), vector(y).dot(v), vector(z).dot(v))
    }

    /// The product of the transposed linear part with `v`: where a normal comes from.
    #[inline(always)]
    pub fn transposed(&self, v: Vec3) -> Vec3 {
        let [x, y, z] = self.rows;
        vector(x) * v.x + vector(y) * v.y + vector(z) * v.z
    }
}

/// Where what belongs to a hit lies.
#[derive(Clone, Copy)]
pub struct Place {
    /// The triangle's entry, in the order of the leaves.
    pub entry: u32,
    /// The instance whose shape it is of, or [`NO_INSTANCE`].
    pub instance: u32,
}

/// What an instance's numbers begin with.
#[derive(Clone, Copy)]
pub struct Span {
    /// Number of the shape's root among the nodes.
    pub root: u32,
    /// Its first number.
    pub first: u32,
    /// The first leaf entry of its shape.
    pub first_entry: u32,
    /// The number in the scene of its first triangle.
    pub first_in_scene: u32,
}

/// The table of instances.
#[derive(Clone, Copy)]
pub struct InstanceView<'a> {
    /// The scene's buffer `geometry`, see [`crate::scene`].
    pub rows: &'a [UVec4],
    /// Row of the header.
    pub first: u32,
}

impl InstanceView<'_> {
    /// Rows of one.
    pub const ROWS: u32 = 8;

    fn row(&self, index: u32, row: u32) -> u32 {
        self.first + 1 + index * Self::ROWS + row
    }

    /// By how many roundings of its origin's largest coordinate a ray is taken to be wide outside
    /// of instances.
    #[inline(always)]
    pub fn ray_width(&self) -> f32 {
        f32::from_bits(at(self.rows, self.first).z)
    }

    /// From the world to the space of the shape.
    #[inline(always)]
    pub fn inward(&self, index: u32) -> Affine {
        Affine { rows: three_rows(self.rows, self.row(index, 0)) }
    }

    /// From the space of the shape to the world.
    #[inline(always)]
    pub fn outward(&self, index: u32) -> Affine {
        Affine { rows: three_rows(self.rows, self.row(index, 4)) }
    }

    /// Where its numbers begin.
    #[inline(always)]
    pub fn span(&self, index: u32) -> Span {
        let row = at(self.rows, self.row(index, 3));
        Span { root: row.x, first: row.y, first_entry: row.z, first_in_scene: row.w }
    }

    /// What is added to the number of one of its shape's leaf entries to make that of a hit.
    #[inline(always)]
    pub fn shift(&self, index: u32) -> u32 {
        let Span { first, first_entry, .. } = self.span(index);
        first.wrapping_sub(first_entry)
    }

    /// The factor and the spread of [`Clearance`](crate::scene::ray::Clearance), how many times as
    /// long vectors become in the space of the shape at most, and whether left becomes right.
    #[inline(always)]
    pub fn measures(&self, index: u32) -> Measures {
        let row = at(self.rows, self.row(index, 7));
        Measures {
            factor: f32::from_bits(row.x),
            spread: f32::from_bits(row.y),
            scale: f32::from_bits(row.z),
            is_mirrored: row.w != 0,
        }
    }

    /// A ray in the space of the shape.
    #[inline(always)]
    pub fn ray(&self, index: u32, ray: &Ray) -> Ray {
        let inward = self.inward(index);
        Ray::segment(inward.point(ray.origin), inward.vector(ray.direction), ray.t_max)
    }

    /// Where what belongs to a hit of this number lies.
    #[inline(always)]
    pub fn place(&self, number: u32) -> Place {
        let header = at(self.rows, self.first);
        if number < header.y {
            return Place { entry: number, instance: NO_INSTANCE };
        }
        // The number is not before the first of `low`, and is before the first of `high`.
        let mut low = 0;
        let mut high = header.x;
        while high - low > 1 {
            let middle = (low + high) / 2;
            if self.span(middle).first <= number {
                low = middle;
            } else {
                high = middle;
            }
        }
        let span = self.span(low);
        Place { entry: number - span.first + span.first_entry, instance: low }
    }

    /// Attributes of a triangle of the shape as they are in the world.
    pub fn attributes(&self, index: u32, of_shape: &Attributes) -> Attributes {
        let inward = self.inward(index);
        Attributes {
            normal0: unit(inward.transposed(of_shape.normal0)),
            normal1: unit(inward.transposed(of_shape.normal1)),
            normal2: unit(inward.transposed(of_shape.normal2)),
            tangent: self.tangent(index, of_shape.tangent),
            ..*of_shape
        }
    }

    /// The same of the tangents at a triangle's corners.
    #[inline(always)]
    pub fn tangents(&self, index: u32, of_shape: &Tangents) -> Tangents {
        let [a, b, c] = of_shape.corners;
        let corners = [self.tangent(index, a), self.tangent(index, b), self.tangent(index, c)];
        Tangents { corners, pad: 0 }
    }

    /// The same of one tangent, packed.
    #[inline(always)]
    fn tangent(&self, index: u32, of_shape: u32) -> u32 {
        if of_shape == NO_TANGENT {
            return NO_TANGENT;
        }
        let Tangent { direction, is_mirrored } = Tangent::unpack(of_shape);
        let direction = self.outward(index).vector(direction).normalize();
        let is_mirrored = is_mirrored != self.measures(index).is_mirrored;
        Tangent { direction, is_mirrored }.pack()
    }
}

/// How an instance changes lengths.
#[derive(Clone, Copy)]
pub struct Measures {
    /// See [`Clearance::roundings`](crate::scene::ray::Clearance::roundings), which is so many
    /// times as large.
    pub factor: f32,
    /// See [`Clearance::spread`](crate::scene::ray::Clearance::spread).
    pub spread: f32,
    /// How many times as long a vector becomes in the space of the shape, at most.
    pub scale: f32,
    /// Whether left becomes right.
    pub is_mirrored: bool,
}

/// The unit vector; zero stays zero.
fn unit(v: Vec3) -> Vec3 {
    let length = v.length_squared();
    if length > 0.0 { v / length.sqrt() } else { Vec3::ZERO }
}
