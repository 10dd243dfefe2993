//! What `N` rays have hit: [`raystream_shaders::scene::surface`] side by side.

use super::numbers::{Floats, Mask, Words, floats, words};
use super::scene::Scene;
use super::texture;
use super::vectors::{Rows, Vectors};
use raystream_shaders::math::UNIT_ROUNDOFF;
use raystream_shaders::scene::bsdf::Material;
use raystream_shaders::scene::bvh::planes::Planes;
use raystream_shaders::scene::ray::Hit;
use raystream_shaders::scene::texture::NO_TEXTURE;
use raystream_shaders::scene::triangle::{Attributes, NO_ATTRIBUTES, Triangle};

/// See [`raystream_shaders::scene::triangle`], which has the reasons of these.
const INSET_ROUNDINGS: f32 = 8.0;
const INSET_OFFSETS: f32 = 2.0;
const THIRD: f32 = 1.0 / 3.0;

/// The [`Hit`] of each lane.
#[derive(Clone, Copy)]
pub struct Hits<const N: usize> {
    /// Distances.
    pub t: Floats<N>,
    /// First coordinates.
    pub u: Floats<N>,
    /// Second coordinates.
    pub v: Floats<N>,
    /// Triangles: of lanes that hit nothing the first one.
    pub triangles: Words<N>,
    /// Lanes that hit something.
    pub are_some: Mask<N>,
}

impl<const N: usize> Hits<N> {
    /// None.
    pub const NONE: Self = Self {
        t: Floats([0.0; N]),
        u: Floats([0.0; N]),
        v: Floats([0.0; N]),
        triangles: Words([0; N]),
        are_some: Mask::NONE,
    };

    /// Makes `hit` that of a lane, if it is one.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, hit: &Hit) {
        if hit.is_some() {
            (self.t.0[lane], self.u.0[lane], self.v.0[lane]) = (hit.t, hit.u, hit.v);
            self.triangles.0[lane] = hit.triangle;
            self.are_some.0[lane] = u32::MAX;
        }
    }
}

/// A point of a surface for each lane, from which rays leave.
#[derive(Clone, Copy)]
pub struct Points<const N: usize> {
    /// Where.
    pub positions: Vectors<N>,
    /// Normals of the triangles.
    pub normals: Vectors<N>,
    /// How far off rays start.
    pub distances: Floats<N>,
    /// The largest coordinates.
    pub magnitudes: Floats<N>,
}

impl<const N: usize> Points<N> {
    /// [`SurfacePoint::offset_towards`](
    /// raystream_shaders::scene::ray::SurfacePoint::offset_towards).
    #[inline(always)]
    pub fn offset_towards(&self, directions: Vectors<N>) -> Vectors<N> {
        let side = directions.dot(self.normals);
        let distances = self.distances;
        let signed =
            floats(|lane| if side.0[lane] < 0.0 { -distances.0[lane] } else { distances.0[lane] });
        self.positions + self.normals * signed
    }
}

/// A [`Surface`](raystream_shaders::scene::surface::Surface) for each lane.
#[derive(Clone, Copy)]
pub struct Surfaces<const N: usize> {
    /// Where.
    pub points: Points<N>,
    /// Lanes that see the front of the triangle.
    pub from_front: Mask<N>,
    /// Lanes that see the front of the shading frame.
    pub from_outside: Mask<N>,
    /// Shading normals on the side of the path.
    pub normals: Vectors<N>,
    /// Numbers of the materials.
    pub materials: Words<N>,
    /// Their kinds.
    pub kinds: Words<N>,
    /// What they reflect.
    pub reflectances: Vectors<N>,
    /// What their fronts emit.
    pub emissions: Vectors<N>,
}

impl<const N: usize> Surfaces<N> {
    /// What these rays have hit. Some have: lanes that have not get some surface.
    #[inline(always)]
    pub fn at(
        scene: &Scene<'_>,
        origins: Vectors<N>,
        directions: Vectors<N>,
        hits: &Hits<N>,
    ) -> Self {
        let surfaces = &scene.view.surfaces;
        let first = |first: u32, rows: u32| words(|lane| first + hits.triangles.0[lane] * rows);
        let plane =
            Rows::of(scene.geometry, &first(scene.params.scene.first_planes, Planes::ROWS), 0);
        let triangles = first(0, Triangle::ROWS);
        let [middle, rest] =
            [Rows::of(surfaces.rows, &triangles, 0), Rows::of(surfaces.rows, &triangles, 1)];
        let points = points(scene, origins, directions, hits, &plane, &middle, &rest);
        let materials = middle.words();
        let first = words(|lane| surfaces.first_material + materials.0[lane] * Material::ROWS);
        let [looks, light] =
            [Rows::of(surfaces.rows, &first, 0), Rows::of(surfaces.rows, &first, 1)];
        let (mut shading, mut reflectances) = (points.normals, looks.vectors());
        let attributes = rest.0[1];
        if (!attributes.is(NO_ATTRIBUTES)).any() {
            let corners = Corners::of(scene, attributes);
            shading = corners.shading(hits, points.normals);
            corners.look_up(scene, hits, light.words(), &mut reflectances);
        }
        let zero = Floats::splat(0.0);
        let from_outside = directions.dot(shading).below(zero);
        let side = from_outside.choose(Floats::splat(1.0), Floats::splat(-1.0));
        Self {
            points,
            from_front: directions.dot(points.normals).below(zero),
            from_outside,
            normals: shading * side,
            materials,
            kinds: looks.words(),
            reflectances,
            emissions: light.vectors(),
        }
    }
}

/// [`Triangle::point`].
#[inline(always)]
fn points<const N: usize>(
    scene: &Scene<'_>,
    origins: Vectors<N>,
    directions: Vectors<N>,
    hits: &Hits<N>,
    plane: &Rows<N>,
    middle: &Rows<N>,
    rest: &Rows<N>,
) -> Points<N> {
    let Hits { t, u, v, .. } = *hits;
    let roundings = scene.view.surfaces.offset_roundings;
    let narrowness = rest.0[0].to_floats();
    let least = rest.0[2].to_floats();
    let point = origins + directions * t;
    let here = point.magnitude();
    let reach = origins.magnitude().max(here);
    let offset = here * roundings;
    let distance = (offset * INSET_OFFSETS + reach * INSET_ROUNDINGS) * UNIT_ROUNDOFF;
    let margin = distance * narrowness;
    let third = Floats::splat(THIRD);
    let inset = (least + margin).min(third);
    let nearest = u.min(v).min(Floats::splat(1.0) - u - v);
    let is_at_edge = nearest.below(inset) & nearest.above(least - margin);
    let moved = point + (middle.vectors() - point) * ((inset - nearest) / (third - nearest));
    let point = is_at_edge.choose_vectors(moved, point);
    let normals = plane.vectors();
    let positions = point + normals * (plane.floats() - normals.dot(point));
    let magnitudes = positions.magnitude();
    let distances = magnitudes * (roundings * UNIT_ROUNDOFF);
    Points { positions, normals, distances, magnitudes }
}

/// The [`Attributes`] of each lane, where it has some.
struct Corners<const N: usize> {
    rows: [Rows<N>; 4],
    are_some: Mask<N>,
}

impl<const N: usize> Corners<N> {
    #[inline(always)]
    fn of(scene: &Scene<'_>, attributes: Words<N>) -> Self {
        let surfaces = &scene.view.surfaces;
        let are_some = !attributes.is(NO_ATTRIBUTES);
        let attributes = are_some.choose_words(attributes, Words::splat(0));
        let first = words(|lane| surfaces.first_attributes + attributes.0[lane] * Attributes::ROWS);
        let row = |row: u32| Rows::of(surfaces.rows, &first, row);
        Self { rows: [row(0), row(1), row(2), row(3)], are_some }
    }

    /// [`Attributes::normal`].
    #[inline(always)]
    fn shading(&self, hits: &Hits<N>, geometric: Vectors<N>) -> Vectors<N> {
        let Hits { u, v, .. } = *hits;
        let [a, b, c, _] = &self.rows;
        let w = Floats::splat(1.0) - u - v;
        let normal = a.vectors() * w + b.vectors() * u + c.vectors() * v;
        let length = normal.dot(normal);
        let are_some = self.are_some & length.above(Floats::splat(0.0));
        are_some.choose_vectors(normal / length.sqrt(), geometric)
    }

    /// Multiplies what surfaces reflect by what their textures say.
    #[inline(always)]
    fn look_up(
        &self,
        scene: &Scene<'_>,
        hits: &Hits<N>,
        textures: Words<N>,
        reflectances: &mut Vectors<N>,
    ) {
        let have_one = hits.are_some & self.are_some & !textures.is(NO_TEXTURE);
        if !have_one.any() {
            return;
        }
        let [a, b, c, d] = &self.rows;
        let Hits { u, v, .. } = *hits;
        let w = Floats::splat(1.0) - u - v;
        let (v1, u2, v2) = (d.0[0].to_floats(), d.0[1].to_floats(), d.0[2].to_floats());
        let x = a.floats() * w + c.floats() * u + u2 * v;
        let y = b.floats() * w + v1 * u + v2 * v;
        let colours = texture::reflectances(scene, have_one, textures, [x, y]);
        *reflectances = have_one.choose_vectors(*reflectances * colours, *reflectances);
    }
}
