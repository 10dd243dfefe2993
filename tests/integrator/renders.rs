//! Whole renders: every integrator with every allocator.

use super::tracing::OTHERS;
use raystream::exec::Executor;
use raystream::exec::cpu::CpuExecutor;
use raystream::film::Film;
use raystream::render::AllocatorKind::{Atomic, Paper, Runs, Uniform};
use raystream::render::{Budget, IntegratorKind, PreparedScene, Renderer, Sampling, Settings, run};
use raystream::scene::FilmSize;
use raystream_tests::executors::Hindered;
use raystream_tests::scenes::{glass, mirror, room};
use raystream_tests::statistics::assert_same_expectation;
use raystream_tests::{prepare, settings, with_gpu};

fn scene(glassy: bool) -> (PreparedScene, Settings) {
    let mut scene = room(if glassy { glass(1.5) } else { mirror(0.9) }, 1.0);
    scene.film = FilmSize { width: 19, height: 13 };
    (prepare(&scene), settings(&scene))
}

fn render<E: Executor>(
    executor: &E,
    scene: &PreparedScene,
    settings: &Settings,
    samples: u32,
) -> Film {
    let mut renderer = Renderer::new(executor, scene, settings).unwrap();
    run(&mut renderer, Budget::samples(samples), &|| false, &mut |_| ()).unwrap();
    renderer.film().unwrap()
}

/// The films are the megakernel's, bit for bit.
#[test]
fn films_are_the_megakernels_on_the_cpu() {
    let (scene, settings) = scene(true);
    // So small a device cuts pools and streams.
    let device = Hindered::by_buffers(&CpuExecutor, 1 << 20);
    for allocator in [Uniform, Paper, Runs, Atomic] {
        let sampling = Sampling {
            allocator,
            initial_samples: 2,
            round_budget: Some(3.0),
            ..Sampling::UNIFORM
        };
        let settings = Settings { sampling, ..settings };
        let expected = render(&device, &scene, &settings, 40);
        for integrator in OTHERS {
            let found = render(&device, &scene, &Settings { integrator, ..settings }, 40);
            assert!(found.radiance == expected.radiance, "{integrator:?}, {allocator:?}");
        }
    }
}

/// Independent renders agree, of both devices.
#[test]
fn pictures_agree() {
    for glassy in [false, true] {
        let (scene, settings) = scene(glassy);
        let expected = render(&CpuExecutor, &scene, &settings, 256);
        for (seed, integrator) in (10..).zip(OTHERS) {
            let settings = Settings { seed, integrator, ..settings };
            let found = render(&CpuExecutor, &scene, &settings, 256);
            assert_ne!(found.radiance, expected.radiance);
            assert_same_expectation(&found, &expected, &format!("{integrator:?}"));
        }
        with_gpu(|gpu| {
            for (seed, integrator) in
                (20..).zip([IntegratorKind::Megakernel].into_iter().chain(OTHERS))
            {
                let settings = Settings { seed, integrator, ..settings };
                let found = render(gpu, &scene, &settings, 64);
                assert_same_expectation(&found, &expected, &format!("{integrator:?} on the GPU"));
            }
        });
    }
}
