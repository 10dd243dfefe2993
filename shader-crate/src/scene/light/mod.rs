//! Lights: emissive triangles, points, directions and the environment. They are chosen by power, or,
//! where there are many, by a [tree] for the point that they shine on.

pub mod punctual;
pub mod tree;

use crate::glam::{UVec4, Vec2, Vec3};
use crate::math::random::unit_float;
use crate::math::wide::{Wide, multiply};
use crate::memory::device_struct;
use crate::memory::rows::{five_rows, float, two_rows, vector};
use crate::scene::abilities::{Abilities, EMISSION_MAPS, ENVIRONMENT, LIGHT_TREE, PUNCTUAL};
use crate::scene::bvh::planes::Plane;
use crate::scene::environment::{EnvironmentSample, EnvironmentView};
use crate::scene::ray::{Clearance, SurfacePoint};
use crate::scene::texture::{Coordinates, TextureView};
use core::f32::consts::FRAC_1_PI;
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;
use tree::{Choice, LightTree, Vantage};

/// [`Light::kind`]: an emissive triangle of one radiance.
pub const TRIANGLE: u32 = 0;
/// [`Light::kind`]: a point, see [`punctual`].
pub const POINT: u32 = 1;
/// [`Light::kind`]: a direction, see [`punctual`].
pub const DIRECTION: u32 = 2;
/// [`Light::kind`]: from here on an emissive triangle whose [`EmissionMap`] has as its number what
/// the kind is above this.
pub const MAPPED: u32 = 3;

device_struct! {
    /// One emissive triangle, and one column of the alias table that chooses among lights. 80
    /// bytes.
    ///
    /// What the fields mean of other lights, [`punctual`] says.
    pub struct Light {
        /// First corner, in world units.
        pub corner: Vec3,
        /// The column stands for its own light if a random number of 24 bits is below this (at most
        /// 2^24).
        pub threshold: u32,
        /// From the first corner to the second.
        pub edge1: Vec3,
        /// The light that the column stands for otherwise.
        pub alias: u32,
        /// From the first corner to the third.
        pub edge2: Vec3,
        /// Density of a point of this light, choice included, per area in world units: see
        /// [`area_pdf`].
        pub pdf: f32,
        /// Radiance of the front, linear Rec.709; where it has a map, what that is multiplied by.
        pub radiance: Vec3,
        /// [`TRIANGLE`], [`POINT`], [`DIRECTION`], or from [`MAPPED`] on.
        pub kind: u32,
        /// Unit normal of the front.
        pub normal: Vec3,
        /// `normal . x` of the points `x` of its plane, in world units.
        pub offset: f32,
    }
}

impl Light {
    /// Rows of one.
    pub const ROWS: u32 = 5;

    /// Unpacks the five rows, which are the struct's memory.
    pub fn from_rows(rows: [UVec4; 5]) -> Self {
        Self {
            corner: vector(rows[0]),
            threshold: rows[0].w,
            edge1: vector(rows[1]),
            alias: rows[1].w,
            edge2: vector(rows[2]),
            pdf: float(rows[2]),
            radiance: vector(rows[3]),
            kind: rows[3].w,
            normal: vector(rows[4]),
            offset: float(rows[4]),
        }
    }

    /// Of a triangle, in squared world units.
    fn area(&self) -> f32 {
        0.5 * self.edge1.cross(self.edge2).length()
    }
}

device_struct! {
    /// What an emissive triangle with a texture emits. 32 bytes.
    pub struct EmissionMap {
        /// Texture coordinates of the first corner.
        pub uv0: [f32; 2],
        /// Texture coordinates of the second corner.
        pub uv1: [f32; 2],
        /// Texture coordinates of the third corner.
        pub uv2: [f32; 2],
        /// The texture that the radiance is multiplied by.
        pub texture: u32,
        /// Unused; zero.
        pub pad: u32,
    }
}

impl EmissionMap {
    /// Rows of one.
    pub const ROWS: u32 = 2;

    /// Unpacks the two rows, which are the struct's memory.
    pub fn from_rows(rows: [UVec4; 2]) -> Self {
        let [a, b] = rows;
        Self {
            uv0: [f32::from_bits(a.x), f32::from_bits(a.y)],
            uv1: [f32::from_bits(a.z), f32::from_bits(a.w)],
            uv2: [f32::from_bits(b.x), f32::from_bits(b.y)],
            texture: b.z,
            pad: b.w,
        }
    }

    /// What the texture says at the point that has the barycentric coordinates `a` of the second
    /// corner and `b` of the third.
    fn sample<A: Abilities>(&self, textures: &TextureView<'_, A>, a: f32, b: f32) -> Vec3 {
        let first = 1.0 - a - b;
        let u = self.uv0[0] * first + self.uv1[0] * a + self.uv2[0] * b;
        let v = self.uv0[1] * first + self.uv1[1] * a + self.uv2[1] * b;
        textures.sample(self.texture, Coordinates::both(Vec2::new(u, v)))
    }
}

/// Radiance as one number, for the choice: the mean of its components.
pub fn importance(radiance: Vec3) -> f32 {
    (radiance.x + radiance.y + radiance.z) * (1.0 / 3.0)
}

/// Density per area of choosing a point on a triangle of this [`importance`], when the choice is by
/// power: importance times area over `total_importance` (the sum of that over all lights), times
/// one over the area. The area cancels, so a path that finds a light knows the density from the
/// material alone, or from the triangle where a texture says what it emits.
pub fn area_pdf(importance: f32, total_importance: f32) -> f32 {
    importance / total_importance
}

/// A point on a light.
#[derive(Clone, Copy)]
pub struct LightPoint {
    /// Where, in world units.
    pub position: Vec3,
    /// Unit normal of the side that emits.
    pub normal: Vec3,
    /// What that side emits, linear Rec.709.
    pub radiance: Vec3,
    /// Density per area, choice included.
    pub pdf: f32,
}

impl LightPoint {
    /// Where it is, and how a ray leaves it by so many [roundings](Clearance::roundings).
    pub fn point(&self, offset_roundings: f32) -> SurfacePoint {
        let clearance = Clearance::of_world(offset_roundings);
        SurfacePoint { position: self.position, normal: self.normal, clearance }
    }
}

/// The choice of a light that shines on a point.
#[derive(Clone, Copy)]
pub struct LightSample {
    /// From the point to the light, unit length.
    pub direction: Vec3,
    /// Whether it is at infinity.
    pub is_distant: bool,
    /// How far it is, in world units; 1 at infinity.
    pub distance: f32,
    /// What the light sends back along the direction, linear Rec.709.
    pub radiance: Vec3,
    /// Density of the direction per solid angle, choice of the light included; 0 if the light does
    /// not shine on the point.
    pub pdf: f32,
    /// Whether no other technique than choosing lights can find this one.
    pub is_delta: bool,
    /// Density of the light's point per area in world units, choice included; at infinity [`pdf`](
    /// Self::pdf), per solid angle.
    pub area_pdf: f32,
    /// Cosine between the direction back and the light's normal; 1 for what has none.
    pub cosine: f32,
    /// Density per solid angle with which a light path leaves the light for the point; 0 at
    /// infinity.
    pub emission_pdf: f32,
    /// Of a light at infinity: area of the disc through which a light path from there starts, in
    /// squared world units; else 0.
    pub disc_area: f32,
    /// Where a ray that tests the visibility ends: off the light's surface, or behind all others.
    pub end: Vec3,
}

/// The lights of a scene.
#[derive(Clone, Copy)]
pub struct LightView<'a, A> {
    /// The scene's buffer `surfaces`, see [`crate::scene`].
    pub rows: &'a [UVec4],
    /// Row of the first light.
    pub first: u32,
    /// How many there are, the environment included, which is the last.
    pub count: u32,
    /// Row of the first [`EmissionMap`].
    pub first_map: u32,
    /// The tree that chooses among them, if there is one.
    pub tree: LightTree<'a>,
    /// See [`crate::scene::SceneParams::total_importance`].
    pub total_importance: f32,
    /// See [`crate::scene::SceneParams::offset_roundings`].
    pub offset_roundings: f32,
    /// The environment, if there is one.
    pub environment: EnvironmentView<'a>,
    /// The textures.
    pub textures: TextureView<'a, A>,
    /// What the scene uses.
    pub abilities: A,
}

impl<A: Abilities> LightView<'_, A> {
    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Whether there is an environment.
    #[inline(always)]
    pub fn has_environment(&self) -> bool {
        self.abilities.has(ENVIRONMENT) && self.environment.is_some()
    }

    /// Whether a tree chooses lights for a point.
    #[inline(always)]
    pub fn has_tree(&self) -> bool {
        self.abilities.has(LIGHT_TREE) && self.tree.is_some()
    }

    /// Whether a light that is not the environment has no surface.
    #[inline(always)]
    pub fn is_punctual(&self, light: &Light) -> bool {
        self.abilities.has(PUNCTUAL) && (light.kind == POINT || light.kind == DIRECTION)
    }

    /// Whether the light number `index` is the environment.
    #[inline(always)]
    pub fn is_environment(&self, index: u32) -> bool {
        self.has_environment() && index + 1 == self.count
    }

    /// The light number `index`, or what chooses the environment.
    pub fn light(&self, index: u32) -> Light {
        Light::from_rows(five_rows(self.rows, self.first + index * Light::ROWS))
    }

    /// A light, chosen by power with 32 random `bits`: Walker's alias method in integers.
    pub fn choose(&self, bits: u32) -> u32 {
        let Wide { high: column, low: fraction } = multiply(bits, self.count);
        let light = self.light(column);
        if fraction >> 8 < light.threshold { column } else { light.alias }
    }

    /// A uniform point of the light number `index`, a triangle, from a uniform point of the unit
    /// square.
    pub fn point_on(&self, index: u32, u: [f32; 2]) -> LightPoint {
        self.point_of(&self.light(index), u)
    }

    /// The same of a light at hand.
    ///
    /// Heitz, "A Low-Distortion Map Between Triangle and Square", 2019.
    fn point_of(&self, light: &Light, u: [f32; 2]) -> LightPoint {
        let (a, b) = if u[1] > u[0] {
            let a = 0.5 * u[0];
            (a, u[1] - a)
        } else {
            let b = 0.5 * u[1];
            (u[0] - b, b)
        };
        let Light { normal, offset, .. } = *light;
        // The sum has the roundings of the whole triangle; of those that count, the ones across it,
        // the plane leaves what the point itself has.
        let position = light.corner + light.edge1 * a + light.edge2 * b;
        LightPoint {
            position: Plane { normal, offset }.nearest_point(position),
            normal,
            radiance: self.radiance_at(light, a, b),
            pdf: light.pdf,
        }
    }

    /// Radiance of a triangle at the point of these barycentric coordinates.
    #[inline(always)]
    fn radiance_at(&self, light: &Light, a: f32, b: f32) -> Vec3 {
        if self.abilities.has(EMISSION_MAPS) && light.kind >= MAPPED {
            let row = self.first_map + (light.kind - MAPPED) * EmissionMap::ROWS;
            let map = EmissionMap::from_rows(two_rows(self.rows, row));
            return light.radiance * map.sample(&self.textures, a, b);
        }
        light.radiance
    }

    /// A light for the point `from`, by 32 random bits for the `choice` of the light and 64 for the
    /// `point` on it: chosen by power.
    #[inline(always)]
    pub fn sample(&self, from: &SurfacePoint, choice: u32, point: [u32; 2]) -> LightSample {
        let index = self.choose(choice);
        if self.is_environment(index) {
            return self.sample_environment(from, point);
        }
        self.sample_light(from, &self.light(index), point)
    }

    /// The same, chosen by the tree for `vantage`, which is `from` as choices see it.
    #[inline(always)]
    pub fn sample_by_tree(
        &self,
        from: &SurfacePoint,
        vantage: &Vantage,
        choice: u32,
        point: [u32; 2],
    ) -> LightSample {
        let Choice { light: index, chance } = self.tree.choose(vantage, choice);
        if self.is_environment(index) {
            return self.sample_environment(from, point);
        }
        let light = self.light(index);
        let pdf = if self.is_punctual(&light) { chance } else { chance / light.area() };
        self.sample_light(from, &Light { pdf, ..light }, point)
    }

    #[inline(always)]
    fn sample_light(&self, from: &SurfacePoint, light: &Light, point: [u32; 2]) -> LightSample {
        let u = [unit_float(point[0]), unit_float(point[1])];
        if self.is_punctual(light) {
            return light.sample_punctual(from, u);
        }
        self.sample_triangle(from, light, u)
    }

    fn sample_environment(&self, from: &SurfacePoint, point: [u32; 2]) -> LightSample {
        let EnvironmentSample { direction, pdf } = self.environment.sample(point);
        LightSample {
            direction,
            is_distant: true,
            distance: 1.0,
            radiance: self.environment.radiance(direction),
            pdf,
            is_delta: false,
            area_pdf: pdf,
            cosine: 1.0,
            emission_pdf: 0.0,
            disc_area: self.environment.disc_area(),
            end: self.environment.far_end(from.position, direction),
        }
    }

    #[inline(always)]
    fn sample_triangle(&self, from: &SurfacePoint, light: &Light, u: [f32; 2]) -> LightSample {
        let light = self.point_of(light, u);
        let offset = light.position - from.position;
        let distance2 = offset.length_squared();
        let direction = offset.normalize();
        let cosine = -direction.dot(light.normal);
        let mut shines = cosine > 0.0 && distance2 > 0.0;
        if self.abilities.has(EMISSION_MAPS) {
            // A texture may be black here.
            shines = shines && light.radiance.max_element() > 0.0;
        }
        let end = light.point(self.offset_roundings).end_towards(light.normal, from.position);
        LightSample {
            direction,
            is_distant: false,
            distance: distance2.sqrt(),
            radiance: light.radiance,
            pdf: if shines { light.pdf * distance2 / cosine } else { 0.0 },
            is_delta: false,
            area_pdf: light.pdf,
            cosine,
            emission_pdf: cosine * FRAC_1_PI,
            disc_area: 0.0,
            end,
        }
    }

    /// The density per area of a point on the triangle of the light of this `mark`, see
    /// [`Triangle::light`](crate::scene::triangle::Triangle::light), that has a material of this
    /// `emission`, when the choice is by power.
    #[inline(always)]
    pub fn area_pdf(&self, emission: Vec3, mark: u32) -> f32 {
        if self.has_tree() {
            self.light(mark).pdf
        } else if self.abilities.has(EMISSION_MAPS) && mark != 0 {
            area_pdf(f32::from_bits(mark), self.total_importance)
        } else {
            area_pdf(importance(emission), self.total_importance)
        }
    }

    /// The density per area with which the tree chooses a point on the triangle of the light of this
    /// `mark` for `vantage`.
    #[inline(always)]
    pub fn area_pdf_by_tree(&self, vantage: &Vantage, mark: u32) -> f32 {
        self.tree.chance(vantage, mark) / self.light(mark).area()
    }
}
