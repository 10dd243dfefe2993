//! Hits of the same rays on the GPU and on the CPU, and by brute force.

use bytemuck::Zeroable;
use glam::Vec3;
use raystream::exec::cpu::CpuExecutor;
use raystream::exec::{Array, ExecError, Executor, kernels};
use raystream::render::{PreparedScene, Settings};
use raystream::scene::{FilmSize, load, load_named};
use raystream_bench::rays::same_distance;
use raystream_shaders::film::stream::Slot;
use raystream_shaders::film::tiles::pixel_of_rank;
use raystream_shaders::integrator::params::PathParams;
use raystream_shaders::scene::ray::{Hit, Ray};
use raystream_tests::{large_scenes, prepare, scenes, settings, with_gpu};

fn hits<E: Executor>(
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

/// Asserts that the GPU hits what the CPU hits.
fn assert_same_hits(scene: &PreparedScene, rays: &[Ray], what: &str) {
    let (cpu, cpu_occluded) = hits(&CpuExecutor, scene, rays).unwrap();
    assert!(
        cpu.iter().zip(&cpu_occluded).all(|(hit, &any)| hit.is_some() == (any == 1)),
        "{what}: any hit on the CPU"
    );
    with_gpu(|gpu| {
        let (gpu, gpu_occluded) = hits(gpu, scene, rays).unwrap();
        let of_scene = |hit: &Hit| scene.scene_triangles.get(hit.triangle as usize);
        let same = cpu.iter().zip(&gpu).filter(|(a, b)| of_scene(a) == of_scene(b)).count();
        assert!(
            same as f64 > 0.998 * rays.len() as f64,
            "{what}: {same} of {} hit the same triangle",
            rays.len()
        );
        // What is left: triangles that coincide or share the edge that was hit, or an edge against
        // the background, which one in a thousand may be.
        let elsewhere = cpu
            .iter()
            .zip(&gpu)
            .filter(|(a, b)| of_scene(a) != of_scene(b) && !same_distance(a.t, b.t));
        assert!(
            elsewhere.count() as f64 <= 0.001 * rays.len() as f64,
            "{what}: hits at other distances"
        );
        let disagree = gpu
            .iter()
            .zip(&gpu_occluded)
            .filter(|(hit, any)| hit.is_some() != (**any == 1))
            .count();
        assert!(disagree as f64 <= 0.001 * rays.len() as f64, "{what}: any hit on the GPU");
    });
}

/// The rays through the pixel centres of the scene's own camera.
fn primary_rays(scene: &PreparedScene, size: FilmSize, settings: &Settings) -> Vec<Ray> {
    let threads = size.width * size.height;
    let slots: Vec<Slot> = (0..threads).map(|rank| Slot { rank, sample: 0 }).collect();
    let slots = Array::from_slice(&CpuExecutor, "slots", &slots).unwrap();
    let rays: Array<_, Ray> = Array::zeroed(&CpuExecutor, "rays", threads as usize).unwrap();
    let parameters = PathParams { threads, ..scene.parameters(&Settings { size, ..*settings }) };
    CpuExecutor.run(&[kernels::primary_rays(&parameters, slots.view(), rays.view())]).unwrap();
    let (x, y) = pixel_of_rank(0, size.width, size.height);
    assert_eq!((x, y), (0, 0));
    rays.read(&CpuExecutor).unwrap()
}

#[test]
fn primary_rays_hit_the_same() {
    let mut scenes = vec![load_named("cornell_ball").unwrap()];
    if let Some(folder) = large_scenes() {
        for name in ["sibenik", "conference"] {
            scenes.push(load(&folder.join(name).join(name).with_extension("json")).unwrap());
        }
    }
    for scene in scenes {
        let settings = settings(&scene);
        let prepared = prepare(&scene);
        let rays = primary_rays(&prepared, FilmSize { width: 160, height: 120 }, &settings);
        assert_same_hits(&prepared, &rays, &scene.name);
    }
}

/// Rays in the planes of a box's faces and along its edges, with zeros of both signs: no NaN may
/// lose a hit.
#[test]
fn axis_parallel_rays_hit_the_same() {
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
    let (found, _) = hits(&CpuExecutor, &prepared, &rays).unwrap();
    for (ray, hit) in rays.iter().zip(&found) {
        let expected = raystream_bench::rays::brute_force(&prepared, ray);
        assert!(expected.is_some(), "the room is closed");
        assert!(
            hit.is_some() && same_distance(hit.t, expected.t),
            "{ray:?}: {hit:?}, brute force {expected:?}"
        );
    }
    assert_same_hits(&prepared, &rays, "axis-parallel rays");
}
