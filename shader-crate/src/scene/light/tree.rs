//! Lights, chosen by a tree for the point that they shine on.
//!
//! Conty Estevez and Kulla, "Importance Sampling of Many Lights with Adaptive Tree Splitting", 2018,
//! without the splitting. A node is a cluster of lights: a ball around them, a cone of the
//! directions that they face, and their intensity. Of two clusters one is chosen in proportion to
//! what they send to the point at most: intensity over squared distance, times the cosines at
//! their end and at that of the point. Both are bounds over the ball and the cone, so a cluster is
//! left out only where none of its lights shines on the point. Of two that do not shine one is
//! chosen by intensity all the same, so that the chances of all lights add up to 1.
//!
//! Rows of the scene's buffer `surfaces`, from [`LightTree::first`] on:
//!
//! ```text
//! trails: of each light, four to a row: the way to its leaf, from the lowest bit on, 1 for the
//!         second of two clusters
//! nodes:  pairs of clusters; the first pair is the root
//! ```

use crate::glam::{UVec4, Vec3};
use crate::math::packed::Tangent;
use crate::math::random::{hash, unit_float};
use crate::memory::device_struct;
use crate::memory::rows::{float, two_rows, vector, word};
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

/// [`LightTree::first`] of a scene that has none.
pub const NO_TREE: u32 = 0;
/// Pairs of clusters on the way to a light, at most: the bits of a trail.
pub const MAX_DEPTH: u32 = 32;
/// [`Cluster::link`]: the cluster is a light, whose number the other bits are.
pub const LEAF: u32 = 1 << 31;
/// [`Cluster::radius`] of what is chosen by its intensity alone, from wherever.
pub const EVERYWHERE: f32 = -1.0;

/// What is added to the bound of a cosine, against roundings: no light may be left out that shines.
const SLACK: f32 = 1e-3;
/// Distances count as no less than this share of a cluster's radius, squared.
const NEAREST: f32 = 0.06;
/// Squared distances count as no less, so that nothing overflows.
const LEAST: f32 = 1e-30;
/// One step of a random number of 24 bits.
const STEP: f32 = 1.0 / 16_777_216.0;
/// The largest number below 1.
const BELOW_1: f32 = 1.0 - STEP;

device_struct! {
    /// Some lights, or one. 32 bytes.
    pub struct Cluster {
        /// Middle of a ball around them, in world units.
        pub centre: Vec3,
        /// Its radius, or [`EVERYWHERE`].
        pub radius: f32,
        /// Sum of their intensities, as a share of that of all: area times importance of triangles,
        /// what points send where they send most.
        pub intensity: f32,
        /// Packed middle of a cone around the directions that they face, see
        /// [`crate::math::packed`].
        pub axis: u32,
        /// Cosine of half the cone's angle. Lights shine up to a right angle from what they face.
        pub spread: f32,
        /// [`LEAF`] and the number of a light, or that of the first of a pair of clusters.
        pub link: u32,
    }
}

impl Cluster {
    /// Rows of one.
    pub const ROWS: u32 = 2;

    /// Unpacks the two rows, which are the struct's memory.
    pub fn from_rows(rows: [UVec4; 2]) -> Self {
        let [a, b] = rows;
        Self {
            centre: vector(a),
            radius: float(a),
            intensity: f32::from_bits(b.x),
            axis: b.y,
            spread: f32::from_bits(b.z),
            link: b.w,
        }
    }

    /// What the cluster sends to a point at most.
    #[inline(always)]
    fn importance(&self, from: &View) -> f32 {
        if self.radius < 0.0 {
            return self.intensity;
        }
        let offset = self.centre - from.position;
        let distance2 = offset.length_squared();
        let radius2 = self.radius * self.radius;
        let counted = distance2.max(radius2 * NEAREST).max(LEAST);
        if distance2 <= radius2 {
            return self.intensity / counted;
        }
        let near = distance2.sqrt().recip();
        // What the ball is seen under.
        let angle = self.radius * near;
        let ball = Half { cosine: sine(angle), sine: angle };
        let mut arrives = from.facing.dot(offset) * near;
        if from.is_two_sided {
            arrives = arrives.abs();
        }
        let arrives = ball.nearest(arrives);
        if arrives <= -SLACK {
            return 0.0;
        }
        let axis = Tangent::unpack(self.axis).direction;
        let leaves = Half::of_cosine(self.spread).nearest(-axis.dot(offset) * near);
        let leaves = ball.nearest(leaves);
        let cosines = (leaves + SLACK).max(0.0) * (arrives + SLACK);
        self.intensity / counted * cosines
    }
}

/// A half of a cone's angle, from 0 to pi.
#[derive(Clone, Copy)]
struct Half {
    cosine: f32,
    sine: f32,
}

impl Half {
    fn of_cosine(cosine: f32) -> Self {
        Self { cosine, sine: sine(cosine) }
    }

    /// The cosine of the least angle to a direction within the cone, of one at an angle of this
    /// `cosine` to its axis.
    fn nearest(self, cosine: f32) -> f32 {
        if cosine >= self.cosine { 1.0 } else { cosine * self.cosine + sine(cosine) * self.sine }
    }
}

/// The sine of the angle from 0 to pi of this cosine, and the other way round.
fn sine(cosine: f32) -> f32 {
    (1.0 - cosine * cosine).max(0.0).sqrt()
}

/// A point, as the choice of a light for it sees it: whoever chooses, and whoever asks later how
/// likely that was, must see the same one.
#[derive(Clone, Copy)]
pub struct Vantage {
    /// Where, in world units.
    pub position: Vec3,
    /// The normal of the side that light counts on, packed as [`crate::math::packed`] does it with
    /// tangents; marked as mirrored if it counts on both sides.
    pub facing: u32,
}

impl Vantage {
    /// Of what does not choose.
    pub const NONE: Self = Self { position: Vec3::ZERO, facing: 0 };

    /// A surface with this `normal`, which light passes if it `is_two_sided`.
    #[inline(always)]
    pub fn new(position: Vec3, normal: Vec3, is_two_sided: bool) -> Self {
        let facing = Tangent { direction: normal, is_mirrored: is_two_sided }.pack();
        Self { position, facing }
    }
}

/// The same, unpacked.
struct View {
    position: Vec3,
    facing: Vec3,
    is_two_sided: bool,
}

impl View {
    fn of(vantage: &Vantage) -> Self {
        let Tangent { direction, is_mirrored } = Tangent::unpack(vantage.facing);
        Self { position: vantage.position, facing: direction, is_two_sided: is_mirrored }
    }
}

/// A light that was chosen.
#[derive(Clone, Copy)]
pub struct Choice {
    /// Its number.
    pub light: u32,
    /// How likely that was.
    pub chance: f32,
}

/// The tree of a scene's lights.
#[derive(Clone, Copy)]
pub struct LightTree<'a> {
    /// The scene's buffer `surfaces`.
    pub rows: &'a [UVec4],
    /// Row of the first trail, or [`NO_TREE`].
    pub first: u32,
    /// Number of lights.
    pub lights: u32,
}

impl LightTree<'_> {
    /// Whether there is one.
    pub fn is_some(&self) -> bool {
        self.first != NO_TREE
    }

    /// A light for a point, by 32 random bits.
    #[inline(always)]
    pub fn choose(&self, from: &Vantage, bits: u32) -> Choice {
        let from = View::of(from);
        let mut random = unit_float(bits);
        let mut noise = bits;
        // `random` is a multiple of it; what is below is drawn anew.
        let mut step = STEP;
        let mut chance = 1.0;
        let mut link = 0;
        while link & LEAF == 0 {
            let (pair, first) = self.pair(link, &from);
            if random < first {
                link = pair[0];
                random /= first;
                step /= first;
                chance *= first;
            } else {
                let second = 1.0 - first;
                link = pair[1];
                random = (random - first) / second;
                step /= second;
                chance *= second;
            }
            noise = hash(noise);
            random = (random + unit_float(noise) * step).min(BELOW_1);
        }
        Choice { light: link & !LEAF, chance }
    }

    /// How likely [`Self::choose`] is to choose the light of this number for a point.
    #[inline(always)]
    pub fn chance(&self, from: &Vantage, light: u32) -> f32 {
        let from = View::of(from);
        let mut trail = self.trail(light);
        let mut chance = 1.0;
        let mut link = 0;
        while link & LEAF == 0 {
            let (pair, first) = self.pair(link, &from);
            if trail & 1 == 0 {
                link = pair[0];
                chance *= first;
            } else {
                link = pair[1];
                chance *= 1.0 - first;
            }
            trail >>= 1;
        }
        chance
    }

    /// The links of the pair of clusters of this number, and how likely the first of them is.
    #[inline(always)]
    fn pair(&self, number: u32, from: &View) -> ([u32; 2], f32) {
        let (a, b) = (self.cluster(number), self.cluster(number + 1));
        let mut first = a.importance(from);
        let mut second = b.importance(from);
        if first + second <= 0.0 {
            (first, second) = (a.intensity, b.intensity);
        }
        ([a.link, b.link], first / (first + second))
    }

    fn cluster(&self, number: u32) -> Cluster {
        let first = self.first + self.lights.div_ceil(4);
        Cluster::from_rows(two_rows(self.rows, first + number * Cluster::ROWS))
    }

    fn trail(&self, light: u32) -> u32 {
        word(self.rows, self.first, light)
    }
}
