//! Adaptive renders of small scenes.

use super::common::slow::SlowBatches;
use super::common::{prepare, scenes, settings};
use raystream::exec::cpu::CpuExecutor;
use raystream::exec::{ExecError, Executor, Launch, Limits, kernels};
use raystream::film::Film;
use raystream::render::{
    AllocatorKind, Budget, Estimator, Outcome, PreparedScene, Renderer, Sampling, Settings, run,
};
use raystream::scene::FilmSize;
use raystream::scene::Material;
use std::time::Duration;

/// Longest streams, in slots: ample for tiny pictures. By default a renderer clears memory for
/// millions, which takes longer than to render them.
const SLOTS: u64 = 1 << 15;

/// A device with short streams, whose first batches can be slow: the next ones are then short.
pub struct Small<'e, E> {
    inner: &'e E,
    slow_batches: SlowBatches,
}

impl<'e, E: Executor> Small<'e, E> {
    pub fn new(inner: &'e E, slow_batches: u32) -> Self {
        Self { inner, slow_batches: SlowBatches::new(&kernels::table::trace_paths, slow_batches) }
    }
}

impl<E: Executor> Executor for Small<'_, E> {
    type Buffer = E::Buffer;

    fn name(&self) -> &str {
        self.inner.name()
    }

    fn limits(&self) -> Limits {
        let limits = self.inner.limits();
        Limits { buffer_bytes: limits.buffer_bytes.min(SLOTS * 32), ..limits }
    }
    fn allocate(&self, label: &'static str, bytes: u64) -> Result<Self::Buffer, ExecError> {
        self.inner.allocate(label, bytes)
    }
    fn write(&self, buffer: &Self::Buffer, first_byte: u64, bytes: &[u8]) -> Result<(), ExecError> {
        self.inner.write(buffer, first_byte, bytes)
    }
    fn read(
        &self,
        buffer: &Self::Buffer,
        first_byte: u64,
        bytes: u64,
    ) -> Result<Vec<u8>, ExecError> {
        self.inner.read(buffer, first_byte, bytes)
    }
    fn run_parts(&self, parts: &[&[Launch<'_, Self::Buffer>]]) -> Result<Vec<Duration>, ExecError> {
        self.slow_batches.hold_up(parts);
        self.inner.run_parts(parts)
    }
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
    assert!(!outcome.interrupted);
    assert_eq!(outcome.paths, renderer.paths());
    renderer.finish_features().expect("the device works");
    let film = renderer.film().expect("the device works");
    let total: u64 = film.samples().into_iter().map(u64::from).sum();
    assert_eq!(total, outcome.paths, "samples in the film");
    (film, outcome)
}

/// As [`render_on`], on the CPU.
pub fn render(scene: &PreparedScene, settings: &Settings, samples: Option<u32>) -> (Film, Outcome) {
    render_on(&Small::new(&CpuExecutor, 0), scene, settings, samples)
}

/// Mean and its standard error.
pub fn mean_and_error(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (mean, (variance / n).sqrt())
}
