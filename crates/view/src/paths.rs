//! The path of a sample: where it goes in the scene, and where the camera sees that.

use glam::{DVec3, Vec3};
use raystream_shaders::film::Contribution;
use raystream_shaders::film::stream::Slot;
use raystream_shaders::integrator::params::PathParams;
use raystream_shaders::integrator::path::{Path, SampledLight};
use raystream_shaders::math::random::{LENS, SECOND_HALF};
use raystream_shaders::scene::SceneView;
use raystream_shaders::scene::abilities::{ALL, Abilities, Fixed};
use raystream_shaders::scene::camera::{Camera, NO_PIXEL, PANORAMA};
use raystream_shaders::scene::ray::Ray;

/// Where a path meets a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vertex {
    /// In world units.
    pub position: Vec3,
    /// To the point of a light that was sampled there, if one could have lit the surface.
    pub light: Option<Connection>,
}

/// From a vertex to a point of a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Connection {
    /// Ends at the light.
    pub segment: Ray,
    /// Whether nothing is in its way, so that the light counts.
    pub is_open: bool,
}

impl Connection {
    fn new(light: &SampledLight, scene: &SceneView<'_, impl Abilities>) -> Self {
        let is_open = !scene.is_blocked(&light.segment, light.media);
        Self { segment: light.segment, is_open }
    }
}

/// The path of a sample.
#[derive(Clone, Debug, PartialEq)]
pub struct SamplePath {
    /// The point of the unit square that stands for where on the lens it starts.
    pub lens: [f32; 2],
    /// From the camera on; none where the first segment leaves the scene.
    pub vertices: Vec<Vertex>,
    /// The last segment, where that leaves the scene.
    pub escape: Option<Ray>,
    /// What the integrator makes of it.
    pub contribution: Contribution,
}

/// [`Slot::sample`] of one of the samples that a pixel has, counted from 0: those of the first
/// half, of which there are `first_samples`, come first.
pub fn sample_number(sample: u32, first_samples: u32) -> u32 {
    let second = sample.checked_sub(first_samples);
    second.map_or(sample, |number| number | SECOND_HALF)
}

impl SamplePath {
    /// Traces the path of a slot that is not empty, as the integrators do.
    pub fn trace(params: &PathParams, scene: &SceneView<'_, impl Abilities>, slot: Slot) -> Self {
        let numbers = params.numbers(slot);
        let mut path = Path::begin(params, scene, slot, &numbers);
        let (mut vertices, mut escape, mut goes_on) = (Vec::new(), None, true);
        while goes_on {
            let ray = path.ray;
            let encounter = scene.meet(&ray, path.media);
            let bounce = path.shade(params, scene, &numbers, &encounter);
            goes_on = bounce.goes_on;
            if !encounter.hit.is_some() {
                escape = Some(ray);
                continue;
            }
            let light = bounce.light.is_some().then(|| Connection::new(&bounce.light, scene));
            if light.is_some_and(|light| light.is_open) {
                path.radiance += bounce.light.radiance;
            }
            let position = ray.origin + ray.direction * encounter.hit.t;
            vertices.push(Vertex { position, light });
        }
        let contribution = path.contribution();
        Self { lens: numbers.pair(LENS), vertices, escape, contribution }
    }

    /// How many segments it has, connections left out.
    pub fn segments(&self) -> usize {
        self.vertices.len() + usize::from(self.escape.is_some())
    }

    /// How it lies over the picture of `camera`. What leaves the scene, and lights farther away,
    /// are drawn up to `reach` world units.
    pub fn drawing(&self, camera: &Camera, reach: f32) -> Drawing {
        let eye = Eye { camera, lens: self.lens };
        let mut drawing = Drawing::default();
        for vertex in &self.vertices {
            if let Some(Connection { segment, is_open }) = vertex.light {
                let what = if is_open { Part::Light } else { Part::Shadow };
                eye.draw([segment.origin, end(&segment, reach)], what, &mut drawing);
            }
        }
        // The segment from the camera is the point that the first vertex is.
        for pair in self.vertices.windows(2) {
            eye.draw([pair[0].position, pair[1].position], Part::Segment, &mut drawing);
        }
        if let (Some(ray), Some(_)) = (&self.escape, self.vertices.last()) {
            eye.draw([ray.origin, end(ray, reach)], Part::Escape, &mut drawing);
        }
        drawing.vertices = self.vertices.iter().map(|vertex| eye.place(vertex.position)).collect();
        drawing
    }
}

/// The end of a segment, or what is `reach` along it.
fn end(ray: &Ray, reach: f32) -> Vec3 {
    let length = ray.direction.length();
    ray.origin + ray.direction * ray.t_max.min(reach / length)
}

/// What a line over the picture is a part of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// From a vertex to the next one.
    Segment,
    /// From the last vertex out of the scene.
    Escape,
    /// To a point of a light that is seen from the vertex.
    Light,
    /// To a point of a light that something hides.
    Shadow,
}

/// A line over the picture, which is all in it, in pixels from its top left corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Its ends.
    pub ends: [[f32; 2]; 2],
    /// What it is a part of.
    pub part: Part,
}

/// A path over the picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drawing {
    /// What is seen of its lines.
    pub lines: Vec<Line>,
    /// Where its vertices are, in pixels; None for those that are behind the camera or beside the
    /// picture. What is hidden by surfaces counts as well.
    pub vertices: Vec<Option<[f32; 2]>>,
}

/// A camera that sees from one point of its lens.
struct Eye<'c> {
    camera: &'c Camera,
    lens: [f32; 2],
}

/// What is this much nearer than the other end of a line is not drawn: from there to the plane of
/// the camera a line is of any length.
const NEAREST: f64 = 1e-3;
/// Pieces of a line over a panorama, where it is bent.
const PIECES: u32 = 64;

impl Eye<'_> {
    /// Where in the picture it sees a point.
    fn place(&self, point: Vec3) -> Option<[f32; 2]> {
        let sight = self.camera.sight(Fixed::<ALL>, point, self.lens);
        let is_inside = sight.is_ahead && self.camera.pixel_at(sight.place) != NO_PIXEL;
        is_inside.then_some(sight.place)
    }

    fn draw(&self, ends: [Vec3; 2], part: Part, drawing: &mut Drawing) {
        let mut add = |ends: [[f64; 2]; 2]| {
            let [width, height] = [self.camera.width, self.camera.height].map(f64::from);
            if let Some(ends) = clip(ends, [width, height]) {
                let ends = ends.map(|end| end.map(|side| side as f32));
                drawing.lines.push(Line { ends, part });
            }
        };
        if self.camera.projection == PANORAMA {
            self.draw_around(ends, &mut add);
        } else if let Some(ends) = self.ahead(ends) {
            add(ends.map(|end| self.place_of(end)));
        }
    }

    /// Where it sees a point that is ahead, in the picture or beside it.
    fn place_of(&self, point: Vec3) -> [f64; 2] {
        self.camera.sight(Fixed::<ALL>, point, self.lens).place.map(f64::from)
    }

    /// The part of a line that is ahead.
    fn ahead(&self, ends: [Vec3; 2]) -> Option<[Vec3; 2]> {
        let Camera { right, down, .. } = self.camera;
        let axis = right.normalize().cross(down.normalize()).as_dvec3();
        let [a, b] = ends.map(Vec3::as_dvec3);
        let [from, to] = [a, b].map(|end| axis.dot(end - self.camera.origin.as_dvec3()));
        let nearest = NEAREST * from.max(to);
        if nearest <= 0.0 {
            return None;
        }
        let cut = |here: f64, there: f64| ((nearest - here) / (there - here)).max(0.0);
        let moved = [
            if from < nearest { a.lerp(b, cut(from, to)) } else { a },
            if to < nearest { b.lerp(a, cut(to, from)) } else { b },
        ];
        Some(moved.map(DVec3::as_vec3))
    }

    /// A line around a panorama, whose left and right sides are the same place.
    fn draw_around(&self, [from, to]: [Vec3; 2], add: &mut impl FnMut([[f64; 2]; 2])) {
        let eye = self.camera.origin;
        let (start, goal) = ((from - eye).normalize_or_zero(), (to - eye).normalize_or_zero());
        let angle = start.angle_between(goal);
        if !angle.is_finite() {
            return;
        }
        // Pieces of the same angle, however near the line passes.
        let aside = (goal - start * start.dot(goal)).normalize_or_zero();
        let place = |piece: u32| {
            let (sine, cosine) = (angle * piece as f32 / PIECES as f32).sin_cos();
            self.place_of(eye + start * cosine + aside * sine)
        };
        let width = f64::from(self.camera.width);
        for piece in 0..PIECES {
            let (a, b) = (place(piece), place(piece + 1));
            let turn = if b[0] - a[0] > 0.5 * width {
                -width
            } else if a[0] - b[0] > 0.5 * width {
                width
            } else {
                0.0
            };
            add([a, [b[0] + turn, b[1]]]);
            if turn != 0.0 {
                add([[a[0] - turn, a[1]], b]);
            }
        }
    }
}

/// What of a line is in the picture (Liang and Barsky 1984).
fn clip([a, b]: [[f64; 2]; 2], size: [f64; 2]) -> Option<[[f64; 2]; 2]> {
    let by = [b[0] - a[0], b[1] - a[1]];
    if !by.iter().chain(&a).all(|side| side.is_finite()) {
        return None;
    }
    let (mut first, mut last) = (0.0_f64, 1.0_f64);
    for axis in [0, 1] {
        for (distance, step) in [(a[axis], -by[axis]), (size[axis] - a[axis], by[axis])] {
            if step == 0.0 {
                if distance < 0.0 {
                    return None;
                }
            } else if step < 0.0 {
                first = first.max(distance / step);
            } else {
                last = last.min(distance / step);
            }
        }
    }
    let at = |part: f64| [0, 1].map(|axis| a[axis] + part * by[axis]);
    (first <= last).then(|| [at(first), at(last)])
}

#[cfg(test)]
mod tests;
