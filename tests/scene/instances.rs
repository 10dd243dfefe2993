//! Instances: the hits of rays, and what they take of memory.

use super::traversal::{assert_hits_are_exact, hits};
use glam::{DAffine3, DQuat, DVec3, Vec3};
use raystream::exec::cpu::CpuExecutor;
use raystream::render::PreparedScene;
use raystream::scene::{Mesh, Scene};
use raystream_shaders::math::random::hash;
use raystream_shaders::scene::abilities::INSTANCES;
use raystream_shaders::scene::bvh::instance::InstanceView;
use raystream_shaders::scene::ray::{Hit, Ray};
use raystream_tests::{prepare, scenes};

/// Numbers in [-1, 1).
struct Numbers(u32);

impl Numbers {
    fn next(&mut self) -> f32 {
        self.0 = hash(self.0.wrapping_add(0x9e37_79b9));
        (self.0 >> 8) as f32 / (1 << 23) as f32 - 1.0
    }

    fn vector(&mut self) -> Vec3 {
        Vec3::new(self.next(), self.next(), self.next())
    }
}

/// A ball of 128 triangles about the origin, and a few triangles at random, some of them in the
/// world as well.
fn shapes() -> Scene {
    let mut scene = scenes::empty(Vec3::ZERO, Vec3::X);
    let material = scene.add_material(scenes::diffuse(0.5));
    let mut numbers = Numbers(7);
    for _ in 0..30 {
        let at = numbers.vector() * 3.0;
        let corners = [at, at + numbers.vector() * 0.4, at + numbers.vector() * 0.4];
        scenes::add_triangle(&mut scene, corners, material);
    }
    let mut ball = scenes::empty(Vec3::ZERO, Vec3::X);
    scenes::add_ball(&mut ball, Vec3::ZERO, 0.5, 2, material);
    scene.shapes.extend([ball.meshes.remove(0), scene.meshes[0].clone()]);
    scene
}

fn place(scene: &mut Scene, transforms: &[DAffine3]) {
    let shapes = [0, 1].map(raystream::scene::ShapeId);
    for (number, &transform) in transforms.iter().enumerate() {
        scene.add_instance(shapes[number % 2], transform);
    }
}

/// All kinds of transforms.
fn transforms() -> Vec<DAffine3> {
    let mut numbers = Numbers(3);
    let mut vector = |scale: f64| numbers.vector().as_dvec3() * scale;
    let mut transform = |scale: DVec3, reach: f64| {
        let axis = vector(1.0).normalize_or(DVec3::Y);
        let turn = DQuat::from_axis_angle(axis, vector(3.0).x);
        DAffine3::from_scale_rotation_translation(scale, turn, vector(reach))
    };
    let mut all: Vec<DAffine3> = (0..40).map(|_| transform(DVec3::ONE, 3.0)).collect();
    all.extend([
        transform(DVec3::new(0.3, 2.0, 1.0), 2.0),
        transform(DVec3::new(-1.0, 1.0, 1.0), 2.0),
        transform(DVec3::splat(-0.1), 1.0),
        transform(DVec3::new(0.05, 1.0, -1.0), 2.0),
        DAffine3::IDENTITY,
        DAffine3::IDENTITY,
    ]);
    all
}

/// Rays from around the scene and from within to points in it.
fn rays(count: usize) -> Vec<Ray> {
    let mut numbers = Numbers(11);
    let ray = |k: usize| {
        let origin = numbers.vector() * if k.is_multiple_of(2) { 10.0 } else { 3.0 };
        Ray::new(origin, numbers.vector() * 3.0 - origin)
    };
    (0..count).map(ray).collect()
}

#[test]
fn hits_in_instances_are_those_of_all_triangles() {
    let mut scene = shapes();
    place(&mut scene, &transforms());
    let prepared = prepare(&scene);
    assert_eq!((prepared.abilities & INSTANCES, prepared.instances), (INSTANCES, 46));
    assert_hits_are_exact(&prepared, &rays(20_000), "instances");
    // Many in one place, of which the first is hit.
    let mut crowd = shapes();
    let moved = |k: usize| DAffine3::from_translation(DVec3::X * 1e-9 * (k as f64));
    place(&mut crowd, &(0..80).map(moved).collect::<Vec<_>>());
    assert_hits_are_exact(&prepare(&crowd), &rays(2_000), "instances in one place");
}

/// The hits of the same rays, and of the scene with its instances repeated.
fn both(scene: &Scene, rays: &[Ray]) -> [(PreparedScene, Vec<Hit>); 2] {
    [scene.clone(), scene.without_instances()].map(|scene| {
        let prepared = prepare(&scene);
        let (found, _) = hits(&CpuExecutor, &prepared, rays).unwrap();
        (prepared, found)
    })
}

/// Where transforms change nothing but signs and, all alike, exponents, hits are those of the
/// repeated shapes, bit by bit.
#[test]
fn hits_are_those_of_repeated_shapes() {
    let mut scene = shapes();
    let scales = [[1.0, 1.0, 1.0], [-2.0, 2.0, 2.0], [0.5, 0.5, -0.5], [-8.0, -8.0, -8.0]];
    // Each of both shapes.
    let transforms = scales.map(|scale| DAffine3::from_scale(DVec3::from_array(scale)));
    place(&mut scene, &transforms.map(|t| [t, t]).concat());
    let rays = rays(20_000);
    let [(instanced, found), (repeated, expected)] = both(&scene, &rays);
    assert_eq!((instanced.instances, repeated.instances), (8, 0));
    let mut in_instances = 0;
    for (a, b) in found.iter().zip(&expected) {
        let triangles = [instanced.scene_triangle(a), repeated.scene_triangle(b)];
        assert_eq!(a.t.to_bits(), b.t.to_bits(), "{a:?} {b:?}");
        assert_eq!(triangles[0], triangles[1]);
        in_instances += usize::from(triangles[0].is_some_and(|number| number >= 30));
    }
    assert!(in_instances > 10_000, "{in_instances}");
}

/// Elsewhere a hit is off the repeated triangle by less than rays start from surfaces; a few rays
/// in a thousand, past an edge, hit something else.
#[test]
fn hits_are_those_of_repeated_shapes_but_for_roundings() {
    let mut scene = shapes();
    place(&mut scene, &transforms());
    let rays = rays(20_000);
    let [(instanced, found), (repeated, expected)] = both(&scene, &rays);
    let mut others = 0;
    for (ray, (a, b)) in rays.iter().zip(found.iter().zip(&expected)) {
        if instanced.scene_triangle(a) != repeated.scene_triangle(b) {
            others += 1;
            continue;
        }
        if !a.is_some() {
            continue;
        }
        let point = ray.origin + ray.direction * a.t;
        let plane = repeated.view().bvh.plane(b.triangle);
        let off = (plane.normal.dot(point) - plane.offset).abs();
        let view = instanced.view();
        let instance = view.bvh.place(a.triangle).instance;
        // The ray's own roundings come with it: it is up to 18 long.
        let clearance = view.surfaces.clearance(instance);
        let allowed = raystream_shaders::scene::ray::Clearance { roundings: 32.0, ..clearance };
        let reach = point.abs().max_element() + ray.origin.abs().max_element();
        assert!(off <= 2.0 * allowed.distance(reach), "{off} {a:?} {b:?}");
    }
    assert!(others <= 40, "{others} of {} rays hit something else", rays.len());
}

#[test]
fn instances_take_the_memory_of_one_shape_and_of_a_table() {
    let mut scene = scenes::empty(Vec3::ZERO, Vec3::X);
    let material = scene.add_material(scenes::diffuse(0.5));
    scenes::add_ball(&mut scene, Vec3::ZERO, 0.5, 6, material);
    let ball: Mesh = scene.meshes.remove(0);
    let size = |prepared: &PreparedScene| {
        size_of_val(&prepared.geometry[..]) + size_of_val(&prepared.surfaces[..])
    };
    let shape = scene.add_shape(ball);
    scene.add_instance(shape, DAffine3::IDENTITY);
    let one = size(&prepare(&scene));
    let count = 2000;
    for k in 1..count {
        let place = DVec3::new((k % 20) as f64, (k / 20 % 20) as f64, (k / 400) as f64);
        scene.add_instance(shape, DAffine3::from_translation(place));
    }
    assert_eq!(scene.triangle_count(), count * 32_768);
    let all = size(&prepare(&scene));
    // Beside its rows an instance has a leaf, which is as long as a triangle, and part of a node.
    let table = (all - one) as f64 / (count - 1) as f64;
    assert!(table < f64::from(InstanceView::ROWS * 16) + 200.0, "{table} bytes");
}

#[test]
fn lamps_and_what_is_flattened_are_repeated() {
    let mut scene = shapes();
    let lamp = scene.add_material(scenes::emissive(2.0, 0.0));
    scene.shapes[1].material = lamp;
    let flat = DAffine3::from_scale(DVec3::new(1.0, 1.0, 0.0));
    place(&mut scene, &[flat, DAffine3::from_translation(DVec3::X), DAffine3::IDENTITY]);
    let prepared = prepare(&scene);
    assert_eq!(prepared.instances, 1, "one ball is not flat");
    assert_eq!(prepared.params.lights, 30);
    // A flat ball has triangles all the same, but for those that are seen from the edge.
    assert!(prepared.degenerate < 64, "{}", prepared.degenerate);
}

#[test]
fn instances_are_checked() {
    let place_of = |spoil: fn(&mut Scene)| {
        let mut scene = shapes();
        place(&mut scene, &[DAffine3::IDENTITY]);
        spoil(&mut scene);
        scene.check().unwrap_err().place
    };
    assert_eq!(place_of(|s| s.instances[0].shape.0 = 2), "instances[0]");
    assert_eq!(place_of(|s| s.shapes[1].positions[0].x = f32::NAN), "shapes[1].positions[0]");
    for x in [f64::NAN, 1e9, f64::INFINITY] {
        let mut scene = shapes();
        place(&mut scene, &[DAffine3::from_translation(DVec3::X * x)]);
        assert_eq!(scene.check().unwrap_err().place, "instances[0].transform", "{x}");
    }
    let mut many = shapes();
    let triangles = many.shapes[0].triangles.len();
    place(&mut many, &vec![DAffine3::IDENTITY; (1 << 26) / triangles]);
    assert!(many.check().is_ok());
    let large = many.shapes[0].triangles.repeat(200);
    many.shapes[0].triangles = large;
    assert_eq!(many.check().unwrap_err().place, "instances");
}
