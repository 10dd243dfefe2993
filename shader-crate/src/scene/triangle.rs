//! Triangles as shading looks them up, in the order of the BVH's leaves. Traversal has its own form
//! of them, see [`crate::scene::bvh::planes`].
//!
//! ```text
//! triangle:   centroid, material | narrowness, attributes, least, light importance
//! attributes: normal 0, u0 | normal 1, v0 | normal 2, u1 | v1, u2, v2, tangent
//! colours:    0, 1 | 2
//! tangents:   0, 1, 2
//! second:     u0, v0, u1, v1 | u2, v2
//! ```
//!
//! Row layout: see [`crate::memory::rows`].

use crate::glam::{UVec4, Vec2, Vec3, Vec4};
use crate::math::UNIT_ROUNDOFF;
use crate::math::packed::{LARGEST_SHORT, NO_TANGENT, Tangent, shorts};
use crate::memory::device_struct;
use crate::memory::rows::{float, row, vector};
use crate::scene::bvh::planes::Plane;
use crate::scene::ray::{Hit, Ray};
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

/// The attribute index of a triangle without normals and texture coordinates.
pub const NO_ATTRIBUTES: u32 = u32::MAX;

/// Row of the first colours where vertices have none.
pub const NO_COLOURS: u32 = u32::MAX;

/// Row of the first tangents where corners have none of their own.
pub const NO_TANGENTS: u32 = u32::MAX;

/// Row of the first second texture coordinates where corners have none.
pub const NO_COORDINATES: u32 = u32::MAX;

/// How near a point may be to an edge of its triangle, in roundings of the largest coordinate of
/// the ray that found it: those of the ray's end, which is that far off its line, and of where it
/// would have met the neighbour, beyond whose plane it may lie.
const INSET_ROUNDINGS: f32 = 8.0;
/// The same in distances that rays start off the surface: so far from the edge, a ray's origin is
/// still this side of a neighbour that stands at 30 degrees.
const INSET_OFFSETS: f32 = 2.0;

/// What shading needs of a triangle, besides its [plane](Plane).
#[cfg_attr(not(target_arch = "spirv"), derive(Debug, PartialEq))]
#[derive(Clone, Copy)]
pub struct Triangle {
    /// Mean of the corners, in world units.
    pub centroid: Vec3,
    /// Index into the materials.
    pub material: u32,
    /// One over the smallest of the three heights, in world units.
    pub narrowness: f32,
    /// Index into the attributes, or [`NO_ATTRIBUTES`].
    pub attributes: u32,
    /// The barycentric coordinates of a hit that are 0 on the triangle's own edges: the test is
    /// that of a larger one.
    pub least: f32,
    /// What it is chosen by as a light, if it is one. Where a [tree](crate::scene::light::tree) chooses
    /// lights: the light's number. Else, where a texture says what it emits, the bits of its
    /// [importance](crate::scene::light::importance), an f32 above 0; where none does, 0.
    pub light: u32,
}

device_struct! {
    /// Corner normals and texture coordinates of one triangle. 64 bytes.
    pub struct Attributes {
        /// Unit normal at corner 0; all three are zero where there are none.
        pub normal0: Vec3,
        /// Texture coordinate u at corner 0.
        pub u0: f32,
        /// Unit normal at corner 1.
        pub normal1: Vec3,
        /// Texture coordinate v at corner 0.
        pub v0: f32,
        /// Unit normal at corner 2.
        pub normal2: Vec3,
        /// Texture coordinate u at corner 1.
        pub u1: f32,
        /// Texture coordinate v at corner 1.
        pub v1: f32,
        /// Texture coordinate u at corner 2.
        pub u2: f32,
        /// Texture coordinate v at corner 2.
        pub v2: f32,
        /// The direction of growing `u` along the triangle, see [`crate::math::packed`], or
        /// [`NO_TANGENT`].
        pub tangent: u32,
    }
}

device_struct! {
    /// The tangents at the corners of one triangle, those of the same number as its attributes: what
    /// takes the place of [`Attributes::tangent`]. 16 bytes.
    pub struct Tangents {
        /// Packed, see [`crate::math::packed`]; all three are
        /// [`NO_TANGENT`] where the triangle's own counts.
        pub corners: [u32; 3],
        /// Unused; zero.
        pub pad: u32,
    }
}

impl Tangents {
    /// Rows of one.
    pub const ROWS: u32 = 1;

    /// Unpacks the row.
    pub fn from_rows([row]: [UVec4; 1]) -> Self {
        Self { corners: [row.x, row.y, row.z], pad: row.w }
    }

    /// The tangent of `hit`, packed; [`NO_TANGENT`] where there is none.
    #[inline(always)]
    pub fn at(&self, hit: &Hit) -> u32 {
        let [a, b, c] = self.corners;
        if a == NO_TANGENT || b == NO_TANGENT || c == NO_TANGENT {
            return NO_TANGENT;
        }
        let [a, b, c] = [Tangent::unpack(a), Tangent::unpack(b), Tangent::unpack(c)];
        let w = 1.0 - hit.u - hit.v;
        let along = a.direction * w + b.direction * hit.u + c.direction * hit.v;
        let length = along.length_squared();
        if length <= 0.0 {
            return NO_TANGENT;
        }
        // The corners of a triangle are of one kind, or else the first decides.
        Tangent { direction: along / length.sqrt(), is_mirrored: a.is_mirrored }.pack()
    }
}

device_struct! {
    /// What multiplies colour and opacity of the material at the corners of one triangle: those of
    /// the same number as its attributes. 32 bytes.
    pub struct VertexColours {
        /// Red, green, blue and opacity of each corner, linear Rec.709, two to a word, the first
        /// one in its lower half: 0 to 65535 stand for 0 to 1.
        pub corners: [[u32; 2]; 3],
        /// Unused; zero.
        pub pad: [u32; 2],
    }
}

device_struct! {
    /// The second texture coordinates at the corners of one triangle, those of the same number as
    /// its attributes. 32 bytes.
    pub struct SecondCoordinates {
        /// `u` and `v` of each corner.
        pub corners: [[f32; 2]; 3],
        /// Unused; zero.
        pub pad: [u32; 2],
    }
}

impl SecondCoordinates {
    /// Rows of one.
    pub const ROWS: u32 = 2;

    /// Unpacks the two rows.
    pub fn from_rows(rows: [UVec4; 2]) -> Self {
        let [first, second] = rows;
        let pair = |u: u32, v: u32| [f32::from_bits(u), f32::from_bits(v)];
        Self {
            corners: [pair(first.x, first.y), pair(first.z, first.w), pair(second.x, second.y)],
            pad: [second.z, second.w],
        }
    }

    /// The coordinates of `hit`, `v` upwards.
    #[inline(always)]
    pub fn at(&self, hit: &Hit) -> Vec2 {
        let w = 1.0 - hit.u - hit.v;
        let [[u0, v0], [u1, v1], [u2, v2]] = self.corners;
        Vec2::new(u0, v0) * w + Vec2::new(u1, v1) * hit.u + Vec2::new(u2, v2) * hit.v
    }
}

impl VertexColours {
    /// Rows of one.
    pub const ROWS: u32 = 2;

    /// Unpacks the two rows.
    pub fn from_rows(rows: [UVec4; 2]) -> Self {
        let [first, second] = rows;
        Self {
            corners: [[first.x, first.y], [first.z, first.w], [second.x, second.y]],
            pad: [second.z, second.w],
        }
    }

    /// The colour and opacity of `hit`, in [0, 1].
    #[inline(always)]
    pub fn at(&self, hit: &Hit) -> Vec4 {
        let [[a0, a1], [b0, b1], [c0, c1]] = self.corners;
        let w = 1.0 - hit.u - hit.v;
        let colour = shares(a0, a1) * w + shares(b0, b1) * hit.u + shares(c0, c1) * hit.v;
        colour.clamp(Vec4::ZERO, Vec4::ONE)
    }
}

/// The four numbers of a corner.
fn shares(low: u32, high: u32) -> Vec4 {
    shorts(low, high) * (1.0 / LARGEST_SHORT)
}

impl Attributes {
    /// Rows of one.
    pub const ROWS: u32 = 4;

    /// Unpacks the four rows.
    pub fn from_rows(rows: [UVec4; 4]) -> Self {
        let last = rows[3];
        Self {
            normal0: vector(rows[0]),
            u0: float(rows[0]),
            normal1: vector(rows[1]),
            v0: float(rows[1]),
            normal2: vector(rows[2]),
            u1: float(rows[2]),
            v1: f32::from_bits(last.x),
            u2: f32::from_bits(last.y),
            v2: f32::from_bits(last.z),
            tangent: last.w,
        }
    }

    /// The normal of `hit`, of length 1; where those of the corners cancel, the `geometric` one.
    #[inline(always)]
    pub fn normal(&self, hit: &Hit, geometric: Vec3) -> Vec3 {
        let w = 1.0 - hit.u - hit.v;
        let normal = self.normal0 * w + self.normal1 * hit.u + self.normal2 * hit.v;
        let length = normal.length_squared();
        if length > 0.0 { normal / length.sqrt() } else { geometric }
    }

    /// The texture coordinates of `hit`, `v` upwards.
    #[inline(always)]
    pub fn uv(&self, hit: &Hit) -> Vec2 {
        let w = 1.0 - hit.u - hit.v;
        Vec2::new(self.u0, self.v0) * w
            + Vec2::new(self.u1, self.v1) * hit.u
            + Vec2::new(self.u2, self.v2) * hit.v
    }
}

impl Triangle {
    /// Rows of one.
    pub const ROWS: u32 = 2;

    /// Unpacks the two rows.
    pub fn from_rows(rows: [UVec4; 2]) -> Self {
        Self {
            centroid: vector(rows[0]),
            material: rows[0].w,
            narrowness: f32::from_bits(rows[1].x),
            attributes: rows[1].y,
            least: f32::from_bits(rows[1].z),
            light: rows[1].w,
        }
    }

    /// The two rows.
    pub fn to_rows(&self) -> [UVec4; 2] {
        let [narrowness, least] = [self.narrowness, self.least].map(f32::to_bits);
        let rest = UVec4::new(narrowness, self.attributes, least, self.light);
        [row(self.centroid, self.material), rest]
    }

    /// The point where `ray` has hit this triangle, which lies in `plane`, for rays that leave it
    /// by `offset_roundings` (see [`OFFSET_ROUNDINGS`](crate::scene::ray::OFFSET_ROUNDINGS)).
    ///
    /// It is found along the ray, since barycentric coordinates have the roundings of the whole
    /// triangle. Then it is moved off the edges, towards the centroid: a point on an edge must not
    /// end up beyond the neighbour there, from where a ray would leave a closed room. Last it is
    /// moved onto the plane, from which it is too far if the ray came from far away.
    #[inline(always)]
    pub fn point(&self, plane: &Plane, ray: &Ray, hit: &Hit, offset_roundings: f32) -> Vec3 {
        let point = ray.origin + ray.direction * hit.t;
        let here = point.abs().max_element();
        let reach = ray.origin.abs().max_element().max(here);
        self.inset(plane, point, hit, [offset_roundings * here, reach])
    }

    /// The point of the triangle that `ray` has hit near `point`: off the edges by what rays start
    /// off the surface, in roundings, and by those of what is as far as `reach` from the origin.
    #[inline(always)]
    pub fn inset(&self, plane: &Plane, point: Vec3, hit: &Hit, [offset, reach]: [f32; 2]) -> Vec3 {
        let mut point = point;
        let distance = UNIT_ROUNDOFF * (INSET_OFFSETS * offset + INSET_ROUNDINGS * reach);
        // Each edge is as far away as its height times how much a barycentric coordinate is above
        // `least`. At the centroid all three are a third.
        let margin = distance * self.narrowness;
        let inset = (self.least + margin).min(THIRD);
        let nearest = hit.u.min(hit.v).min(1.0 - hit.u - hit.v);
        // A point farther beyond the edge is on the triangle alone because that is enlarged, and
        // there is no wall at the edge: it would have been nearer.
        if nearest < inset && nearest > self.least - margin {
            point += (self.centroid - point) * ((inset - nearest) / (THIRD - nearest));
        }
        plane.nearest_point(point)
    }
}

const THIRD: f32 = 1.0 / 3.0;
