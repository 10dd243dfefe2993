//! Rounds of rendering on one device.

use super::allocator::Uniform;
use super::batch::BatchSize;
use super::camera::camera;
use super::film::{FilmBuffers, WINDOW_ALIGNMENT};
use super::integrator::{first_hits, megakernel};
use super::{PreparedScene, Sampling, SceneBuffers};
use crate::exec::{Array, ExecError, Executor, Launch, kernels};
use crate::film::Film;
use crate::scene::FilmSize;
use bytemuck::Zeroable;
use glam::Vec3;
use raystream_shaders::features::FEATURE_SAMPLES;
use raystream_shaders::film::{Contribution, CountParams};
use raystream_shaders::path::{self, PathParams};
use raystream_shaders::sampler;
use raystream_shaders::stream::Slot;
use std::ops::AddAssign;
use std::time::{Duration, Instant};

/// What a render computes; the same on every device.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Picture size in pixels.
    pub size: FilmSize,
    /// Renders with different seeds are independent.
    pub seed: u32,
    /// Independent random numbers instead of Owen-scrambled Sobol points.
    pub independent_sampler: bool,
    /// Longest path in segments, at least 1.
    pub max_depth: u32,
    /// Segment after which roulette may end a path; above `max_depth` for none.
    pub roulette_depth: u32,
    /// How light is looked for.
    pub techniques: Techniques,
    /// Radiance from where there is no surface, linear Rec.709.
    pub background: Vec3,
    /// How far rays start from surfaces, in roundings of the surface's largest coordinate (2^-24 of it each): enough that no
    /// surface shades itself, and no more, since what is smaller than this distance casts no shadow.
    pub ray_offset: f32,
    /// Which pixels get how many samples.
    pub sampling: Sampling,
}

/// How light is looked for. All are unbiased where every technique can find all light; they differ in noise.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Techniques {
    /// Next-event estimation and BSDF sampling, weighed by the power heuristic.
    #[default]
    Both,
    /// Next-event estimation alone, at surfaces where it is possible.
    LightSampling,
    /// BSDF sampling alone.
    BsdfSampling,
}

/// Where a render's time went, by the device's clock.
#[derive(Clone, Copy, Debug, Default)]
pub struct Timings {
    /// Tracing camera rays for the first-hit features.
    pub features: Duration,
    /// Filtering and estimating errors.
    pub estimation: Duration,
    /// Making sample streams of errors.
    pub generation: Duration,
    /// Tracing paths.
    pub tracing: Duration,
    /// Adding contributions to the film.
    pub accumulation: Duration,
}

impl AddAssign for Timings {
    fn add_assign(&mut self, other: Self) {
        self.features += other.features;
        self.estimation += other.estimation;
        self.generation += other.generation;
        self.tracing += other.tracing;
        self.accumulation += other.accumulation;
    }
}

/// A scene, a film and a sample stream on a device.
pub struct Renderer<'e, E: Executor> {
    executor: &'e E,
    scene: SceneBuffers<E::Buffer>,
    film: FilmBuffers<E::Buffer>,
    parameters: PathParams,
    slots: Array<E::Buffer, Slot>,
    contributions: Array<E::Buffer, Contribution>,
    batch: BatchSize,
    ray_counts: Array<E::Buffer, u32>,
    /// Paths traced so far.
    paths: u64,
    /// Camera rays of each pixel's features.
    feature_samples: u32,
}

/// Slots of the largest batch: 2^22 contributions are 134 MB, and four million paths fill any GPU.
const MAX_BATCH: u32 = 1 << 22;
/// Threads that count rays.
const COUNTERS: u32 = 4096;

impl<'e, E: Executor> Renderer<'e, E> {
    /// Copies the scene to the device and clears the film.
    pub fn new(executor: &'e E, scene: &PreparedScene, settings: &Settings) -> Result<Self, ExecError> {
        let scene_buffers = SceneBuffers::new(executor, scene)?;
        let film = FilmBuffers::new(executor, settings.size)?;
        let (slots, contributions) = allocate_batch(executor)?;
        Ok(Self {
            executor,
            scene: scene_buffers,
            film,
            parameters: scene.parameters(settings),
            batch: BatchSize::new(slots.len() as u32),
            slots,
            contributions,
            ray_counts: Array::zeroed(executor, "ray counts", COUNTERS as usize)?,
            paths: 0,
            feature_samples: 0,
        })
    }

    /// Pixels of the film.
    pub fn pixels(&self) -> u32 {
        self.parameters.camera.width * self.parameters.camera.height
    }

    /// Samples per pixel that a round can have and still be one batch; at least 1.
    pub fn samples_of_one_batch(&self) -> u32 {
        (self.batch.slots() / self.pixels()).max(1)
    }

    /// Gives every pixel `samples` more samples, in as many batches as it takes. `after_batch` is called with the number of paths
    /// that each has traced.
    pub fn round(&mut self, samples: u32, after_batch: &mut dyn FnMut(u32)) -> Result<Timings, ExecError> {
        let mut timings = Timings::default();
        let mut left = samples;
        while left > 0 {
            // A run longer than the batch would not fit even in the smallest window.
            let allocator = Uniform { samples: left.min((self.slots.len() as u32 / WINDOW_ALIGNMENT).max(1)) };
            timings += self.pass(allocator, after_batch)?;
            left -= allocator.samples;
        }
        self.paths += u64::from(samples) * u64::from(self.pixels());
        timings.features += self.trace_features()?;
        Ok(timings)
    }

    /// Renders the next round, of at most `paths_left` paths (at least as many as pixels before the first): first a uniform one of
    /// [`Sampling::initial_samples`], then what the allocator makes of the errors. `after_batch` is called with the number of paths that each
    /// batch has traced.
    pub fn step(&mut self, paths_left: u64, after_batch: &mut dyn FnMut(u32)) -> Result<Timings, ExecError> {
        let samples_left = (paths_left / u64::from(self.pixels())).clamp(1, u64::from(u32::MAX)) as u32;
        self.round(self.samples_of_one_batch().min(samples_left), after_batch)
    }

    /// Paths traced so far.
    pub fn paths(&self) -> u64 {
        self.paths
    }

    /// Brings the features of every pixel to as many camera rays as a pixel has samples on average, at most [`FEATURE_SAMPLES`].
    fn trace_features(&mut self) -> Result<Duration, ExecError> {
        let mut time = Duration::ZERO;
        let samples = (self.paths / u64::from(self.pixels())).min(u64::from(FEATURE_SAMPLES)) as u32;
        if samples == self.feature_samples {
            return Ok(time);
        }
        for band in self.film.bands() {
            let mut next = 0;
            while let Some(window) = band.window(next, self.batch.slots()) {
                let launch = first_hits(&self.scene, &self.parameters, band, &window, samples);
                time += self.executor.run(&[launch])?.iter().sum::<Duration>();
                next = window.end;
            }
        }
        self.feature_samples = samples;
        Ok(time)
    }

    fn pass(&mut self, allocator: Uniform, after_batch: &mut dyn FnMut(u32)) -> Result<Timings, ExecError> {
        let mut timings = Timings::default();
        for band in self.film.bands() {
            let mut next = 0;
            while let Some(window) = band.window(next, self.batch.slots() / allocator.samples) {
                let threads = allocator.slots(&window);
                let start = Instant::now();
                let times = self.executor.run(&[
                    allocator.fill(band, &window, &self.slots),
                    megakernel(
                        &self.scene,
                        &PathParams { threads, ..self.parameters },
                        &self.slots,
                        &self.contributions,
                    ),
                    allocator.accumulate(band, &window, &self.contributions),
                ])?;
                self.batch.record(threads, start.elapsed());
                timings +=
                    Timings { generation: times[0], tracing: times[1], accumulation: times[2], ..Timings::default() };
                after_batch(threads);
                next = window.end;
            }
        }
        Ok(timings)
    }

    /// Rays that all samples so far have traced, shadow rays included.
    pub fn rays(&self) -> Result<u64, ExecError> {
        let mut total = 0;
        for band in self.film.bands() {
            let parameters = CountParams { threads: COUNTERS, pixels: band.film.len() as u32, ..CountParams::zeroed() };
            let launch = Launch::new(&kernels::count_rays, &parameters, vec![band.film.view(), self.ray_counts.view()]);
            self.executor.run(&[launch])?;
            total += self.ray_counts.read(self.executor)?.into_iter().map(u64::from).sum::<u64>();
        }
        Ok(total)
    }

    /// Copies the film to the host.
    pub fn film(&self) -> Result<Film, ExecError> {
        self.film.read(self.executor)
    }
}

/// The sample stream and its contributions, as large as useful and as the device has room for.
#[allow(clippy::type_complexity)] // a pair, taken apart at once
fn allocate_batch<E: Executor>(
    executor: &E,
) -> Result<(Array<E::Buffer, Slot>, Array<E::Buffer, Contribution>), ExecError> {
    let fitting = executor.limits().buffer_bytes / size_of::<Contribution>() as u64;
    let mut capacity = u64::from(MAX_BATCH).min(fitting) as usize;
    loop {
        let pair = Array::zeroed(executor, "the sample stream", capacity)
            .and_then(|slots| Ok((slots, Array::zeroed(executor, "contributions", capacity)?)));
        match pair {
            Err(ExecError::OutOfMemory { .. }) if capacity > 4 * WINDOW_ALIGNMENT as usize => capacity /= 2,
            done => return done,
        }
    }
}

impl PreparedScene {
    /// What the tracing kernels need to know beside the scene; `threads` is 0.
    pub fn parameters(&self, settings: &Settings) -> PathParams {
        PathParams {
            threads: 0,
            seed: settings.seed,
            sampler: if settings.independent_sampler { sampler::INDEPENDENT } else { sampler::SOBOL },
            max_depth: settings.max_depth,
            roulette_depth: settings.roulette_depth,
            lights: self.lights.len() as u32,
            total_importance: self.total_importance,
            techniques: match settings.techniques {
                Techniques::Both => path::BOTH_TECHNIQUES,
                Techniques::LightSampling => path::LIGHT_SAMPLING_ALONE,
                Techniques::BsdfSampling => path::BSDF_SAMPLING_ALONE,
            },
            camera: camera(&self.camera, settings.size),
            background: settings.background,
            offset_roundings: settings.ray_offset,
        }
    }
}
