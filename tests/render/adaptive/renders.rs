//! Adaptive renders of small scenes.

use raystream::exec::Executor;
use raystream::exec::cpu::CpuExecutor;
use raystream::film::Film;
use raystream::render::{
    AllocatorKind, Budget, Estimator, Outcome, PreparedScene, Renderer, Sampling, Settings, run,
};
use raystream::scene::{FilmSize, Material};
use raystream_tests::executors::Hindered;
use raystream_tests::{prepare, scenes, settings};

/// Bytes of the largest buffer: streams of 2^15 slots are ample for tiny pictures. By default a
/// renderer clears memory for millions, which takes longer than to render them.
const BUFFER_BYTES: u64 = 32 << 15;

/// The device, with short streams.
pub fn small<E: Executor>(executor: &E) -> Hindered<'_, E> {
    Hindered::by_buffers(executor, BUFFER_BYTES)
}

/// The room with this ball, `width` x `height` pixels.
pub fn room(ball: Material, width: u32, height: u32) -> (PreparedScene, Settings) {
    let mut scene = scenes::room(ball, 1.0);
    scene.film = FilmSize { width, height };
    (prepare(&scene), settings(&scene))
}

/// This allocator and estimator, all else as by default.
pub fn sampling(allocator: AllocatorKind, estimator: Estimator) -> Sampling {
    Sampling { allocator, estimator, ..Sampling::UNIFORM }
}

/// Renders `samples` per pixel on average, or until the noise is reached where `samples` is none.
pub fn render_on<E: Executor>(
    executor: &E,
    scene: &PreparedScene,
    settings: &Settings,
    samples: Option<u32>,
) -> (Film, Outcome) {
    let mut renderer = Renderer::new(executor, scene, settings).expect("the scene fits");
    let outcome = run(&mut renderer, Budget { samples, time: None }, &|| false, &mut |_| ())
        .expect("the device works");
    assert!(!outcome.interrupted());
    assert_eq!(outcome.paths, renderer.paths());
    renderer.finish_features().expect("the device works");
    let film = renderer.film().expect("the device works");
    let total: u64 = film.samples().into_iter().map(u64::from).sum();
    assert_eq!(total, outcome.paths, "samples in the film");
    (film, outcome)
}

/// As [`render_on`], on the CPU.
pub fn render(scene: &PreparedScene, settings: &Settings, samples: Option<u32>) -> (Film, Outcome) {
    render_on(&small(&CpuExecutor), scene, settings, samples)
}
