//! The table of triangles, in both of its forms.

use super::scene_triangle::SceneTriangle;
use glam::{DVec3, UVec4, Vec3, Vec3A};
use raystream_shaders::math::UNIT_ROUNDOFF;
use raystream_shaders::memory::rows::row;
use raystream_shaders::scene::bvh::instance::leaf_rows;
use raystream_shaders::scene::bvh::node::BOX_ROUNDINGS;
use raystream_shaders::scene::bvh::planes::Planes;
use raystream_shaders::scene::triangle::Triangle;

/// The rows for the test of the triangles of `order` (indices, some of them more than once), as
/// [`raystream_shaders::scene::bvh::planes`] lays them out; where indices go on behind those of
/// triangles, the rows of [instances](raystream_shaders::scene::bvh::instance).
pub fn planes(triangles: &[SceneTriangle], order: &[u32]) -> Vec<UVec4> {
    let rows = |&index: &u32| match triangles.get(index as usize) {
        Some(triangle) => Functions::of(triangle.corners).rows(),
        None => leaf_rows(index - triangles.len() as u32),
    };
    order.iter().flat_map(rows).collect()
}

/// The rows for shading of the same triangles, as [`raystream_shaders::scene::triangle`] lays them
/// out; `marks` are the [lights](Triangle::light) of each, or empty.
pub fn shading(triangles: &[SceneTriangle], marks: &[u32], order: &[u32]) -> Vec<UVec4> {
    let rows = |&index: &u32| {
        let Some(triangle) = triangles.get(index as usize) else {
            // Of an instance, where nobody looks.
            return [UVec4::ZERO; Triangle::ROWS as usize];
        };
        let SceneTriangle { corners, material, attributes, .. } = *triangle;
        let functions = Functions::of(corners);
        let enlarged = functions.enlarged();
        Triangle {
            centroid: functions.centroid().as_vec3(),
            material,
            narrowness: functions.narrowness() as f32,
            attributes,
            least: (enlarged / (1.0 + 3.0 * enlarged)) as f32,
            light: marks.get(index as usize).copied().unwrap_or(0),
        }
        .to_rows()
    };
    order.iter().flat_map(rows).collect()
}

/// By how many of its own roundings a barycentric coordinate may be below 0 and still count as on
/// the triangle, so that no ray passes between two that share an edge. Of 133 million rays that are
/// aimed at edges (`tests/scene/leaks.rs`) 59 pass if it is 4, and 15 if it is 8: those that graze
/// both, where an error of the distance moves the point along the ray. With more, triangles would
/// stand out beyond their edges farther than rays start from surfaces.
const ENLARGED: f64 = 8.0;
/// The roundings that computing a coordinate takes, see [`Barycentric::magnitude`], and one that
/// its sum with another takes.
const EVALUATED: f64 = 6.0;
/// The rounding of an f32.
const ROUNDING: f64 = UNIT_ROUNDOFF as f64;

/// A barycentric coordinate: an affine function of a point.
#[derive(Clone, Copy)]
struct Barycentric {
    gradient: DVec3,
    offset: f64,
    /// The sum of the magnitudes that enter it, the largest on the triangle: its error in f32 is at
    /// most five roundings of that, those of the four stored numbers among them.
    magnitude: f64,
}

/// The exact functions of a triangle that the test and shading are made of.
pub struct Functions {
    corners: [DVec3; 3],
    /// Unit normal of the front.
    pub normal: DVec3,
    /// `normal . x` of the points of its plane, in world units.
    pub offset: f64,
    /// The coordinate that is 1 at each corner.
    barycentric: [Barycentric; 3],
}

impl Functions {
    /// The functions of the triangle with these corners, which has an area.
    pub fn of(corners: [Vec3; 3]) -> Self {
        let corners = corners.map(Vec3::as_dvec3);
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let barycentric = [0, 1, 2].map(|corner| {
            let (from, to) = (corners[(corner + 1) % 3], corners[(corner + 2) % 3]);
            let gradient = normal.cross(to - from) / normal.length_squared();
            let offset = -gradient.dot(from);
            let sum = |point: DVec3| (gradient * point).abs().element_sum() + offset.abs();
            let magnitude = corners.map(sum).into_iter().fold(0.0, f64::max);
            Barycentric { gradient, offset, magnitude }
        });
        let normal = normal.normalize();
        Self { corners, normal, offset: normal.dot(corners[0]), barycentric }
    }

    /// Whether roundings make up half of a barycentric coordinate: then it is thinner than what
    /// its neighbours are enlarged by, so that they cover it.
    pub fn is_thin(&self) -> bool {
        self.enlarged() > 0.5
    }

    /// How far below 0 barycentric coordinates still count as on the triangle. It is one number for
    /// all three, so the test is that of a triangle that was scaled about its centroid.
    fn enlarged(&self) -> f64 {
        let largest = self.barycentric.iter().map(|c| c.magnitude).fold(0.0, f64::max);
        ENLARGED * ROUNDING * largest
    }

    /// Mean of the corners.
    fn centroid(&self) -> DVec3 {
        self.corners.iter().sum::<DVec3>() / 3.0
    }

    /// One over the smallest of the heights: the largest gradient.
    fn narrowness(&self) -> f64 {
        self.barycentric.iter().map(|c| c.gradient.length()).fold(0.0, f64::max)
    }

    /// How far from the triangle, in each axis and in world units, the point may lie that the test
    /// takes for one on it, with what
    /// [`BoxRay`](raystream_shaders::scene::bvh::node::BoxRay) asks for.
    pub fn margin(&self) -> Vec3A {
        let accepted = self.enlarged() * (ENLARGED + EVALUATED) / ENLARGED;
        let centroid = self.centroid();
        let reach = |corner: &DVec3| (corner - centroid).abs() * (3.0 * accepted);
        let grown = self.corners.iter().map(reach).fold(DVec3::ZERO, DVec3::max);
        let largest = self.corners.iter().map(|corner| corner.abs().max_element());
        let magnitude = largest.fold(0.0, f64::max) + grown.max_element();
        Vec3A::from((grown + f64::from(BOX_ROUNDINGS) * ROUNDING * magnitude).as_vec3())
    }

    /// The plane as a row, see [`raystream_shaders::scene::bvh::planes::Plane`].
    pub fn plane(&self) -> UVec4 {
        affine_row(self.normal, self.offset)
    }

    /// The three rows of the test.
    fn rows(&self) -> [UVec4; Planes::ROWS as usize] {
        let enlarged = self.enlarged();
        let scale = 1.0 / (1.0 + 3.0 * enlarged);
        let [u, v] = [1, 2].map(|corner| {
            let Barycentric { gradient, offset, .. } = self.barycentric[corner];
            affine_row(gradient * scale, (offset + enlarged) * scale)
        });
        [self.plane(), u, v]
    }
}

fn affine_row(gradient: DVec3, offset: f64) -> UVec4 {
    row(gradient.as_vec3(), (offset as f32).to_bits())
}

#[cfg(test)]
mod tests {
    use super::*;
    use raystream_shaders::math::random::hash;
    use raystream_shaders::scene::ray::{Hit, Ray};
    use raystream_shaders::scene::triangle::NO_ATTRIBUTES;

    /// Numbers in [-1, 1).
    fn numbers(seed: u32) -> impl FnMut() -> f32 {
        let mut state = hash(seed);
        move || {
            state = hash(state.wrapping_add(0x9e37_79b9));
            (state >> 8) as f32 / (1 << 23) as f32 - 1.0
        }
    }

    fn triangle(corners: [Vec3; 3]) -> SceneTriangle {
        SceneTriangle { corners, material: 0, attributes: NO_ATTRIBUTES, number: 0 }
    }

    fn hit(table: &[UVec4], index: u32, ray: &Ray) -> Hit {
        let mut hit = Hit::miss(ray.t_max);
        let first = (index * Planes::ROWS) as usize;
        let rows = [table[first], table[first + 1], table[first + 2]];
        let (t, u, v) = Planes { rows }.intersect(ray.origin, ray.direction);
        if t > 0.0 && t < hit.t {
            hit = Hit { t, u, v, triangle: index };
        }
        hit
    }

    #[test]
    fn a_ray_to_a_point_of_a_triangle_hits_it_there() {
        let mut skipped = 0;
        for seed in 0..20_000 {
            let mut number = numbers(seed);
            let mut vector = |scale: f32| Vec3::new(number(), number(), number()) * scale;
            let size = 10_f32.powi(seed as i32 % 7 - 3);
            let at = vector(10.0 * size);
            let corners = [at + vector(size), at + vector(size), at + vector(size)];
            let (origin, triangle) = (at + vector(5.0 * size), triangle(corners));
            let table = planes(&[triangle], &[0]);

            let (u, v) = (0.1 + 0.4 * number().abs(), 0.1 + 0.3 * number().abs());
            let [edge1, edge2] = [1, 2].map(|k| triangle.corners[k] - triangle.corners[0]);
            let target = triangle.corners[0] + edge1 * u + edge2 * v;
            let ray = Ray::new(origin, target - origin);
            // Coordinates are below 16 sizes. The distance, the point and a gradient take some ten
            // roundings of them each, and the triangle is enlarged by eight: so far is a point off,
            // in units of the triangle's height, seen along the ray.
            let normal = edge1.cross(edge2);
            let height =
                normal.length() / edge1.length().max(edge2.length()).max((edge1 - edge2).length());
            let slant = normal.normalize().dot(ray.direction.normalize()).abs();
            let tolerance = 40.0 * UNIT_ROUNDOFF * 16.0 * size / (height * slant);
            if tolerance > 0.05 {
                // Seen so nearly from its edge, it may be missed.
                skipped += 1;
                continue;
            }
            let hit = hit(&table, 0, &ray);
            assert!(hit.is_some(), "{seed}: {triangle:?} {ray:?}");
            assert!(
                (hit.u - u).abs() < tolerance && (hit.v - v).abs() < tolerance,
                "{seed}: {hit:?} {u} {v}"
            );
            let before = Ray::segment(origin, target - origin, 0.99 - tolerance);
            assert!(!self::hit(&table, 0, &before).is_some(), "{seed}: {triangle:?} {before:?}");
        }
        assert!(skipped < 200, "{skipped} of 20000 were not tested");
    }

    #[test]
    fn no_ray_passes_between_two_triangles() {
        for seed in 0..200_000 {
            let mut number = numbers(seed);
            let mut vector = || Vec3::new(number(), number(), number());
            // A roof far from the origin, seen from within.
            let at = vector() * 100.0;
            let [a, b] = [at + vector(), at + vector()];
            let below = at + vector() * 3.0;
            let along = (b - a).normalize();
            let outwards = (a - below).cross(along).normalize();
            let table = planes(
                &[
                    triangle([a, b, (a + b) / 2.0 + outwards]),
                    triangle([b, a, (a + b) / 2.0 - outwards]),
                ],
                &[0, 1],
            );
            let target = a + (b - a) * (0.5 + 0.49 * number());
            let ray = Ray::new(below, target - below);
            assert!(
                hit(&table, 0, &ray).is_some() || hit(&table, 1, &ray).is_some(),
                "{seed}: {ray:?}"
            );
        }
    }
}
