//! Light tracing: the exactness of its film, and its pictures against those of the path tracer.

use super::renders::{lvc, rounds};
use bytemuck::Zeroable;
use glam::{DVec3, UVec4, Vec3};
use raystream::exec::cpu::CpuExecutor;
use raystream::exec::{Array, Executor, kernels};
use raystream::render::AllocatorKind::{Paper, Runs};
use raystream::render::BidirectionalTechniques::LightTracing;
use raystream::render::film::splats::SplatFilm;
use raystream::render::integrator::lvc::gather;
use raystream::render::{LightCacheSettings, PreparedScene, Renderer, Sampling, Settings};
use raystream::scene::{FilmSize, Scene, load_named};
use raystream_shaders::film::splats::{
    CUT_OFF, FIRST_SPLAT, HEADER_WORDS, PIXEL_WORDS, ROUNDS, Splat,
};
use raystream_shaders::integrator::lvc::LvcParams;
use raystream_shaders::integrator::lvc::cache::{HEADER_ROWS, LightCache};
use raystream_shaders::integrator::lvc::light_vertex::ROWS_PER_VERTEX;
use raystream_shaders::math::fixed::unit_exponent;
use raystream_shaders::math::random::{hash, unit_float};
use raystream_shaders::parallel::prefix::BlockParams;
use raystream_shaders::scene::camera::NO_PIXEL;
use raystream_tests::scenes::{self, add_quad};
use raystream_tests::statistics::assert_rounds_have_expectation;
use raystream_tests::{prepare, render, settings, with_gpu};

const SIZE: FilmSize = FilmSize { width: 7, height: 5 };

/// A list of `count` splats of all magnitudes, a tenth of them nowhere, many on the same pixels.
fn list(count: u32, seed: u32) -> Vec<UVec4> {
    let number = |k: u32| unit_float(hash(k ^ seed));
    let splat = |index: u32| {
        let component = |c: u32| {
            let scale = (number(7 * index + c) * 120.0 - 60.0).exp2();
            if number(7 * index + 3 + c) < 0.1 { 0.0 } else { scale }
        };
        let pixel = hash(index ^ seed) % (SIZE.width * SIZE.height * 10 / 9);
        let pixel = if pixel < SIZE.width * SIZE.height { pixel } else { NO_PIXEL };
        Splat { radiance: Vec3::new(component(0), component(1), component(2)), pixel }
    };
    let header = UVec4::new(count, 0, 0, 0);
    std::iter::once(header).chain((0..count).map(|index| splat(index).to_row())).collect()
}

/// The words after each list has been added to the film.
fn words<E: Executor>(executor: &E, lists: &[&[UVec4]], threads: u32) -> (Vec<u32>, Vec<Vec3>) {
    let film = SplatFilm::new(executor, SIZE, 1, unit_exponent(1.0)).unwrap();
    for rows in lists {
        let splats = Array::from_slice(executor, "splats", rows).unwrap();
        executor.run(&[film.add(threads, splats.view())]).unwrap();
    }
    let sums = film.read(executor).unwrap();
    let mean = sums.mean();
    (sums.words, mean)
}

/// Any order, any number of lanes, any device: the same words.
#[test]
fn the_film_depends_on_no_order_and_no_device() {
    let (first, second) = (list(20_000, 3), list(333, 4));
    let (expected, picture) = words(&CpuExecutor, &[&first, &second], 4096);
    assert_eq!(expected[ROUNDS as usize], 2);
    assert!(expected[CUT_OFF as usize] > 0, "some splats are too bright");
    let mut reversed = first.clone();
    reversed[FIRST_SPLAT as usize..].reverse();
    let agree = |what: &str, words: (Vec<u32>, Vec<Vec3>)| {
        assert!(words.0 == expected && words.1 == picture, "{what}");
    };
    agree("another order", words(&CpuExecutor, &[&second, &reversed], 4096));
    agree("one lane", words(&CpuExecutor, &[&first, &second], 1));
    with_gpu(|gpu| {
        agree("GPU", words(gpu, &[&first, &second], 4096));
        agree("GPU, few lanes", words(gpu, &[&reversed, &second], 100));
    });
}

/// Sums are those of f64 within half a unit of each splat, and carry from word to word.
#[test]
fn the_film_is_the_mean_of_its_splats() {
    let value = |k: u32| (0.5 + unit_float(hash(k))) * if k.is_multiple_of(3) { 1e6 } else { 1e-3 };
    let count = 50_000;
    let mut rows = vec![UVec4::new(count, 0, 0, 0)];
    let splat = |k| Splat { radiance: Vec3::new(value(k), 0.0, value(k) * 0.5), pixel: 2 };
    rows.extend((0..count).map(|k| splat(k).to_row()));
    let (words, picture) = words(&CpuExecutor, &[&rows, &rows, &rows], 512);
    let sum: f64 = (0..count).map(|k| f64::from(value(k))).sum();
    let expected = DVec3::new(sum, 0.0, 0.5 * sum);
    assert!((picture[2].as_dvec3() - expected).abs().max_element() < 1e-7 * sum);
    assert!(picture.iter().enumerate().all(|(pixel, color)| pixel == 2 || *color == Vec3::ZERO));
    let first = (HEADER_WORDS + 2 * PIXEL_WORDS) as usize;
    assert!(words[first..first + 4].iter().all(|&word| word > 0), "all words are in use");
}

/// The splats of a cache as `executor` finds them.
fn splats<E: Executor>(
    executor: &E,
    prepared: &PreparedScene,
    parameters: &LvcParams,
    cache: &[UVec4],
) -> Vec<Splat> {
    let scene = prepared.buffers(executor).unwrap();
    let cache = Array::from_slice(executor, "cache", cache).unwrap();
    let rows = Array::zeroed(executor, "splats", cache.len()).unwrap();
    executor
        .run(&[kernels::connect_to_camera(parameters, &scene, cache.view(), rows.view())])
        .unwrap();
    let rows: Vec<UVec4> = rows.read(executor).unwrap();
    let count = rows[0].x as usize;
    rows[FIRST_SPLAT as usize..][..count].iter().map(|&row| Splat::from_row(row)).collect()
}

fn traced_cache(prepared: &PreparedScene, parameters: &LvcParams) -> Vec<UVec4> {
    let (paths, room) = (parameters.threads, parameters.vertices_per_path);
    let buffers = prepared.buffers(&CpuExecutor).unwrap();
    let array = |len: u32| Array::zeroed(&CpuExecutor, "test", len as usize).unwrap();
    let counts = Array::zeroed(&CpuExecutor, "counts", paths as usize).unwrap();
    let blocks = BlockParams::per_block(paths).blocks;
    let offsets = Array::zeroed(&CpuExecutor, "offsets", blocks as usize + 1).unwrap();
    let scratch = array(paths * room * ROWS_PER_VERTEX);
    let cache = array(HEADER_ROWS + paths * room * ROWS_PER_VERTEX);
    let trace = kernels::trace_light_paths(parameters, &buffers, counts.view(), scratch.view());
    CpuExecutor.run(&[trace]).unwrap();
    CpuExecutor.run(&gather(paths, room, &counts, &offsets, &scratch, &cache)).unwrap();
    cache.read(&CpuExecutor).unwrap()
}

/// Of one cache, both devices make the same splats, but for roundings and for vertices at the edges
/// of pixels and of shadows.
#[test]
fn devices_see_the_same_vertices() {
    let mut scene = scenes::room(scenes::glass(1.5), 1.0);
    scene.film = FilmSize { width: 40, height: 30 };
    let prepared = prepare(&scene);
    let parameters = LvcParams {
        threads: 3000,
        light_segments: 6,
        vertices_per_path: 6,
        emission_samples: 1.0,
        light_samples: 1.0,
        connection_samples: 0.5,
        camera_samples: 300.0,
        path: prepared.parameters(&settings(&scene)),
        ..LvcParams::zeroed()
    };
    let cache = traced_cache(&prepared, &parameters);
    let by_cpu = splats(&CpuExecutor, &prepared, &parameters, &cache);
    assert_eq!(by_cpu.len() as u32, LightCache::new(&cache).len());
    let seen = by_cpu.iter().filter(|splat| splat.pixel != NO_PIXEL).count();
    assert!(seen > 1000, "the camera sees {seen} of {} vertices", by_cpu.len());
    with_gpu(|gpu| {
        let by_gpu = splats(gpu, &prepared, &parameters, &cache);
        assert_eq!(by_gpu.len(), by_cpu.len());
        let is_close = |(a, b): (&Splat, &Splat)| {
            let difference = (a.radiance - b.radiance).abs().max_element();
            a.pixel == b.pixel && difference <= 1e-4 * a.radiance.max_element()
        };
        let other = by_cpu.iter().zip(&by_gpu).filter(|&pair| !is_close(pair)).count();
        assert!(other <= by_cpu.len() / 1000, "{other} of {} splats differ", by_cpu.len());
    });
}

/// Settings that leave to light tracing whatever it can find.
fn by_light_tracing(scene: &Scene, light_paths: u32) -> Settings {
    let settings = lvc(scene, light_paths);
    let light_cache = LightCacheSettings { techniques: LightTracing, ..settings.light_cache };
    Settings { light_cache, ..settings }
}

/// Diffuse surfaces seen directly: next to nothing is left to samples of pixels, and the pictures
/// are those of the path tracer.
#[test]
fn light_tracing_alone_finds_diffuse_surfaces() {
    let mut scene = scenes::empty(Vec3::new(0.0, 1.0, 4.0), Vec3::new(0.0, 0.3, 0.0));
    let ground = scene.add_material(scenes::diffuse(0.7));
    let lamp = scene.add_material(scenes::emissive(9.0, 0.0));
    add_quad(&mut scene, Vec3::new(-9.0, 0.0, 9.0), Vec3::X * 18.0, Vec3::NEG_Z * 18.0, ground);
    scenes::add_ball(&mut scene, Vec3::new(-0.4, 0.5, 0.0), 0.5, 2, ground);
    add_quad(&mut scene, Vec3::new(-1.0, 5.0, -1.0), Vec3::X * 2.0, Vec3::Z * 2.0, lamp);
    let prepared = prepare(&scene);
    let expected = render(&prepared, &Settings { seed: 1000, ..settings(&scene) }, 4096);
    let settings = by_light_tracing(&scene, 5000);
    let pictures = rounds(&CpuExecutor, &prepared, &settings, 128, 1);
    assert_rounds_have_expectation(&expected, &pictures, "diffuse surfaces");

    let film = render(&prepared, &settings, 4);
    let sum = |colors: &[Vec3]| colors.iter().map(|color| f64::from(color.x)).sum::<f64>();
    let all = sum(&film.color());
    let splats = sum(film.splats.as_ref().expect("light tracing is on"));
    assert!(splats > 0.99 * all, "light tracing found {splats} of {all}");
}

/// Light has to find an opening: that takes many light paths, whose rare splats are bright.
#[test]
fn light_tracing_alone_finds_the_light_behind_an_opening() {
    let mut scene = load_named("opening").expect("it ships");
    scene.film = FilmSize { width: 16, height: 12 };
    let prepared = prepare(&scene);
    let expected = render(&prepared, &Settings { seed: 1000, ..settings(&scene) }, 8192);
    let settings = by_light_tracing(&scene, 20_000);
    let pictures = rounds(&CpuExecutor, &prepared, &settings, 256, 4);
    assert_rounds_have_expectation(&expected, &pictures, "opening, light tracing");
}

/// Light tracing samples the picture as a whole: rounds of any length and any allocator, which give
/// pixels different numbers of samples, leave the same splats, bit for bit.
#[test]
fn allocators_do_not_change_the_splats() {
    let scene = scenes::room(scenes::glass(1.5), 1.0);
    let prepared = prepare(&scene);
    let splats = |sampling, budget| {
        let settings = Settings { sampling, ..lvc(&scene, 500) };
        let mut renderer = Renderer::new(&CpuExecutor, &prepared, &settings).unwrap();
        for _ in 0..5 {
            renderer.step(budget).unwrap();
        }
        let film = renderer.film().unwrap();
        (film.samples(), film.splats.expect("light tracing is on"))
    };
    let (samples, expected) = splats(Sampling::UNIFORM, 1000);
    assert!(expected.iter().any(|color| color.max_element() > 0.0));
    for allocator in [Runs, Paper] {
        let sampling = Sampling { allocator, initial_samples: 3, ..Sampling::UNIFORM };
        let (others, found) = splats(sampling, 2000);
        assert!(others != samples && found == expected, "{allocator:?}");
    }
}
