//! The weights of all techniques that could make a path, as the kernels find them from both its
//! ends, against their definition, evaluated over all densities of the whole path.

use glam::{DVec3, Vec3};
use raystream_shaders::integrator::lvc::mis::{
    Join, Subpath, TechniqueSamples, camera_weight, connection_weight, cosine, emission_weight,
    lambert, light_weight,
};
use raystream_shaders::math::random::{hash, unit_float};
use raystream_shaders::scene::abilities::{BASIC, Fixed};
use raystream_shaders::scene::bsdf::{BsdfSample, Material, MaterialKind};
use raystream_shaders::scene::bvh::instance::NO_INSTANCE;
use raystream_shaders::scene::media::{Media, Sides};
use raystream_shaders::scene::ray::{Clearance, SurfacePoint};
use raystream_shaders::scene::surface::Surface;
use raystream_tests::materials::{bsdf, diffuse, glass, mirror};
use std::f64::consts::PI;

/// A vertex of a path, seen from nowhere in particular.
struct Vertex {
    position: Vec3,
    /// Of the triangle.
    geometric: Vec3,
    /// Of the front of the shading frame.
    shading: Vec3,
    material: Material,
}

/// A path from a light, its first vertex, to the camera, its last.
struct Path {
    vertices: Vec<Vertex>,
    light_pdf: f32,
    /// Density per solid angle of the camera's ray.
    camera_pdf: f32,
    samples: TechniqueSamples,
}

struct Random(u32);

impl Random {
    fn number(&mut self) -> f32 {
        self.0 += 1;
        unit_float(hash(self.0))
    }

    /// From `low` to `high`, by orders of magnitude.
    fn scale(&mut self, low: f32, high: f32) -> f32 {
        low * (high / low).powf(self.number())
    }

    fn direction(&mut self) -> Vec3 {
        loop {
            let v = Vec3::new(self.number(), self.number(), self.number()) * 2.0 - 1.0;
            if (0.01..1.0).contains(&v.length_squared()) {
                return v.normalize();
            }
        }
    }

    /// A path of at most 8 segments, a third of its surfaces specular, where no direction grazes a
    /// surface.
    fn path(&mut self, world: f32) -> Path {
        let segments = 1 + (self.number() * 8.0) as usize;
        loop {
            let vertices: Vec<Vertex> = (0..=segments).map(|_| self.vertex(world)).collect();
            let light_pdf = self.scale(1e-2, 1e2) / (world * world);
            let connection = self.scale(0.05, 20.0);
            // From some light paths for each sample to a picture of many pixels.
            let (camera, camera_pdf) = (self.scale(1.0, 1e6), self.scale(1.0, 1e6));
            let samples = TechniqueSamples { emission: 1.0, light: 1.0, connection, camera };
            let path = Path { vertices, light_pdf, camera_pdf, samples };
            if path.is_possible() {
                return path;
            }
        }
    }

    fn vertex(&mut self, world: f32) -> Vertex {
        let geometric = self.direction();
        // Smooth normals are up to some 50 degrees from the triangle's.
        let shading = (geometric + self.direction() * self.number() * 0.8).normalize();
        let material = match (self.number() * 6.0) as u32 {
            0 => mirror(0.9),
            1 => glass(self.scale(0.5, 2.0)),
            _ => diffuse(0.7),
        };
        let position = Vec3::new(self.number(), self.number(), self.number()) * world;
        Vertex { position, geometric, shading, material }
    }
}

impl Path {
    fn segments(&self) -> usize {
        self.vertices.len() - 1
    }

    /// The unit vector from one vertex to another.
    fn direction(&self, from: usize, to: usize) -> Vec3 {
        (self.vertices[to].position - self.vertices[from].position).normalize()
    }

    /// Whether diffuse surfaces and mirrors are on one side of their shading frame, and nothing
    /// grazes.
    fn is_possible(&self) -> bool {
        (0..self.segments()).all(|i| {
            let vertex = &self.vertices[i];
            let towards = |other| self.direction(i, other);
            let mut neighbours = vec![i + 1];
            if i > 0 {
                neighbours.push(i - 1);
            }
            let grazes =
                |n: Vec3| neighbours.iter().any(|&other| towards(other).dot(n).abs() < 1e-2);
            let crosses = i > 0
                && towards(i - 1).dot(vertex.shading) * towards(i + 1).dot(vertex.shading) < 0.0;
            let leaves = i > 0 || towards(1).dot(vertex.geometric) > 0.0;
            let may_cross = vertex.material.kind == MaterialKind::DIELECTRIC;
            !grazes(vertex.geometric)
                && !grazes(vertex.shading)
                && (!crosses || may_cross)
                && leaves
        })
    }

    /// Whether vertex `i` may be connected to: the light and the camera may.
    fn is_diffuse(&self, i: usize) -> bool {
        i == 0 || i == self.segments() || self.vertices[i].material.kind == MaterialKind::DIFFUSE
    }

    /// Whether there is a technique with `s` vertices from the light. That with the camera alone on
    /// the other side is light tracing, by which the light itself is not seen.
    fn exists(&self, s: usize) -> bool {
        let is_direct = s == 1 && self.segments() == 1;
        s == 0 || !is_direct && self.is_diffuse(s - 1) && self.is_diffuse(s)
    }

    /// Samples of the technique with `s` vertices from the light.
    fn samples_of(&self, s: usize) -> f32 {
        if s == self.segments() && s > 0 { self.samples.camera } else { self.samples.of(s as u32) }
    }

    /// Density per solid angle of the direction from `at` to `to`, for a path that comes from
    /// `from`. Of specular surfaces all that counts is its ratio to that of the way back, which is
    /// here said of the path from the camera: refraction maps solid angles onto each other such
    /// that n^2 cos dw is the same on both sides.
    fn solid_angle_pdf(&self, from: usize, at: usize, to: usize) -> f64 {
        let vertex = &self.vertices[at];
        let shading = vertex.shading.as_dvec3();
        let cosine = |other| self.direction(at, other).as_dvec3().dot(shading);
        if vertex.material.kind == MaterialKind::DIFFUSE {
            return cosine(to).abs() / PI;
        }
        if cosine(from) * cosine(to) > 0.0 || to > from {
            return 1.0;
        }
        let index = |other| if cosine(other) > 0.0 { 1.0 } else { f64::from(vertex.material.ior) };
        index(to).powi(2) * cosine(to).abs() / (index(from).powi(2) * cosine(from).abs())
    }

    /// A density per solid angle at `from`, as one per area at `to`.
    fn per_area(&self, pdf: f64, from: usize, to: usize) -> f64 {
        let offset: DVec3 =
            self.vertices[to].position.as_dvec3() - self.vertices[from].position.as_dvec3();
        let cosine = offset.normalize().dot(self.vertices[to].geometric.as_dvec3()).abs();
        pdf * cosine / offset.length_squared()
    }

    /// Density per area with which a path from the light finds vertex `i`.
    fn light_density(&self, i: usize) -> f64 {
        match i {
            0 => f64::from(self.light_pdf),
            1 => self.per_area(self.emission_pdf(), 0, 1),
            _ => self.per_area(self.solid_angle_pdf(i - 2, i - 1, i), i - 1, i),
        }
    }

    fn emission_pdf(&self) -> f64 {
        self.direction(0, 1).as_dvec3().dot(self.vertices[0].geometric.as_dvec3()).abs() / PI
    }

    /// Density per area with which a path from the camera finds vertex `i`; that of the camera
    /// itself is the same for all techniques.
    fn camera_density(&self, i: usize) -> f64 {
        if i + 1 == self.segments() {
            self.per_area(f64::from(self.camera_pdf), i + 1, i)
        } else {
            self.per_area(self.solid_angle_pdf(i + 2, i + 1, i), i + 1, i)
        }
    }

    /// The weights by their definition.
    fn expected_weights(&self) -> Vec<Option<f64>> {
        let segments = self.segments();
        let density = |s: usize| -> f64 {
            let light: f64 = (0..s).map(|i| self.light_density(i)).product();
            let camera: f64 = (s..segments).map(|i| self.camera_density(i)).product();
            f64::from(self.samples_of(s)) * light * camera
        };
        let squares: Vec<Option<f64>> =
            (0..=segments).map(|s| self.exists(s).then(|| density(s).powi(2))).collect();
        let sum: f64 = squares.iter().flatten().sum();
        squares.into_iter().map(|square| square.map(|square| square / sum)).collect()
    }

    /// Vertex `at` as a ray sees it that comes from `from`.
    fn surface(&self, from: usize, at: usize) -> Surface<'static, Fixed<BASIC>> {
        let vertex = &self.vertices[at];
        let incoming = self.direction(from, at);
        let from_outside = incoming.dot(vertex.shading) < 0.0;
        Surface {
            sides: Sides::both(Media::NONE),
            point: SurfacePoint {
                position: vertex.position,
                normal: vertex.geometric,
                clearance: Clearance::of_world(1.0),
            },
            instance: NO_INSTANCE,
            from_front: incoming.dot(vertex.geometric) < 0.0,
            bsdf: bsdf(
                &vertex.material,
                if from_outside { vertex.shading } else { -vertex.shading },
                from_outside,
            ),
            emission: vertex.material.emission,
            light: 0,
        }
    }

    /// The subpath that comes from `from` by `at` to `to`.
    fn extended(&self, subpath: Subpath, [from, at, to]: [usize; 3], samples: f32) -> Subpath {
        let direction = self.direction(at, to);
        let surface = self.surface(from, at);
        let bsdf = &surface.bsdf;
        let pdf = if bsdf.is_delta() { 0.0 } else { lambert(bsdf.normal.dot(direction)) };
        let crosses = bsdf.is_delta() && direction.dot(bsdf.normal) < 0.0;
        let eta = match (crosses, bsdf.from_outside) {
            (false, _) => 1.0,
            (true, true) => bsdf.ior,
            (true, false) => 1.0 / bsdf.ior,
        };
        let sample = BsdfSample { direction, weight: Vec3::ONE, pdf, eta };
        self.arrived(subpath.scatter(&surface, self.direction(from, at), &sample, samples), at, to)
    }

    fn arrived(&self, subpath: Subpath, from: usize, to: usize) -> Subpath {
        let distance = self.vertices[to].position.distance(self.vertices[from].position);
        subpath.arrive(distance, cosine(self.vertices[to].geometric, self.direction(from, to)))
    }

    /// The path from the camera up to vertex `s`.
    fn eye(&self, s: usize) -> Subpath {
        let last = self.segments();
        let first = self.arrived(Subpath::from_camera(self.camera_pdf), last, last - 1);
        (s + 1..last).rev().fold(first, |path, at| {
            let samples = self.samples.without_last_of((last - at) as u32);
            self.extended(path, [at + 1, at, at - 1], samples)
        })
    }

    /// The path from the light up to vertex `s - 1`, which is not on the light.
    fn light(&self, s: usize) -> Subpath {
        let leaving = cosine(self.vertices[0].geometric, self.direction(0, 1));
        let emitted = Subpath::from_light(self.light_pdf).emit(leaving, self.samples.emission);
        let first = self.arrived(emitted, 0, 1);
        (1..s - 1).fold(first, |path, at| {
            self.extended(path, [at - 1, at, at + 1], self.samples.of(at as u32))
        })
    }

    /// [`Subpath::norm`] at vertex `at`, where the path comes from `from`.
    fn norm(&self, subpath: &Subpath, from: usize, at: usize, samples: f32) -> f32 {
        subpath.norm(samples, lambert(cosine(self.vertices[at].shading, self.direction(from, at))))
    }

    /// The weight of the technique with `s` vertices from the light, as the kernels find it.
    fn weight(&self, s: usize) -> f32 {
        let samples = &self.samples;
        let segments = self.segments();
        let light_norm = || self.norm(&self.light(s), s - 2, s - 1, samples.of(s as u32 - 1));
        if s > 0 && s == segments {
            let direction = self.direction(s, s - 1);
            let distance2 =
                self.vertices[s].position.distance_squared(self.vertices[s - 1].position);
            let cosine = cosine(self.vertices[s - 1].geometric, direction);
            return camera_weight(samples, self.camera_pdf * cosine / distance2, light_norm());
        }
        let eye = self.eye(s);
        if s == 0 {
            let leaving = cosine(self.vertices[0].geometric, self.direction(0, 1));
            return emission_weight(samples, &eye, segments as u32, self.light_pdf, leaving);
        }
        let norm = self.norm(&eye, s + 1, s, samples.without_last_of((segments - s) as u32));
        let direction = self.direction(s, s - 1);
        let distance2 = self.vertices[s].position.distance_squared(self.vertices[s - 1].position);
        let eye_cosine = cosine(self.vertices[s].geometric, direction);
        let eye_pdf = lambert(cosine(self.vertices[s].shading, direction));
        let light_cosine = cosine(self.vertices[s - 1].geometric, direction);
        if s == 1 {
            let join =
                Join::new(distance2, eye_cosine, eye_pdf, light_cosine, lambert(light_cosine));
            return light_weight(samples, &join, norm, self.light_pdf);
        }
        let light_pdf = lambert(cosine(self.vertices[s - 1].shading, direction));
        let join = Join::new(distance2, eye_cosine, eye_pdf, light_cosine, light_pdf);
        connection_weight(samples, &join, norm, light_norm())
    }
}

/// Every split of every path, in worlds of all sizes.
#[test]
fn every_weight_is_that_of_the_definition() {
    let mut techniques = [0_u32; 9];
    let mut light_tracing = 0;
    for world in [1e-4, 1.0, 1e6] {
        let mut random = Random(hash(world as u32));
        for _ in 0..20_000 {
            let path = random.path(world);
            let mut sum = 0.0;
            for (s, expected) in path.expected_weights().into_iter().enumerate() {
                let Some(expected) = expected else { continue };
                techniques[s] += 1;
                light_tracing += u32::from(s > 0 && s == path.segments());
                let weight = f64::from(path.weight(s));
                sum += weight;
                assert!(
                    (weight - expected).abs() <= 1e-4 * expected + 1e-30,
                    "{} segments, {s} vertices from the light: {weight}, by definition {expected}",
                    path.segments()
                );
            }
            assert!(
                (sum - 1.0).abs() <= 1e-4,
                "{} segments: the weights sum to {sum}",
                path.segments()
            );
        }
    }
    assert!(
        techniques[..8].iter().all(|&paths| paths > 500) && light_tracing > 10_000,
        "too few paths of some kind: {techniques:?}, {light_tracing} of light tracing"
    );
}

/// What has no samples has no weight, and the others still sum to 1.
#[test]
fn techniques_can_be_left_out() {
    let mut random = Random(5);
    for [emission, light, connection, camera] in [
        [1.0, 0.0, 0.0, 0.0],
        [1.0, 1.0, 0.0, 0.0],
        [1.0, 0.0, 2.0, 0.0],
        [1e-3, 1e-3, 2.0, 0.0],
        [1.0, 0.0, 0.0, 3.0],
        [1e-3, 1e-3, 0.0, 3.0],
    ] {
        for _ in 0..5_000 {
            let path = Path {
                samples: TechniqueSamples { emission, light, connection, camera },
                ..random.path(1.0)
            };
            let mut sum = 0.0;
            for s in (0..=path.segments()).filter(|&s| path.exists(s)) {
                let weight = path.weight(s);
                assert!(path.samples_of(s) > 0.0 || weight == 0.0);
                sum += weight;
            }
            assert!((sum - 1.0).abs() <= 1e-4, "the weights sum to {sum}");
        }
    }
}
