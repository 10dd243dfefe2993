//! No ray gets out of a closed room, wherever it is and however large.

use glam::{DAffine3, DQuat, DVec3, Mat3, Vec3};
use raystream::exec::cpu::CpuExecutor;
use raystream::exec::{Array, Executor, SceneBuffers, kernels};
use raystream::render::Settings;
use raystream::scene::Scene;
use raystream_shaders::integrator::params::PathParams;
use raystream_shaders::math::random::hash;
use raystream_shaders::scene::ray::{Hit, Ray};
use raystream_tests::scene_folder::{SceneFolder, obj_of};
use raystream_tests::scenes::{add_ball, add_box, add_triangle, diffuse, empty};
use raystream_tests::{prepare, settings, with_gpu};
use serde_json::json;

/// Set to how many rays [`no_ray_leaves_a_closed_room`] traces, if not two million.
const RAYS: &str = "RAYSTREAM_LEAK_RAYS";

/// The sizes of rooms.
const SCALES: [f32; 3] = [1.0, 1e-6, 1e6];

/// Numbers in [0, 1).
struct Numbers(u32);

impl Numbers {
    fn next(&mut self) -> f32 {
        self.0 = hash(self.0.wrapping_add(0x9e37_79b9));
        (self.0 >> 8) as f32 / (1 << 24) as f32
    }

    /// In [-1, 1).
    fn signed(&mut self) -> f32 {
        2.0 * self.next() - 1.0
    }

    fn vector(&mut self) -> Vec3 {
        Vec3::new(self.signed(), self.signed(), self.signed())
    }
}

/// A closed room whose fronts look inwards, and a point that sees all of it.
struct Room {
    name: String,
    scene: Scene,
    middle: Vec3,
}

fn cube(low: Vec3, high: Vec3) -> Scene {
    let mut scene = empty(low, high);
    let wall = scene.add_material(diffuse(1.0));
    add_box(&mut scene, low, high, true, wall);
    scene
}

/// The rooms at the origin: a cube about it and one that has a corner there, one that is turned,
/// a tetrahedron, and a ball of some triangles.
fn shapes() -> Vec<(&'static str, Scene, Vec3)> {
    let turn = Mat3::from_axis_angle(Vec3::new(1.0, 2.0, 3.0).normalize(), 0.7);
    let mut turned = cube(-Vec3::ONE, Vec3::new(1.0, 0.2, 0.5));
    for position in &mut turned.meshes[0].positions {
        *position = turn * *position;
    }
    let middle = turn * Vec3::new(0.0, -0.4, -0.25);
    let mut tetrahedron = empty(Vec3::ZERO, Vec3::X);
    let wall = tetrahedron.add_material(diffuse(1.0));
    let corners = [Vec3::ZERO, Vec3::new(0.3, 1.0, 0.1), Vec3::new(1.0, 0.2, 0.0), Vec3::ONE];
    for face in [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]] {
        let [a, b, c]: [Vec3; 3] = face.map(|corner| corners[corner]);
        let inside = corners.iter().sum::<Vec3>() / 4.0;
        let faces_in = (b - a).cross(c - a).dot(inside - a) > 0.0;
        add_triangle(&mut tetrahedron, if faces_in { [a, b, c] } else { [a, c, b] }, wall);
    }
    let mut ball = empty(Vec3::ZERO, Vec3::X);
    let wall = ball.add_material(diffuse(1.0));
    add_ball(&mut ball, Vec3::ZERO, 1.0, 4, wall);
    for triangle in &mut ball.meshes[0].triangles {
        triangle.swap(1, 2);
    }
    vec![
        ("cube", cube(-Vec3::ONE, Vec3::ONE), Vec3::ZERO),
        ("corner", cube(Vec3::ZERO, Vec3::new(1.0, 0.7, 1.3)), Vec3::splat(0.35)),
        ("turned", turned, middle),
        ("tetrahedron", tetrahedron, corners.iter().sum::<Vec3>() / 4.0),
        ("ball", ball, Vec3::ZERO),
    ]
}

/// The shapes at all sizes, each at places that are so many of its units away.
fn rooms_at(places: &[Vec3]) -> Vec<Room> {
    let mut rooms = Vec::new();
    for scale in SCALES {
        for place in places {
            for (name, mut scene, middle) in shapes() {
                let at = |position: Vec3| (position + place) * scale;
                for position in &mut scene.meshes[0].positions {
                    *position = at(*position);
                }
                let name = format!("{name} at {place} times {scale}");
                rooms.push(Room { name, scene, middle: at(middle) });
            }
        }
    }
    rooms
}

/// The rooms that files can make: near the origin, or brought near it.
fn rooms() -> Vec<Room> {
    let places = [Vec3::ZERO, Vec3::new(10.0, -3.0, 0.0), Vec3::new(0.0, 30.0, 9.0)];
    let mut rooms = rooms_at(&places);
    for scale in SCALES {
        rooms.extend(shapes().into_iter().map(|shape| far_away(shape, scale)));
    }
    rooms
}

/// A shape in a file, a million of its units from the origin.
fn far_away((name, shape, middle): (&str, Scene, Vec3), scale: f32) -> Room {
    let place = DVec3::new(999_990.0, -4e5, 9e5);
    let at = |point: DVec3| (point + place) * f64::from(scale);
    let folder = SceneFolder::new().with("a.obj", obj_of(&shape, at)).without("a.mtl");
    let folder = folder.json(|scene| {
        scene["camera"]["origin"] = json!(at(DVec3::ZERO).to_array());
        scene["camera"]["target"] = json!(at(DVec3::Z).to_array());
        scene["quads"] = json!([]);
    });
    let scene = folder.load().unwrap();
    let [from, to] = [&shape, &scene].map(|scene| scene.meshes[0].positions[0]);
    let middle = to + (middle - from) * scale;
    Room { name: format!("{name} far away times {scale}"), scene, middle }
}

/// Rays from the middle of a room, each towards a point that is within some roundings of an edge.
fn rays_at_edges(room: &Room, count: usize, numbers: &mut Numbers) -> Vec<Ray> {
    let mesh = &room.scene.meshes[0];
    let ray = |_| {
        let triangle = (numbers.next() * mesh.triangles.len() as f32) as usize;
        let corners = mesh.corners(triangle);
        let edge = (numbers.next() * 3.0) as usize;
        let target = corners[edge].lerp(corners[(edge + 1) % 3], numbers.next());
        // Between a tenth of a rounding and ten.
        let near = target.abs().max_element() * 1e-8 * 1000_f32.powf(numbers.next());
        let origin = room.middle + (target - room.middle) * (numbers.next() * 0.5);
        let origin = origin + (corners[0] - origin) * (numbers.next() * 0.3);
        Ray::new(origin, target + numbers.vector() * near - origin)
    };
    (0..count).map(ray).collect()
}

/// Traces rays, and `bounces` times what they bounce to; the number of leaks, which are rays that
/// hit nothing or the back of a wall.
fn leaks<E: Executor>(executor: &E, room: &Room, rays: &[Ray], bounces: u32) -> usize {
    let scene = prepare(&room.scene);
    let threads = rays.len() as u32;
    let buffers: SceneBuffers<_> = scene.buffers(executor).unwrap();
    let mut rays = Array::from_slice(executor, "rays", rays).unwrap();
    let mut bounced = Array::zeroed(executor, "bounced", threads as usize).unwrap();
    let hits: Array<_, Hit> = Array::zeroed(executor, "hits", threads as usize).unwrap();
    let leaked = |(ray, hit): &(Ray, Hit)| {
        !hit.is_some() || scene.view().bvh.plane(hit.triangle).normal.dot(ray.direction) > 0.0
    };
    let mut leaks = 0;
    for seed in 0..=bounces {
        let settings = Settings { seed, ..settings(&room.scene) };
        let parameters = PathParams { threads, ..scene.parameters(&settings) };
        let (from, at, to) = (rays.view(), hits.view(), bounced.view());
        executor.run(&[kernels::closest_hits(&parameters, &buffers, from, at)]).unwrap();
        let (from, at) = (rays.view(), hits.view());
        executor.run(&[kernels::bounce_rays(&parameters, &buffers, from, at, to)]).unwrap();
        let traced = rays.read(executor).unwrap().into_iter().zip(hits.read(executor).unwrap());
        leaks += traced.filter(leaked).count();
        std::mem::swap(&mut rays, &mut bounced);
    }
    leaks
}

/// One in a million of a render's rays comes as near to an edge as each of these does.
#[test]
fn no_ray_leaves_a_closed_room_through_an_edge() {
    let rooms = rooms();
    for (seed, room) in (0..).zip(&rooms) {
        let rays = rays_at_edges(room, 20_000, &mut Numbers(hash(seed)));
        assert_eq!(leaks(&CpuExecutor, room, &rays, 2), 0, "{}", room.name);
    }
    with_gpu(|gpu| {
        for (seed, room) in (0..).zip(&rooms) {
            let rays = rays_at_edges(room, 2_000, &mut Numbers(hash(seed)));
            assert_eq!(leaks(gpu, room, &rays, 2), 0, "{} on a GPU", room.name);
        }
    });
}

/// The same of rooms that are instances, brought to their size, place and proportions by transforms.
#[test]
fn no_ray_leaves_an_instance_of_a_room() {
    let turn = DQuat::from_axis_angle(DVec3::new(1.0, -2.0, 0.5).normalize(), 1.1);
    let place = DVec3::new(3.0, -1.0, 0.25);
    let transforms = [
        DAffine3::from_translation(place),
        DAffine3::from_scale(DVec3::new(1e3, -1e3, 1e3)),
        DAffine3::from_scale_rotation_translation(DVec3::splat(0.01), turn, place * 0.01),
        DAffine3::from_scale_rotation_translation(DVec3::new(4.0, 0.5, -1.0), turn, place),
    ];
    for (seed, (name, scene, middle)) in (0..).zip(shapes()) {
        for (number, transform) in transforms.iter().enumerate() {
            let mut instanced = scene.clone();
            let shape = instanced.add_shape(instanced.meshes[0].clone());
            instanced.meshes.clear();
            instanced.add_instance(shape, *transform);
            // Rays are aimed at its edges in the world.
            let middle = transform.transform_point3(middle.as_dvec3()).as_vec3();
            let world = scene.meshes[0].moved(transform);
            let name = format!("{name}, transform {number}");
            let aimed = Room {
                name: name.clone(),
                scene: Scene { meshes: vec![world], ..scene.clone() },
                middle,
            };
            let rays = rays_at_edges(&aimed, 20_000, &mut Numbers(hash(seed)));
            let room = Room { name, scene: instanced, middle };
            assert_eq!(leaks(&CpuExecutor, &room, &rays, 2), 0, "{}", room.name);
        }
    }
}

/// In an f32 a room so far from the origin has little more than its shape. Rays that graze an edge
/// may pass there, one in a hundred thousand of those that are aimed at it.
#[test]
fn few_rays_leave_a_room_that_is_a_thousand_times_its_size_away() {
    let count = 20_000;
    for (seed, room) in (0..).zip(rooms_at(&[Vec3::new(900.0, -500.0, 700.0)])) {
        let rays = rays_at_edges(&room, count, &mut Numbers(hash(seed)));
        let leaks = leaks(&CpuExecutor, &room, &rays, 2);
        assert!(leaks <= 3 * count / 20_000, "{}: {leaks}", room.name);
    }
}

/// Rays that bounce about as those of a render do.
#[test]
fn no_ray_leaves_a_closed_room() {
    let rooms = rooms();
    let bounces = 49;
    let in_all = std::env::var(RAYS).map_or(2_000_000, |text| text.parse().unwrap());
    let count = usize::div_ceil(in_all, rooms.len() * (bounces as usize + 1));
    for (seed, room) in (0..).zip(rooms) {
        let mut numbers = Numbers(hash(seed));
        let rays: Vec<Ray> = (0..count).map(|_| Ray::new(room.middle, numbers.vector())).collect();
        assert_eq!(leaks(&CpuExecutor, &room, &rays, bounces), 0, "{}", room.name);
    }
}
