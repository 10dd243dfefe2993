//! Hits of the same rays on the GPU, on the CPU by all its instructions, and by brute force.

use bytemuck::Zeroable;
use glam::Vec3;
use raystream::exec::cpu::CpuExecutor;
use raystream::exec::{Array, ExecError, Executor, kernels};
use raystream::render::{BvhQuality, PreparedScene, Settings};
use raystream::scene::{FilmSize, Scene, load, load_named};
use raystream_shaders::film::stream::Slot;
use raystream_shaders::film::tiles::pixel_of_rank;
use raystream_shaders::integrator::params::PathParams;
use raystream_shaders::math::random::hash;
use raystream_shaders::probe::BruteForceParams;
use raystream_shaders::scene::ray::{Hit, Ray};
use raystream_tests::{cpus, large_scenes, prepare, scenes, settings, with_gpu};

/// The nearest hits of rays, and 1 for each that hits anything, else 0.
pub fn hits<E: Executor>(
    executor: &E,
    scene: &PreparedScene,
    rays: &[Ray],
) -> Result<(Vec<Hit>, Vec<u32>), ExecError> {
    let threads = rays.len() as u32;
    let rays = Array::from_slice(executor, "rays", rays)?;
    let buffers = scene.buffers(executor)?;
    let hits = Array::zeroed(executor, "hits", threads as usize)?;
    let occluded = Array::zeroed(executor, "occluded", threads as usize)?;
    let parameters = PathParams { threads, scene: scene.params, ..PathParams::zeroed() };
    executor.run(&[
        kernels::closest_hits(&parameters, &buffers, rays.view(), hits.view()),
        kernels::any_hits(&parameters, &buffers, rays.view(), occluded.view()),
    ])?;
    Ok((hits.read(executor)?, occluded.read(executor)?))
}

/// The hits of rays by testing all triangles: what hits are by definition.
fn hits_by_brute_force<E: Executor>(executor: &E, scene: &PreparedScene, rays: &[Ray]) -> Vec<Hit> {
    let threads = rays.len() as u32;
    let triangles = scene.numbers;
    let rays = Array::from_slice(executor, "rays", rays).unwrap();
    let buffers = scene.buffers(executor).unwrap();
    let hits = Array::zeroed(executor, "hits", threads as usize).unwrap();
    // llvmpipe ends loops of 65536 turns, of which finding an instance takes some.
    let part = if scene.instances > 0 { 1 << 11 } else { 1 << 14 };
    for first in (0..triangles).step_by(part) {
        let (end, scene) = (triangles.min(first + part as u32), scene.params);
        let parameters = BruteForceParams { threads, first, end, scene, pad: 0 };
        let launch = kernels::brute_force_hits(&parameters, &buffers, rays.view(), hits.view());
        executor.run(&[launch]).unwrap();
    }
    hits.read(executor).unwrap()
}

/// Asserts that traversal finds the `expected` hits: the same distances, bit by bit, and the same
/// triangles of the scene.
fn assert_hits_are<E: Executor>(
    expected: &[Hit],
    executor: &E,
    scene: &PreparedScene,
    rays: &[Ray],
    what: &str,
) {
    let (found, occluded) = hits(executor, scene, rays).unwrap();
    let of_scene = |hit: &Hit| (hit.t.to_bits(), scene.scene_triangle(hit));
    for (ray, (hit, expected)) in rays.iter().zip(found.iter().zip(expected)) {
        assert_eq!(of_scene(hit), of_scene(expected), "{what}: {ray:?}: {hit:?}, not {expected:?}");
    }
    let disagree =
        expected.iter().zip(&occluded).filter(|(hit, any)| hit.is_some() != (**any == 1));
    assert_eq!(disagree.count(), 0, "{what}: whether anything is hit");
}

/// Asserts that traversal finds the hits that testing all triangles finds: on the CPU by all its
/// instructions for all rays, and on the GPU for some of them.
pub fn assert_hits_are_exact(scene: &PreparedScene, rays: &[Ray], what: &str) {
    let expected = hits_by_brute_force(&CpuExecutor, scene, rays);
    for cpu in cpus() {
        let what = format!("{what}, {}", cpu.description());
        assert_hits_are(&expected, &cpu, scene, rays, &what);
    }
    with_gpu(|gpu| {
        let some: Vec<Ray> = rays.iter().copied().step_by(rays.len().div_ceil(4096)).collect();
        let expected = hits_by_brute_force(gpu, scene, &some);
        assert_hits_are(&expected, gpu, scene, &some, &format!("{what} on a GPU"));
    });
}

/// The rays through the pixel centres of the scene's own camera.
fn primary_rays(scene: &PreparedScene, size: FilmSize, settings: &Settings) -> Vec<Ray> {
    let threads = size.width * size.height;
    let slots: Vec<Slot> = (0..threads).map(|rank| Slot { rank, sample: 0 }).collect();
    let slots = Array::from_slice(&CpuExecutor, "slots", &slots).unwrap();
    let rays: Array<_, Ray> = Array::zeroed(&CpuExecutor, "rays", threads as usize).unwrap();
    let parameters = PathParams { threads, ..scene.parameters(&Settings { size, ..*settings }) };
    let buffers = scene.buffers(&CpuExecutor).unwrap();
    let launch = kernels::primary_rays(&parameters, &buffers, slots.view(), rays.view());
    CpuExecutor.run(&[launch]).unwrap();
    let (x, y) = pixel_of_rank(0, size.width, size.height);
    assert_eq!((x, y), (0, 0));
    rays.read(&CpuExecutor).unwrap()
}

#[test]
fn primary_rays_find_their_hits() {
    let mut scenes = vec![load_named("cornell_ball").unwrap()];
    if let Some(folder) = large_scenes() {
        for name in ["sibenik", "conference"] {
            scenes.push(load(&folder.join(name).join(name).with_extension("json")).unwrap());
        }
    }
    for scene in scenes {
        let settings = settings(&scene);
        let prepared = prepare(&scene);
        let rays = primary_rays(&prepared, FilmSize { width: 80, height: 60 }, &settings);
        assert_hits_are_exact(&prepared, &rays, &scene.name);
    }
}

/// Rays in the planes of a box's faces and along its edges, with zeros of both signs: no NaN may
/// lose a hit.
#[test]
fn axis_parallel_rays_find_their_hits() {
    let scene = scenes::room(scenes::mirror(0.9), 1.0);
    let prepared = prepare(&scene);
    let mut rays = Vec::new();
    for axis in 0..3 {
        for sign in [1.0, -1.0] {
            for zero in [0.0, -0.0] {
                for step in 0..400 {
                    let mut direction = Vec3::splat(zero);
                    direction[axis] = sign;
                    let origin =
                        Vec3::new((step % 20) as f32 / 20.0, (step / 20) as f32 / 20.0, 0.45)
                            + 0.013;
                    let origin = [
                        origin,
                        Vec3::new(origin.z, origin.x, origin.y),
                        Vec3::new(origin.y, origin.z, origin.x),
                    ];
                    rays.push(Ray::new(origin[step % 3], direction));
                }
            }
        }
    }
    assert_hits_are_exact(&prepared, &rays, "axis-parallel rays");
    let (found, _) = hits(&CpuExecutor, &prepared, &rays).unwrap();
    assert!(found.iter().all(Hit::is_some), "the room is closed");
}

/// Numbers in [-1, 1).
fn numbers(seed: u32) -> impl FnMut() -> f32 {
    let mut state = hash(seed);
    move || {
        state = hash(state.wrapping_add(0x9e37_79b9));
        (state >> 8) as f32 / (1 << 23) as f32 - 1.0
    }
}

/// Some 300 triangles: small ones, needles, ones as large as the scene, in planes along the axes
/// and not, copies of each other in other orders of corners, and several at the same corners.
fn jumble(seed: u32) -> Scene {
    let mut number = numbers(seed);
    let mut scene = scenes::empty(Vec3::ZERO, Vec3::X);
    let material = scene.add_material(scenes::diffuse(0.5));
    let far = [0.0, 0.0, 7.0, 100.0][seed as usize % 4];
    let place = Vec3::new(far, -far, far);
    for k in 0..150 {
        let mut vector = |size: f32| Vec3::new(number(), number(), number()) * size;
        let size = [1.0, 0.1, 1e-3, 30.0][k % 4];
        let a = place + vector(1.0);
        let mut corners = [a, a + vector(size), a + vector(size)];
        if k % 5 == 0 {
            let needle = corners[1] + vector(1e-4 * size);
            corners[2] = needle;
        }
        if k % 3 == 0 {
            // In a plane along the axes, of which there are few.
            let height = place[k % 2] + (k % 7) as f32 * 0.25;
            corners.iter_mut().for_each(|corner| corner[k % 2] = height);
        }
        scenes::add_triangle(&mut scene, corners, material);
        let [a, b, c] = corners;
        match k % 4 {
            0 => scenes::add_triangle(&mut scene, [c, b, a], material),
            1 => scenes::add_triangle(&mut scene, [b, c, a], material),
            2 => scenes::add_triangle(&mut scene, [a, b, b + (b - a) + (b - c)], material),
            _ => scenes::add_triangle(&mut scene, [a, b, c], material),
        }
    }
    scene
}

/// Rays from all about, from near and from far away, along axes, from corners, and towards corners
/// and edges.
fn rays_through(scene: &Scene, seed: u32, count: usize) -> Vec<Ray> {
    let mut number = numbers(seed ^ 0x5eed);
    let mesh = &scene.meshes[0];
    let ray = |k: usize| {
        let mut corners =
            || mesh.corners(((number() + 1.0) * 0.5 * mesh.triangles.len() as f32) as usize);
        let ([a, b, c], [from, ..]) = (corners(), corners());
        let mut vector = |size: f32| Vec3::new(number(), number(), number()) * size;
        let target = match k % 4 {
            0 => a,
            1 => a.lerp(b, 0.5 + vector(0.5).x),
            2 => (a + b + c) / 3.0,
            _ => a + vector(1.0),
        };
        let origin = match k % 5 {
            0 => from,
            1 => target + vector(0.01),
            2 => target + vector(300.0),
            3 => {
                let mut origin = target;
                origin[k % 3] += 3.0;
                origin
            }
            _ => target + vector(3.0),
        };
        Ray::new(origin, target - origin)
    };
    (0..count).map(ray).filter(|ray| ray.direction != Vec3::ZERO).collect()
}

#[test]
fn hits_of_a_jumble_are_those_of_brute_force() {
    for seed in 0..8 {
        let scene = jumble(seed);
        let rays = rays_through(&scene, seed, 10_000);
        for quality in [BvhQuality::Fast, BvhQuality::High] {
            let prepared = PreparedScene::new(&scene, quality).unwrap();
            assert_hits_are_exact(&prepared, &rays, &format!("jumble {seed}"));
        }
    }
}

/// Of triangles in one place the first in the scene is hit, in whatever order they lie in memory.
#[test]
fn the_first_of_coincident_triangles_is_hit() {
    let mut scene = scenes::empty(Vec3::ZERO, Vec3::X);
    let material = scene.add_material(scenes::diffuse(0.5));
    let corners = [Vec3::ZERO, Vec3::X, Vec3::Y];
    for k in 0..300 {
        // Larger ones in the same plane, each with the first within.
        let grown = corners.map(|corner| corner * (300 - k) as f32 - Vec3::splat(0.0));
        scenes::add_triangle(&mut scene, grown, material);
    }
    let prepared = prepare(&scene);
    let ray = |k: usize| {
        let x = 0.1 + 0.35 * k as f32;
        Ray::new(Vec3::new(x, x, 1.0), Vec3::NEG_Z)
    };
    let rays: Vec<Ray> = (0..400).map(ray).collect();
    assert_hits_are_exact(&prepared, &rays, "one plane");
    let (found, _) = hits(&CpuExecutor, &prepared, &rays).unwrap();
    assert!(found.iter().all(|hit| prepared.scene_triangle(hit) == Some(0)));
}
