//! Rounds of rendering on one device: which kind of round comes next, and how large it is.

use super::allocator::{self, Allocator, uniform::Uniform};
use super::batch::BatchSize;
use super::film::FilmBuffers;
use super::integrator::first_hits;
use super::round::{Stage, allocate_stream};
use super::settings::{Settings, Timings};
use super::{AllocatorKind, PreparedScene, Sampling, SceneBuffers};
use crate::exec::{Array, ExecError, Executor, Launch, kernels};
use crate::film::Film;
use bytemuck::Zeroable;
use raystream_shaders::features::FEATURE_SAMPLES;
use raystream_shaders::film::CountParams;
use raystream_shaders::sampler::hash;
use std::time::Duration;

/// A scene, a film and a sample stream on a device.
pub struct Renderer<'e, E: Executor> {
    stage: Stage<'e, E>,
    sampling: Sampling,
    uniform: Uniform<E::Buffer>,
    /// The allocator of all rounds but the first; none where that is uniform too.
    adaptive: Option<Box<dyn Allocator<E>>>,
    batch: BatchSize,
    ray_counts: Array<E::Buffer, u32>,
    seed: u32,
    /// Rounds so far.
    rounds: u32,
    /// Paths traced so far.
    paths: u64,
    /// Camera rays of each pixel's features.
    feature_samples: u32,
}

/// Threads that count rays.
const COUNTERS: u32 = 4096;

impl<'e, E: Executor> Renderer<'e, E> {
    /// Copies the scene to the device and clears the film.
    pub fn new(executor: &'e E, scene: &PreparedScene, settings: &Settings) -> Result<Self, ExecError> {
        let scene_buffers = SceneBuffers::new(executor, scene)?;
        let film = FilmBuffers::new(executor, settings.size)?;
        let (slots, contributions) = allocate_stream(executor)?;
        let sampling = settings.sampling;
        let is_uniform = sampling.allocator == AllocatorKind::Uniform;
        let adaptive = (!is_uniform).then(|| allocator::create(sampling.allocator, executor, film.pixels()));
        let errors =
            Array::zeroed(executor, "the errors of pixels", if is_uniform { 1 } else { film.pixels() as usize })?;
        Ok(Self {
            batch: BatchSize::new(slots.len() as u32),
            stage: Stage {
                executor,
                scene: scene_buffers,
                film,
                parameters: scene.parameters(settings),
                slots,
                contributions,
                errors,
            },
            sampling,
            uniform: Uniform::new(executor)?,
            adaptive: adaptive.transpose()?,
            ray_counts: Array::zeroed(executor, "ray counts", COUNTERS as usize)?,
            seed: settings.seed,
            rounds: 0,
            paths: 0,
            feature_samples: 0,
        })
    }

    /// Pixels of the film.
    pub fn pixels(&self) -> u32 {
        self.stage.film.pixels()
    }

    /// Paths traced so far.
    pub fn paths(&self) -> u64 {
        self.paths
    }

    /// Renders the next round, of at most `paths_left` paths (but always one sample of each pixel first): uniform ones until every pixel has
    /// [`Sampling::initial_samples`], then what the allocator makes of the errors. `after_batch` is called with the number of paths that
    /// each batch has traced.
    pub fn step(&mut self, paths_left: u64, after_batch: &mut dyn FnMut(u32)) -> Result<Timings, ExecError> {
        let pixels = u64::from(self.pixels());
        let samples_left = (paths_left / pixels).clamp(1, u64::from(u32::MAX)) as u32;
        if self.adaptive.is_none() {
            let one_batch = (u64::from(self.batch.slots()) / pixels).max(1) as u32;
            return self.round(one_batch.min(samples_left), after_batch);
        }
        let samples = (self.paths / pixels) as u32;
        if samples < self.sampling.initial_samples {
            return self.round((self.sampling.initial_samples - samples).min(samples_left), after_batch);
        }
        self.adaptive_round(paths_left, after_batch)
    }

    /// Gives every pixel `samples` more samples, in as many batches as it takes. `after_batch` is called with the number of paths that
    /// each has traced.
    pub fn round(&mut self, samples: u32, after_batch: &mut dyn FnMut(u32)) -> Result<Timings, ExecError> {
        let paths = u64::from(samples) * u64::from(self.pixels());
        let (paths, timings) = self.stage.round(&self.uniform, Vec::new(), paths, 0, &mut self.batch, after_batch)?;
        self.finish_round(paths, timings)
    }

    fn adaptive_round(&mut self, paths_left: u64, after_batch: &mut dyn FnMut(u32)) -> Result<Timings, ExecError> {
        let Some(adaptive) = &self.adaptive else { return Ok(Timings::default()) };
        let pixels = self.pixels();
        let average = self.paths as f64 / f64::from(pixels);
        let samples = self.sampling.samples_of_round(average);
        let paths = ((samples * f64::from(pixels)) as u64).clamp(1, paths_left);
        let estimate = Vec::new();
        let salt = hash(self.seed ^ hash(self.rounds));
        let (paths, timings) =
            self.stage.round(adaptive.as_ref(), estimate, paths, salt, &mut self.batch, after_batch)?;
        self.finish_round(paths, timings)
    }

    fn finish_round(&mut self, paths: u64, timings: Timings) -> Result<Timings, ExecError> {
        self.rounds += 1;
        self.paths += paths;
        Ok(Timings { features: self.trace_features()?, ..timings })
    }

    /// Brings the features of every pixel to as many camera rays as a pixel has samples on average, at most [`FEATURE_SAMPLES`].
    fn trace_features(&mut self) -> Result<Duration, ExecError> {
        let mut time = Duration::ZERO;
        let samples = (self.paths / u64::from(self.pixels())).min(u64::from(FEATURE_SAMPLES)) as u32;
        if samples == self.feature_samples {
            return Ok(time);
        }
        let stage = &self.stage;
        for band in stage.film.bands() {
            let mut next = 0;
            while let Some(window) = band.window(next, self.batch.slots()) {
                let launch = first_hits(&stage.scene, &stage.parameters, band, &window, samples);
                time += stage.executor.run(&[launch])?.iter().sum::<Duration>();
                next = window.end;
            }
        }
        self.feature_samples = samples;
        Ok(time)
    }

    /// Rays that all samples so far have traced, shadow rays included.
    pub fn rays(&self) -> Result<u64, ExecError> {
        let executor = self.stage.executor;
        let mut total = 0;
        for band in self.stage.film.bands() {
            let parameters = CountParams { threads: COUNTERS, pixels: band.film.len() as u32, ..CountParams::zeroed() };
            let launch = Launch::new(&kernels::count_rays, &parameters, vec![band.film.view(), self.ray_counts.view()]);
            executor.run(&[launch])?;
            total += self.ray_counts.read(executor)?.into_iter().map(u64::from).sum::<u64>();
        }
        Ok(total)
    }

    /// Copies the film to the host.
    pub fn film(&self) -> Result<Film, ExecError> {
        self.stage.film.read(self.stage.executor)
    }
}
