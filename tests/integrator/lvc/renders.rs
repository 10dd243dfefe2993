//! Renders by `lvc`, and what must and must not change them.

use glam::{DVec3, Vec3};
use raystream::exec::Executor;
use raystream::exec::cpu::CpuExecutor;
use raystream::exec::kernels::table;
use raystream::render::AllocatorKind::{Atomic, Paper, Runs, Uniform};
use raystream::render::{
    BidirectionalTechniques, Budget, IntegratorKind, LightCacheSettings, PreparedScene, Renderer,
    Sampling, Settings, run,
};
use raystream::scene::{FilmSize, Scene};
use raystream_tests::executors::Hindered;
use raystream_tests::scenes::{self, add_quad};
use raystream_tests::{prepare, render, render_on, settings, with_gpu};

/// The scene's own settings, with this many light paths a round.
pub fn lvc(scene: &Scene, light_paths: u32) -> Settings {
    Settings {
        integrator: IntegratorKind::Lvc,
        light_cache: LightCacheSettings { light_paths: Some(light_paths), ..Default::default() },
        ..settings(scene)
    }
}

/// The pictures of `count` rounds of `samples` per pixel each, row by row from the top.
pub fn rounds<E: Executor>(
    executor: &E,
    scene: &PreparedScene,
    settings: &Settings,
    count: usize,
    samples: u32,
) -> Vec<Vec<DVec3>> {
    let mut renderer = Renderer::new(executor, scene, settings).expect("the scene fits");
    let mut before = vec![DVec3::ZERO; (settings.size.width * settings.size.height) as usize];
    let mut pictures = Vec::with_capacity(count);
    for round in 1..=count {
        renderer.uniform_round(samples).finish().expect("the device works");
        let film = renderer.film().expect("the device works");
        // Rounds are of one length, so the mean of their pictures is that of all samples, and of
        // all light paths.
        let samples = f64::from(samples) * round as f64;
        let black = vec![Vec3::ZERO; film.radiance.len()];
        let splats = film.splats.as_ref().unwrap_or(&black);
        let sums: Vec<DVec3> = film
            .radiance
            .iter()
            .zip(splats)
            .map(|(pixel, splat)| {
                (pixel.sum().as_dvec3() / samples + splat.as_dvec3()) * round as f64
            })
            .collect();
        pictures.push(sums.iter().zip(&before).map(|(sum, before)| *sum - *before).collect());
        before = sums;
    }
    pictures
}

/// The CPU with streams of at most `slots` slots.
fn fast(slots: u64) -> Hindered<'static, CpuExecutor> {
    Hindered::by_buffers(&CpuExecutor, slots * 32).granting_larger()
}

/// The same, the first batches of which are so slow that the next are short.
fn slow(slots: u64) -> Hindered<'static, CpuExecutor> {
    fast(slots).with_slow_batches(&table::trace_eye_paths, 3)
}

#[test]
fn streams_and_batches_do_not_change_the_film() {
    let mut scene = scenes::room(scenes::glass(1.5), 1.0);
    scene.film = FilmSize { width: 41, height: 29 };
    let prepared = prepare(&scene);
    let settings = Settings { independent_sampler: false, ..lvc(&scene, 500) };
    let at_once = render(&prepared, &settings, 3);
    assert_eq!(render_on(&slow(1024), &prepared, &settings, 3), at_once);
    assert_ne!(render_on(&CpuExecutor, &prepared, &Settings { seed: 2, ..settings }, 3), at_once);
}

/// The length of rounds follows from the pilot run, not from time, and each round has light paths
/// of its own.
#[test]
fn a_render_is_repeatable() {
    let mut scene = scenes::room(scenes::mirror(0.9), 1.0);
    scene.film = FilmSize { width: 20, height: 15 };
    let prepared = prepare(&scene);
    for sampling in [Sampling::UNIFORM, Sampling { allocator: Runs, ..Sampling::UNIFORM }] {
        let settings = Settings {
            integrator: IntegratorKind::Lvc,
            sampling,
            independent_sampler: false,
            ..settings(&scene)
        };
        let film = |executor: &Hindered<'_, CpuExecutor>| {
            let mut renderer = Renderer::new(executor, &prepared, &settings).unwrap();
            run(&mut renderer, Budget::samples(40), &|| false, &mut |_| ()).unwrap();
            renderer.film().unwrap()
        };
        assert_eq!(film(&slow(1 << 20)), film(&fast(1 << 20)), "{:?}", sampling.allocator);
    }
    let lengths = rounds(&CpuExecutor, &prepared, &lvc(&scene, 50), 2, 1);
    assert_ne!(lengths[0], lengths[1], "rounds differ");
}

/// Without connections what is left is the path tracer, number for number: the paths, their
/// roulette, their weights.
#[test]
fn without_connections_it_is_the_path_tracer() {
    for (name, mut scene) in [
        ("glass", scenes::room(scenes::glass(1.5), 1.0)),
        ("smooth", scenes::smooth_room(scenes::diffuse(0.7))),
        ("mirror", scenes::smooth_room(scenes::mirror(0.9))),
    ] {
        scene.background = Vec3::new(0.1, 0.2, 0.3);
        let prepared = prepare(&scene);
        let path_tracer = settings(&scene);
        let expected = render(&prepared, &path_tracer, 32);
        let techniques = BidirectionalTechniques::WithoutConnections;
        let light_cache = LightCacheSettings { techniques, ..Default::default() };
        let film = render(
            &prepared,
            &Settings { integrator: IntegratorKind::Lvc, light_cache, ..path_tracer },
            32,
        );
        for (pixel, (a, b)) in film.color().iter().zip(expected.color()).enumerate() {
            assert!(
                (*a - b).abs().max_element() <= 1e-4 * b.max_element(),
                "{name}, pixel {pixel}: {a} and {b}"
            );
        }
        let rays = |film: &raystream::film::Film| {
            film.radiance.iter().map(|p| u64::from(p.rays)).sum::<u64>()
        };
        let (rays, expected) = (rays(&film), rays(&expected));
        assert!(rays <= expected, "{name}: {rays} rays, {expected} of the path tracer");
    }
}

/// Nothing but a background, or paths too short to be connected: there is no cache, and nothing is
/// traced for it.
#[test]
fn without_a_cache_it_is_the_path_tracer() {
    let mut dark = scenes::empty(Vec3::new(0.0, 0.3, 4.0), Vec3::ZERO);
    let white = dark.add_material(scenes::diffuse(0.8));
    scenes::add_ball(&mut dark, Vec3::ZERO, 1.0, 2, white);
    for (mut scene, max_depth) in [(dark, 20), (scenes::room(scenes::mirror(0.9), 1.0), 1)] {
        scene.background = Vec3::ONE;
        let prepared = prepare(&scene);
        let path_tracer = Settings { max_depth, ..settings(&scene) };
        let expected = render(&prepared, &path_tracer, 8);
        let film =
            render(&prepared, &Settings { integrator: IntegratorKind::Lvc, ..path_tracer }, 8);
        for (a, b) in film.color().iter().zip(expected.color()) {
            assert!((*a - b).abs().max_element() <= 1e-4 * b.max_element(), "{a} and {b}");
        }
    }
}

/// A lamp that shines into the void: light paths leave no vertex, so the cache is empty.
#[test]
fn an_empty_cache_is_no_trouble() {
    let mut scene = scenes::empty(Vec3::new(0.0, 0.0, 3.0), Vec3::ZERO);
    let lamp = scene.add_material(scenes::emissive(2.0, 0.0));
    add_quad(&mut scene, Vec3::new(-0.5, -0.5, 0.0), Vec3::X, Vec3::Y, lamp);
    let prepared = prepare(&scene);
    let expected = render(&prepared, &settings(&scene), 4);
    let test = |film: raystream::film::Film| assert_eq!(film.color(), expected.color());
    test(render(&prepared, &lvc(&scene, 100), 4));
    test(render(&prepared, &Settings { integrator: IntegratorKind::Lvc, ..settings(&scene) }, 4));
    with_gpu(|gpu| {
        let film = render_on(gpu, &prepared, &lvc(&scene, 100), 4);
        assert!(
            film.color().iter().all(|color| color.is_finite())
                && film.color()[6 * 16 + 8] == Vec3::splat(2.0)
        );
    });
}

#[test]
fn every_allocator_renders_with_it() {
    let scene = scenes::room(scenes::glass(1.5), 1.0);
    let prepared = prepare(&scene);
    for allocator in [Uniform, Paper, Atomic, Runs] {
        let sampling = Sampling { allocator, initial_samples: 4, ..Sampling::UNIFORM };
        let settings = Settings { sampling, ..lvc(&scene, 400) };
        let mut renderer = Renderer::new(&CpuExecutor, &prepared, &settings).unwrap();
        let outcome = run(&mut renderer, Budget::samples(24), &|| false, &mut |_| ()).unwrap();
        let film = renderer.film().unwrap();
        let samples: u64 = film.radiance.iter().map(|pixel| u64::from(pixel.samples())).sum();
        assert_eq!((samples, outcome.paths), (24 * 192, 24 * 192), "{allocator:?}");
        assert!(
            film.color().iter().all(|color| color.is_finite() && color.max_element() > 0.0),
            "{allocator:?}"
        );
    }
}

/// More light paths than memory has room for is an error that says what to change.
#[test]
fn too_many_light_paths_are_refused() {
    let mut scene = scenes::room(scenes::mirror(0.9), 1.0);
    scene.limits.max_depth = 1 << 20;
    let prepared = prepare(&scene);
    let error =
        Renderer::new(&CpuExecutor, &prepared, &lvc(&scene, 1 << 22)).err().expect("too many");
    assert!(error.to_string().contains("light paths"), "{error}");
}
