//! The GPU against the CPU: whatever is integer or accumulation, bit for bit; hits of the same
//! rays; pictures by statistics.

mod common;

use bytemuck::Zeroable;
use common::statistics::assert_same_expectation;
use common::{prepare, render, render_on, scenes, settings, with_gpu};
use glam::Vec3;
use raystream::exec::cpu::CpuExecutor;
use raystream::exec::{Array, ExecError, Executor, kernels};
use raystream::render::{PreparedScene, Settings};
use raystream::scene::{FilmSize, load_named};
use raystream_bench::rays::same_distance;
use raystream_shaders::film::FilmPixel;
use raystream_shaders::film::accumulate::CountParams;
use raystream_shaders::film::stream::{NO_PIXEL, RunWindow, Slot};
use raystream_shaders::film::tiles::pixel_of_rank;
use raystream_shaders::integrator::params::PathParams;
use raystream_shaders::math::random::hash;
use raystream_shaders::scene::ray::{Hit, Ray};

fn count_rays<E: Executor>(executor: &E, film: &[FilmPixel]) -> Vec<u32> {
    let parameters =
        CountParams { threads: 64, pixels: film.len() as u32, ..CountParams::zeroed() };
    let film = Array::from_slice(executor, "film", film).unwrap();
    let counts = Array::zeroed(executor, "ray counts", 64).unwrap();
    executor.run(&[kernels::count_rays(&parameters, film.view(), counts.view())]).unwrap();
    counts.read(executor).unwrap()
}

#[test]
fn ray_counts_are_equal() {
    let film: Vec<FilmPixel> =
        (0..500_u32).map(|k| FilmPixel { rays: hash(k) >> 12, ..FilmPixel::zeroed() }).collect();
    let cpu = count_rays(&CpuExecutor, &film);
    assert_eq!(cpu.iter().sum::<u32>(), film.iter().map(|p| p.rays).sum::<u32>());
    with_gpu(|gpu| assert_eq!(count_rays(gpu, &film), cpu));
}

/// The positions on a flat wall straight ahead are the tracer's random numbers: both samplers draw
/// the same on the GPU.
#[test]
fn random_numbers_are_equal() {
    let mut scene = scenes::empty(Vec3::ZERO, Vec3::NEG_Z);
    scene.film = FilmSize { width: 16, height: 16 };
    let wall = scene.add_material(scenes::diffuse(0.5));
    scenes::add_quad(&mut scene, Vec3::new(-4.0, -4.0, -1.0), Vec3::X * 8.0, Vec3::Y * 8.0, wall);
    let prepared = prepare(&scene);
    with_gpu(|gpu| {
        for independent_sampler in [false, true] {
            let settings = Settings { independent_sampler, max_depth: 1, ..settings(&scene) };
            let cpu = render(&prepared, &settings, 4).position();
            let gpu = render_on(gpu, &prepared, &settings, 4).position();
            for (pixel, (a, b)) in gpu.iter().zip(&cpu).enumerate() {
                // Pixels are 0.045 wide: a wrong bit among the upper 15 of a number moves the point
                // by more than this.
                assert!((*a - *b).abs().max_element() < 2e-6, "pixel {pixel}: {a} and {b}");
            }
        }
    });
}

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
    let mut names = vec!["cornell_ball".to_owned()];
    if let Some(folder) = common::large_scenes() {
        names.extend(
            ["sibenik", "conference"]
                .map(|name| folder.join(name).join(name).display().to_string() + ".json"),
        );
    }
    for name in names {
        let path = std::path::Path::new(&name);
        let scene = if path.is_absolute() || name.contains('/') {
            raystream::scene::load(path)
        } else {
            load_named(&name)
        };
        let scene = scene.unwrap();
        let settings = settings(&scene);
        let prepared = prepare(&scene);
        let rays = primary_rays(&prepared, FilmSize { width: 160, height: 120 }, &settings);
        assert_same_hits(&prepared, &rays, &name);
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

#[test]
fn pictures_have_the_same_expectation() {
    for (name, ball) in [("mirror", scenes::mirror(0.9)), ("glass", scenes::glass(1.5))] {
        let scene = scenes::room(ball, 1.0);
        let prepared = prepare(&scene);
        let settings = settings(&scene);
        let cpu = render(&prepared, &settings, 256);
        with_gpu(|gpu| {
            let independent = render_on(gpu, &prepared, &Settings { seed: 7, ..settings }, 256);
            assert_same_expectation(&cpu, &independent, name);
            // The same seed gives the same paths, all but those that the arithmetic sends
            // elsewhere.
            let same_seed =
                render_on(gpu, &prepared, &Settings { seed: settings.seed, ..settings }, 8);
            let cpu_same = render(&prepared, &settings, 8);
            let close = same_seed
                .color()
                .iter()
                .zip(cpu_same.color())
                .filter(|(a, b)| (**a - *b).abs().max_element() <= 1e-3 * b.max_element() + 1e-6)
                .count();
            assert!(close * 10 >= same_seed.radiance.len() * 9, "{name}: {close} pixels alike");
        });
    }
}

/// More threads than one dimension of the grid holds: 65535 groups of 64 are 4 194 240.
#[test]
fn launches_are_folded_into_rows() {
    with_gpu(|gpu| {
        let threads = 4_194_240 + 1000;
        let slots =
            Array::from_slice(gpu, "slots", &vec![Slot { rank: 1, sample: 2 }; threads as usize])
                .unwrap();
        let window = RunWindow { threads, first_rank: 0, pixels: 0, samples: 0 };
        gpu.run(&[kernels::clear_slots(&window, slots.view())]).unwrap();
        let cleared = slots.read(gpu).unwrap();
        assert_eq!(
            cleared.iter().position(|slot| slot.rank != NO_PIXEL),
            None,
            "the first slot that was left out"
        );
    });
}

/// A buffer beyond the device's limit is refused with a message, before the driver sees it.
#[test]
fn too_large_a_buffer_is_an_error() {
    with_gpu(|gpu| {
        let limit = gpu.limits().buffer_bytes;
        let error = gpu.allocate("a test", limit + 4).expect_err("too large").to_string();
        assert!(error.contains("a test") && error.contains("use the CPU"), "{error}");
    });
}
