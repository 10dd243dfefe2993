//! Renders in rounds.

use glam::Vec3;
use raystream::exec::cpu::CpuExecutor;
use raystream::exec::kernels::table;
use raystream::render::{Budget, Progress, Renderer, Sampling, Settings, Stop, run};
use raystream::scene::FilmSize;
use raystream_tests::executors::Hindered;
use raystream_tests::{prepare, render, scenes, settings};
use std::time::Duration;

/// The way a render is cut into rounds and batches is nobody's business: the film is the same, bit
/// for bit.
#[test]
fn rounds_do_not_change_the_film() {
    let mut scene = scenes::room(scenes::glass(1.5), 1.0);
    scene.film = FilmSize { width: 19, height: 13 };
    let prepared = prepare(&scene);
    let settings = Settings { independent_sampler: false, ..settings(&scene) };
    let at_once = render(&prepared, &settings, 21);
    let mut renderer = Renderer::new(&CpuExecutor, &prepared, &settings).unwrap();
    for samples in [1, 7, 3, 10] {
        renderer.uniform_round(samples).finish().unwrap();
    }
    renderer.finish_features().unwrap();
    assert_eq!(renderer.film().unwrap(), at_once);
    let rays: u64 = at_once.radiance.iter().map(|p| u64::from(p.rays)).sum();
    assert_eq!(renderer.rays().unwrap(), rays);
}

/// Who looks now and then sees the samples that there are, and the render is the same without them.
#[test]
fn a_glance_sees_the_samples_and_changes_nothing() {
    let mut scene = scenes::room(scenes::glass(1.5), 1.0);
    scene.film = FilmSize { width: 19, height: 13 };
    let prepared = prepare(&scene);
    let settings = Settings { sampling: Sampling::ADAPTIVE, ..settings(&scene) };
    let rendered = |glances: bool| {
        let mut renderer = Renderer::new(&CpuExecutor, &prepared, &settings).unwrap();
        for round in 0..4 {
            renderer.step(u64::MAX).unwrap();
            if glances {
                let glance = renderer.glance().unwrap();
                assert!(glance.corrections.is_none() && glance.denoised.is_none());
                // Errors are first asked for by the second round.
                assert_eq!(glance.estimates.is_some(), round > 0);
                assert_eq!(glance.plain().len(), 19 * 13);
                let samples: u64 = glance.samples().into_iter().map(u64::from).sum();
                assert_eq!(samples, renderer.paths());
            }
        }
        let glance = renderer.glance().unwrap();
        let film = renderer.film().unwrap();
        assert_eq!(glance.radiance, film.radiance);
        film
    };
    assert_eq!(rendered(true), rendered(false));
}

/// A time that ends within the first round, on a device whose every batch takes 0.25 s at least.
#[test]
fn time_is_kept_to_within_a_batch() {
    let mut scene = scenes::room(scenes::glass(1.5), 1.0);
    scene.film = FilmSize { width: 640, height: 480 };
    let prepared = prepare(&scene);
    let device = Hindered::by_buffers(&CpuExecutor, 32 << 18)
        .with_slow_batches(&table::regenerate_paths, u32::MAX);
    for sampling in [Sampling::UNIFORM, Sampling::ADAPTIVE] {
        let settings = Settings { sampling, ..Settings::for_scene(&scene) };
        let mut renderer = Renderer::new(&device, &prepared, &settings).unwrap();
        let time = Duration::from_millis(700);
        let (mut longest, mut before) = (Duration::ZERO, Duration::ZERO);
        let mut observe = |progress: &Progress| {
            longest = longest.max(progress.elapsed - before);
            before = progress.elapsed;
        };
        let outcome = run(&mut renderer, Budget::time(time), &|| false, &mut observe).unwrap();
        assert_eq!(outcome.stop, Stop::Time);
        // What follows the last batch takes less than one. A busy machine makes all of them longer.
        assert!(outcome.elapsed < time + 2 * longest, "{:?}, {longest:?}", outcome.elapsed);
        let film = renderer.film().unwrap();
        let samples: u64 = film.samples().into_iter().map(u64::from).sum();
        assert_eq!(samples, outcome.paths, "what is counted is in the film");
        let unseen = film.radiance.iter().filter(|pixel| pixel.samples() == 0).count();
        assert!(unseen > 0 && samples > 0, "it has seen a part");
        for (pixel, color) in film.radiance.iter().zip(film.color()) {
            assert!(color.is_finite() && (pixel.samples() > 0 || color == Vec3::ZERO));
        }
    }
}

#[test]
fn an_interruption_keeps_what_has_been_traced() {
    let scene = scenes::room(scenes::glass(1.5), 1.0);
    let prepared = prepare(&scene);
    let mut renderer = Renderer::new(&CpuExecutor, &prepared, &settings(&scene)).unwrap();
    let outcome = run(&mut renderer, Budget::default(), &|| true, &mut |_| ()).unwrap();
    assert!(outcome.stop == Stop::Interrupted && outcome.interrupted() && outcome.paths > 0);
    let samples: u64 = renderer.film().unwrap().samples().into_iter().map(u64::from).sum();
    assert_eq!(samples, outcome.paths);
}
