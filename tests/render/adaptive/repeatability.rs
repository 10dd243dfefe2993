//! The same command gives the same film, bit for bit.

use super::renders::{room, sampling, small};
use raystream::exec::Executor;
use raystream::exec::cpu::CpuExecutor;
use raystream::exec::kernels::table;
use raystream::film::Film;
use raystream::render::AllocatorKind::{Atomic, Paper, Runs, Uniform};
use raystream::render::{Budget, Estimator, PreparedScene, Renderer, Settings, run};
use raystream_tests::{scenes, with_gpu};

/// Renders 36 samples per pixel; the film, and how many paths there were after each batch.
fn film<E: Executor>(executor: &E, scene: &PreparedScene, settings: &Settings) -> (Film, Vec<u64>) {
    let mut renderer = Renderer::new(executor, scene, settings).unwrap();
    let mut batches = vec![0];
    run(&mut renderer, Budget::samples(36), &|| false, &mut |progress| {
        assert!(batches.last().is_some_and(|&last| progress.paths > last), "progress");
        batches.push(progress.paths);
    })
    .unwrap();
    (renderer.film().unwrap(), batches)
}

fn rooms() -> impl Iterator<Item = (PreparedScene, Settings, String)> {
    // The slots of `atomic` go to whoever comes first: it does not show.
    [Uniform, Paper, Atomic, Runs].into_iter().map(|allocator| {
        let (scene, settings) = room(scenes::glass(1.5), 37, 23);
        let settings = Settings {
            sampling: sampling(allocator, Estimator::Bilateral),
            independent_sampler: false,
            ..settings
        };
        (scene, settings, format!("{allocator:?}"))
    })
}

#[test]
fn films_are_the_same_on_the_cpu_whatever_the_batches() {
    for (scene, settings, name) in rooms() {
        let (first, _) = film(&small(&CpuExecutor), &scene, &settings);
        let (second, _) = film(&small(&CpuExecutor), &scene, &settings);
        assert!(first == second, "{name}");
        let (slow, batches) =
            film(&small(&CpuExecutor).with_slow_batches(&table::trace_paths, 3), &scene, &settings);
        // Not compared with those before: on a busy machine they are slow anyway.
        let paths = |batch: usize| batches[batch + 1] - batches[batch];
        assert!(paths(1) < paths(0), "{name}: a slow batch makes the next one shorter");
        assert!(first == slow, "{name}: batches show");
        let (other, _) = film(&small(&CpuExecutor), &scene, &Settings { seed: 2, ..settings });
        assert!(first != other, "{name}: another seed is another film");
    }
}

#[test]
fn films_are_the_same_on_the_gpu() {
    with_gpu(|gpu| {
        for (scene, settings, name) in rooms() {
            let (first, _) = film(&small(gpu), &scene, &settings);
            let (second, _) = film(&small(gpu), &scene, &settings);
            assert!(first == second, "{name}");
        }
    });
}
