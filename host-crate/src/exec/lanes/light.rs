//! Light from sampled points of lights for `N` paths: [`raystream_shaders::scene::light`] and
//! [`raystream_shaders::integrator::nee`] side by side, of lights that are triangles of one
//! radiance and chosen by power.

use super::directions::{diffuse_pdf, power_heuristic};
use super::numbers::{Floats, Mask, Words, words};
use super::random::unit_floats;
use super::scene::Scene;
use super::surface::Surfaces;
use super::vectors::{Rows, Vectors};
use raystream_shaders::math::UNIT_ROUNDOFF;
use raystream_shaders::scene::light::Light;

/// Light that arrives unless something is in its way: a
/// [`SampledLight`](raystream_shaders::integrator::path::SampledLight) for each lane.
#[derive(Clone, Copy)]
pub struct SampledLights<const N: usize> {
    /// Where the segments to it begin.
    pub origins: Vectors<N>,
    /// From there to where they end.
    pub directions: Vectors<N>,
    /// What it adds to the radiance of a path of throughput 1.
    pub radiances: Vectors<N>,
    /// Lanes for which there is any.
    pub are_some: Mask<N>,
}

impl<const N: usize> SampledLights<N> {
    /// None.
    #[inline(always)]
    pub fn none() -> Self {
        let zero = Vectors::splat(glam::Vec3::ZERO);
        Self { origins: zero, directions: zero, radiances: zero, are_some: Mask::NONE }
    }

    /// That of one light for each lane's surface, chosen by 32 random bits, and of a point on it,
    /// chosen by 64. There are lights.
    #[inline(always)]
    pub fn sample(
        scene: &Scene<'_>,
        surfaces: &Surfaces<N>,
        throughputs: Vectors<N>,
        choices: Words<N>,
        points: [Words<N>; 2],
    ) -> Self {
        let light = LightPoints::sample(scene, choices, points);
        let from = &surfaces.points;
        let offset = light.positions - from.positions;
        let distance2 = offset.dot(offset);
        let directions = offset.normalize();
        let cosine = -directions.dot(light.normals);
        let zero = Floats::splat(0.0);
        let shines = cosine.above(zero) & distance2.above(zero);
        let pdf = shines.choose(light.pdfs * distance2 / cosine, zero);
        let bsdf_pdf = diffuse_pdf(surfaces.normals, directions);
        let radiances = surfaces.reflectances * light.radiances * (bsdf_pdf / pdf);
        let origins = from.offset_towards(directions);
        Self {
            origins,
            directions: light.end_towards(scene, from.magnitudes) - origins,
            radiances: throughputs * radiances * power_heuristic(pdf, bsdf_pdf),
            are_some: pdf.above(zero) & bsdf_pdf.above(zero),
        }
    }
}

/// A [`LightPoint`](raystream_shaders::scene::light::LightPoint) for each lane.
struct LightPoints<const N: usize> {
    positions: Vectors<N>,
    normals: Vectors<N>,
    radiances: Vectors<N>,
    pdfs: Floats<N>,
}

impl<const N: usize> LightPoints<N> {
    #[inline(always)]
    fn sample(scene: &Scene<'_>, choices: Words<N>, points: [Words<N>; 2]) -> Self {
        let lights = &scene.view.lights;
        let first = |index: Words<N>| words(|lane| lights.first + index.0[lane] * Light::ROWS);
        let column = choices.times_high(lights.count);
        let fraction = choices.times(Words::splat(lights.count)) >> 8;
        let column_row = |row: u32| Rows::of(lights.rows, &first(column), row).words();
        let (threshold, alias) = (column_row(0), column_row(1));
        let index = first(fraction.below(threshold).choose_words(column, alias));
        let row = |row: u32| Rows::of(lights.rows, &index, row);
        let [corner, edge1, edge2] = [row(0), row(1), row(2)];
        let (u, v) = (unit_floats(points[0]), unit_floats(points[1]));
        let half = Floats::splat(0.5);
        let is_upper = v.above(u);
        let (low, left) = (half * u, half * v);
        let a = is_upper.choose(low, u - left);
        let b = is_upper.choose(v - low, left);
        let position = corner.vectors() + edge1.vectors() * a + edge2.vectors() * b;
        let (radiance, plane) = (row(3), row(4));
        let normals = plane.vectors();
        Self {
            positions: position + normals * (plane.floats() - normals.dot(position)),
            normals,
            radiances: radiance.vectors(),
            pdfs: edge2.floats(),
        }
    }

    /// Where segments end that come from points of these `magnitudes`.
    #[inline(always)]
    fn end_towards(&self, scene: &Scene<'_>, magnitudes: Floats<N>) -> Vectors<N> {
        let roundings = scene.view.lights.offset_roundings;
        let magnitudes = self.positions.magnitude().max(magnitudes);
        let distances = magnitudes * (roundings * UNIT_ROUNDOFF);
        self.positions + self.normals * distances
    }
}
