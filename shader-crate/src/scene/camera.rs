//! The camera: a pinhole, a thin lens, parallel rays, or all directions from a point.
//!
//! A place on the film is in pixels from the picture's top left corner, to the right and down. All
//! cameras but the pinhole are behind the ability [`CAMERAS`].
//!
//! | projection | rays |
//! |---|---|
//! | [`PINHOLE`] | from a point through a plane |
//! | [`THIN_LENS`] | from a uniform point of the lens through the plane that is in focus |
//! | [`ORTHOGRAPHIC`] | from a plane, across it |
//! | [`PANORAMA`] | from a point; columns are meridians, rows are circles of latitude |

use crate::glam::Vec3;
use crate::math::angles::sin_cos_of_turns;
use crate::math::concentric_disc;
use crate::math::elementary::arc_tangent;
use crate::memory::device_struct;
use crate::scene::abilities::{Abilities, CAMERAS};
use crate::scene::ray::Ray;
use core::f32::consts::{PI, TAU};
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

/// The number of a pixel that the picture does not have.
pub const NO_PIXEL: u32 = u32::MAX;

/// [`Camera::projection`]: all rays start at one point.
pub const PINHOLE: u32 = 0;
/// [`Camera::projection`]: all rays are parallel.
pub const ORTHOGRAPHIC: u32 = 1;
/// [`Camera::projection`]: rays go in all directions, equirectangular.
pub const PANORAMA: u32 = 2;
/// [`Camera::projection`]: rays start on a lens, whose aperture is a regular polygon of as many
/// corners as the projection is above this, or a disc for none.
pub const THIN_LENS: u32 = 16;

/// The sine of the angle to a panorama's poles counts as at least this.
const SMALLEST_SINE: f32 = 1e-6;

device_struct! {
    /// A camera that looks at a picture plane of `width x height` pixels. 64 bytes.
    ///
    /// The plane of a pinhole is at distance 1, that of a lens where it is in focus, and
    /// orthographic rays start on it. A panorama has none: its three vectors have unit length.
    pub struct Camera {
        /// The pinhole, the middle of the lens, a point of the plane or the panorama's eye, in
        /// world units.
        pub origin: Vec3,
        /// Picture width in pixels.
        pub width: u32,
        /// From the origin to the picture plane's top left corner; a panorama's middle.
        pub top_left: Vec3,
        /// Picture height in pixels.
        pub height: u32,
        /// One pixel to the right.
        pub right: Vec3,
        /// [`PINHOLE`], [`ORTHOGRAPHIC`], [`PANORAMA`], or from [`THIN_LENS`] on.
        pub projection: u32,
        /// One pixel down.
        pub down: Vec3,
        /// Radius of the lens in world units, to the corners of its aperture; 0 without a lens.
        pub lens_radius: f32,
    }
}

/// How the camera sees a point.
#[derive(Clone, Copy)]
pub struct Sight {
    /// Where on the film, inside the picture or not.
    pub place: [f32; 2],
    /// Whether the point is in front of the camera. If not, the rest means nothing.
    pub is_ahead: bool,
    /// The point of the camera where its ray starts, in world units.
    pub origin: Vec3,
    /// From the point to there, unit length.
    pub direction: Vec3,
    /// What [`Camera::pdf`] times the cosine at the point is divided by for a density per area: the
    /// squared distance, or 1 where rays are parallel.
    pub distance2: f32,
}

impl Camera {
    /// Whether its rays start on a lens.
    #[inline(always)]
    pub fn has_lens(&self, abilities: impl Abilities) -> bool {
        abilities.has(CAMERAS) && self.projection >= THIN_LENS
    }

    /// Whether its rays are parallel.
    #[inline(always)]
    pub fn is_orthographic(&self, abilities: impl Abilities) -> bool {
        abilities.has(CAMERAS) && self.projection == ORTHOGRAPHIC
    }

    /// Whether it sees all around.
    #[inline(always)]
    pub fn is_panorama(&self, abilities: impl Abilities) -> bool {
        abilities.has(CAMERAS) && self.projection == PANORAMA
    }

    /// The ray of unit length through a `place` on the film, from the point of the lens that the
    /// point `lens` of the unit square stands for.
    #[inline(always)]
    pub fn ray(&self, abilities: impl Abilities, place: [f32; 2], lens: [f32; 2]) -> Ray {
        let [x, y] = place;
        if self.is_panorama(abilities) {
            return Ray::new(self.origin, self.panorama_direction(x, y));
        }
        let on_plane = self.top_left + self.right * x + self.down * y;
        if self.is_orthographic(abilities) {
            return Ray::new(self.origin + on_plane, self.axis());
        }
        if self.has_lens(abilities) {
            let from = self.lens_point(lens);
            return Ray::new(self.origin + from, (on_plane - from).normalize());
        }
        Ray::new(self.origin, on_plane.normalize())
    }

    /// The direction in which it looks, unit length.
    fn axis(&self) -> Vec3 {
        self.right.normalize().cross(self.down.normalize())
    }

    fn panorama_direction(&self, x: f32, y: f32) -> Vec3 {
        // To the right of the middle, and from the upper pole.
        let around = sin_cos_of_turns(x / self.width as f32 - 0.5);
        let down = sin_cos_of_turns(0.5 * (y / self.height as f32));
        let level = self.top_left * around.1 + self.right * around.0;
        (level * down.0 - self.down * down.1).normalize()
    }

    /// From the middle of the lens to a uniform point on it.
    fn lens_point(&self, u: [f32; 2]) -> Vec3 {
        let blades = self.projection - THIN_LENS;
        let (x, y) = if blades == 0 { concentric_disc(u) } else { regular_polygon(blades, u) };
        (self.right.normalize() * x + self.down.normalize() * y) * self.lens_radius
    }

    /// Density per solid angle of the `direction` (unit length, ahead of the camera) of rays whose
    /// places on the film are uniform in a pixel.
    ///
    /// That of a pixel's area `A` on a plane at the distance `F`, seen under the cosine `c`, is
    /// `F^2 / (A c^3)`. It is as well the importance that the pixel's mean radiance gives to
    /// radiance from there (Veach 1997, section 8.3.2). Orthographic rays have one direction; in
    /// its place stands the density per area of the plane, which
    /// [arrives](crate::integrator::lvc::mis::Subpath::arrive) as over a distance of 1.
    #[inline(always)]
    pub fn pdf(&self, abilities: impl Abilities, direction: Vec3) -> f32 {
        if self.is_panorama(abilities) {
            let height = self.down.dot(direction);
            let sine = (1.0 - height * height).max(0.0).sqrt().max(SMALLEST_SINE);
            return self.width as f32 * self.height as f32 / (TAU * PI * sine);
        }
        let area = self.right.length() * self.down.length();
        if self.is_orthographic(abilities) {
            return 1.0 / area;
        }
        let cosine = self.axis().dot(direction);
        let at_1 = 1.0 / (area * cosine * cosine * cosine);
        if self.has_lens(abilities) {
            let focus = self.axis().dot(self.top_left);
            return at_1 * focus * focus;
        }
        at_1
    }

    /// How it sees `position`, through the point of the lens that the point `lens` of the unit
    /// square stands for.
    #[inline(always)]
    pub fn sight(&self, abilities: impl Abilities, position: Vec3, lens: [f32; 2]) -> Sight {
        if self.is_orthographic(abilities) {
            return self.parallel_sight(position);
        }
        let mut from = Vec3::ZERO;
        let mut origin = self.origin;
        if self.has_lens(abilities) {
            from = self.lens_point(lens);
            origin += from;
        }
        let back = origin - position;
        let mut sight = Sight {
            place: [0.0; 2],
            is_ahead: true,
            origin,
            direction: back.normalize(),
            distance2: back.length_squared(),
        };
        if self.is_panorama(abilities) {
            sight.place = self.panorama_place(-sight.direction);
            return sight;
        }
        let offset = position - origin;
        let depth = self.axis().dot(offset);
        sight.is_ahead = depth > 0.0;
        let mut on_plane = offset / depth - self.top_left;
        if self.has_lens(abilities) {
            let focus = self.axis().dot(self.top_left);
            on_plane = from + offset / depth * focus - self.top_left;
        }
        sight.place = self.place_on_plane(on_plane);
        sight
    }

    fn parallel_sight(&self, position: Vec3) -> Sight {
        let axis = self.axis();
        let offset = position - self.origin;
        let depth = axis.dot(offset);
        Sight {
            place: self.place_on_plane(offset - axis * depth - self.top_left),
            is_ahead: depth > 0.0,
            origin: position - axis * depth,
            direction: -axis,
            distance2: 1.0,
        }
    }

    /// The place on the film of what is `on_plane`, from its top left corner.
    fn place_on_plane(&self, on_plane: Vec3) -> [f32; 2] {
        let x = on_plane.dot(self.right.normalize()) / self.right.length();
        let y = on_plane.dot(self.down.normalize()) / self.down.length();
        [x, y]
    }

    fn panorama_place(&self, direction: Vec3) -> [f32; 2] {
        let (ahead, right) = (self.top_left.dot(direction), self.right.dot(direction));
        let up = -self.down.dot(direction);
        let level = (ahead * ahead + right * right).sqrt();
        // At the poles any meridian will do, but the arc tangent of nothing is undefined.
        let ahead = if level > 0.0 { ahead } else { 1.0 };
        [
            (0.5 + arc_tangent(right, ahead) * (1.0 / TAU)) * self.width as f32,
            arc_tangent(level, up) * (1.0 / PI) * self.height as f32,
        ]
    }

    /// The pixel at a place on the film, row by row from the top, or [`NO_PIXEL`].
    pub fn pixel_at(&self, [x, y]: [f32; 2]) -> u32 {
        if x >= 0.0 && x < self.width as f32 && y >= 0.0 && y < self.height as f32 {
            y as u32 * self.width + x as u32
        } else {
            NO_PIXEL
        }
    }
}

/// A uniform point of the regular polygon whose corners lie on the unit circle, one of them at the
/// top, from a uniform point of the unit square.
fn regular_polygon(corners: u32, u: [f32; 2]) -> (f32, f32) {
    let scaled = u[0] * corners as f32;
    let side = scaled.floor().min(corners as f32 - 1.0);
    let corner = |number: f32| sin_cos_of_turns(number / corners as f32 - 0.25);
    let (from, to) = (corner(side), corner(side + 1.0));
    // A triangle between the middle and a side.
    let outwards = (scaled - side).max(0.0).sqrt();
    let (a, b) = (outwards * (1.0 - u[1]), outwards * u[1]);
    (a * from.1 + b * to.1, a * from.0 + b * to.0)
}
