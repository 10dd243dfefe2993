//! Rounds of rendering on one device: which kind of round comes next, and how large it is.

use super::allocator::sampling::{AllocatorKind, Sampling};
use super::allocator::{self, Allocator, uniform::Uniform};
use super::estimator::{ComingRound, Estimation, Noise};
use super::film::FilmBuffers;
use super::integrator::first_hits::first_hits;
use super::integrator::{self, IntegratorContext};
use super::round::batch::BatchSize;
use super::round::{Parts, Round, Stage, allocate_stream};
use super::scene::PreparedScene;
use super::settings::{Settings, Timings};
use crate::exec::{Array, ExecError, Executor, kernels};
use crate::film::Film;
use bytemuck::Zeroable;
use raystream_shaders::film::accumulate::CountParams;
use raystream_shaders::integrator::first_hits::FEATURE_SAMPLES;
use raystream_shaders::math::random::hash;

/// A scene, a film and a sample stream on a device.
pub struct Renderer<'e, E: Executor> {
    stage: Stage<'e, E>,
    sampling: Sampling,
    uniform: Uniform<E::Buffer>,
    /// The allocator of all rounds but the first; none where that is uniform too.
    adaptive: Option<Box<dyn Allocator<E>>>,
    /// There is one where errors are asked for: by an allocator or by [`Sampling::noise`].
    estimation: Option<Estimation<E::Buffer>>,
    /// Whether the errors are those of the film as it is: a round, better features or another mean
    /// radiance change them.
    estimated: bool,
    /// What the uniform allocator, which does not look, is given as errors.
    no_errors: Array<E::Buffer, f32>,
    /// Mean radiance of the picture as the first round saw it: what relative errors are relative to
    /// must not change under way.
    mean_radiance: Option<f32>,
    batch: BatchSize,
    ray_counts: Array<E::Buffer, u32>,
    seed: u32,
    /// See [`Self::convergence`].
    convergence: f64,
    /// Rounds so far.
    rounds: u32,
    /// Paths traced so far.
    paths: u64,
    /// Camera rays of each pixel's features.
    feature_samples: u32,
}

/// Camera rays of each pixel's features that are enough for a filter.
const FILTER_FEATURE_SAMPLES: u32 = 8;
/// Threads that count rays.
const COUNTERS: u32 = 4096;

impl<'e, E: Executor> Renderer<'e, E> {
    /// Copies the scene to the device and clears the film.
    pub fn new(
        executor: &'e E,
        scene: &PreparedScene,
        settings: &Settings,
    ) -> Result<Self, ExecError> {
        let scene_buffers = scene.buffers(executor)?;
        let film = FilmBuffers::new(executor, settings.size)?;
        let (slots, contributions) = allocate_stream(executor)?;
        let parameters = scene.parameters(settings);
        let context = IntegratorContext {
            executor,
            scene: &scene_buffers,
            parameters: &parameters,
            settings,
        };
        let integrator = integrator::create(&context, slots.len() as u32)?;
        let sampling = settings.sampling;
        let is_uniform = sampling.allocator == AllocatorKind::Uniform;
        let adaptive =
            (!is_uniform).then(|| allocator::create(sampling.allocator, executor, film.pixels()));
        let estimates = !is_uniform || sampling.noise.is_some();
        let estimation = estimates.then(|| Estimation::new(executor, settings.size));
        Ok(Self {
            batch: BatchSize::new(slots.len() as u32),
            stage: Stage {
                integrator,
                executor,
                scene: scene_buffers,
                film,
                parameters,
                slots,
                contributions,
            },
            sampling,
            uniform: Uniform::new(executor)?,
            adaptive: adaptive.transpose()?,
            estimation: estimation.transpose()?,
            estimated: false,
            no_errors: Array::zeroed(executor, "no errors", 1)?,
            mean_radiance: None,
            ray_counts: Array::zeroed(executor, "ray counts", COUNTERS as usize)?,
            seed: settings.seed,
            convergence: 0.0,
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

    /// Renders the next round, of at most `paths_left` paths (but always one sample of each pixel
    /// first): uniform ones until every pixel has [`Sampling::initial_samples`], then what the
    /// allocator makes of the errors. `after_batch` is called with the number of paths that each
    /// batch has traced.
    pub fn step(
        &mut self,
        paths_left: u64,
        after_batch: &mut dyn FnMut(u32),
    ) -> Result<Timings, ExecError> {
        let pixels = u64::from(self.pixels());
        let samples_left = (paths_left / pixels).clamp(1, u64::from(u32::MAX)) as u32;
        let samples_left = samples_left.min(self.samples_of_cache());
        if self.adaptive.is_none() {
            // Where the length of rounds shows in the film, it must not follow from time.
            let one_batch = (u64::from(self.batch.slots()) / pixels).max(1) as u32;
            let samples = if self.samples_of_cache() < u32::MAX {
                samples_left
            } else {
                one_batch.min(samples_left)
            };
            return self.round(samples, after_batch);
        }
        let samples = (self.paths / pixels) as u32;
        if samples < self.sampling.initial_samples {
            return self
                .round((self.sampling.initial_samples - samples).min(samples_left), after_batch);
        }
        self.adaptive_round(paths_left, after_batch)
    }

    /// Gives every pixel `samples` more samples, in one round of as many batches as it takes. How
    /// samples are cut into rounds changes the film with the integrator `lvc` alone, whose light
    /// paths are those of the round. `after_batch` is called with the number of paths that each has
    /// traced.
    pub fn round(
        &mut self,
        samples: u32,
        after_batch: &mut dyn FnMut(u32),
    ) -> Result<Timings, ExecError> {
        let paths = u64::from(samples) * u64::from(self.pixels());
        let round = Round {
            paths,
            number: self.rounds,
            salt: 0,
            errors: &self.no_errors,
            prelude: Parts::default(),
        };
        let (paths, timings) =
            self.stage.round(&self.uniform, round, &mut self.batch, after_batch)?;
        self.estimated = false;
        self.rounds += 1;
        self.paths += paths;
        Ok(timings)
    }

    fn adaptive_round(
        &mut self,
        paths_left: u64,
        after_batch: &mut dyn FnMut(u32),
    ) -> Result<Timings, ExecError> {
        let mut timings = self.measure_mean_radiance()?;
        let (Some(adaptive), Some(estimation)) = (&self.adaptive, &self.estimation) else {
            return Ok(timings);
        };
        let prelude = self.estimate();
        let paths =
            ((self.samples_of_round() * f64::from(self.pixels())) as u64).clamp(1, paths_left);
        let salt = hash(self.seed ^ hash(self.rounds));
        let round =
            Round { paths, number: self.rounds, salt, errors: estimation.errors(), prelude };
        let mut batch = self.batch;
        let (paths, of_round) =
            self.stage.round(adaptive.as_ref(), round, &mut batch, after_batch)?;
        timings += of_round;
        self.feature_samples = self.wanted_feature_samples(FILTER_FEATURE_SAMPLES);
        self.batch = batch;
        self.estimated = false;
        self.rounds += 1;
        self.paths += paths;
        Ok(timings)
    }

    /// Samples of each pixel that may share light paths, those of a round, at most; nothing where
    /// all samples are independent of each other.
    pub fn samples_that_share(&self) -> Option<u32> {
        Some(self.samples_of_cache()).filter(|&samples| samples < u32::MAX)
    }

    /// Samples of each pixel in a round, at most, by
    /// [`Integrator::slots_of_round`](integrator::Integrator::slots_of_round).
    fn samples_of_cache(&self) -> u32 {
        (self.stage.integrator.slots_of_round() / u64::from(self.pixels()))
            .clamp(1, u64::from(u32::MAX)) as u32
    }

    /// Samples of the coming round, on average over the pixels.
    fn samples_of_round(&self) -> f64 {
        let pixels = f64::from(self.pixels());
        let largest =
            (self.stage.slots.len() as f64 / pixels).min(f64::from(self.samples_of_cache()));
        self.sampling.samples_of_round(self.paths as f64 / pixels).min(largest)
    }

    /// Launches that bring the features up to date and estimate the errors as they are, for the
    /// coming round, unless that has been done; nothing where errors are not estimated.
    fn estimate(&self) -> Parts<'_, E::Buffer> {
        let Some(estimation) = self.estimation.as_ref().filter(|_| !self.estimated) else {
            return Parts::default();
        };
        let mut parts = self.trace_features(FILTER_FEATURE_SAMPLES);
        let round = ComingRound {
            samples: self.samples_of_round() as f32,
            mean_radiance: self.mean_radiance.unwrap_or(0.0),
        };
        let camera = &self.stage.parameters.camera;
        let launches = estimation.launches(&self.stage.film, camera, &self.sampling, round);
        parts.add(launches, |timings| &mut timings.estimation);
        parts
    }

    /// Estimates the errors now; nothing where they are not estimated.
    fn run_estimate(&mut self) -> Result<Timings, ExecError> {
        let timings = self.estimate().run(self.stage.executor)?;
        if self.estimation.is_some() {
            self.feature_samples = self.wanted_feature_samples(FILTER_FEATURE_SAMPLES);
            self.estimated = true;
        }
        Ok(timings)
    }

    /// Measures the mean radiance, once there is any.
    fn measure_mean_radiance(&mut self) -> Result<Timings, ExecError> {
        if self.mean_radiance.is_some() || self.paths == 0 {
            return Ok(Timings::default());
        }
        let timings = self.run_estimate()?;
        if let Some(estimation) = &self.estimation {
            self.mean_radiance =
                Some(estimation.noise(self.stage.executor, 0.0)?.mean_radiance as f32);
            self.estimated = false;
        }
        Ok(timings)
    }

    /// The noise of the picture so far; none where errors are not estimated, see [`Sampling`].
    pub fn noise(&mut self) -> Result<Option<Noise>, ExecError> {
        self.measure_mean_radiance()?;
        self.run_estimate()?;
        let (Some(estimation), Some(mean_radiance)) = (&self.estimation, self.mean_radiance) else {
            return Ok(None);
        };
        estimation.noise(self.stage.executor, mean_radiance).map(Some)
    }

    /// Whether the picture's relative error is at most [`Sampling::noise`], or that of every pixel
    /// is; never before the first adaptive round.
    pub fn has_converged(&mut self) -> Result<bool, ExecError> {
        let Some(threshold) = self.sampling.noise else { return Ok(false) };
        if self.paths < u64::from(self.sampling.initial_samples) * u64::from(self.pixels()) {
            return Ok(false);
        }
        let Some(noise) = self.noise()? else { return Ok(false) };
        self.convergence = (f64::from(threshold) / noise.relative_error).powi(2).min(1.0);
        Ok(noise.relative_error <= f64::from(threshold) || noise.unconverged == 0)
    }

    /// How far the picture is on its way to [`Sampling::noise`] in samples, from 0 to 1, by what
    /// [`Self::has_converged`] saw last: the squared error falls as samples rise.
    pub fn convergence(&self) -> f64 {
        self.convergence
    }

    /// Camera rays that the features of each pixel should have by now: as many as a pixel has
    /// samples on average, at most `limit`.
    fn wanted_feature_samples(&self, limit: u32) -> u32 {
        let samples = (self.paths / u64::from(self.pixels())).min(u64::from(limit)) as u32;
        samples.max(self.feature_samples)
    }

    /// Launches that bring the features up to date.
    fn trace_features(&self, limit: u32) -> Parts<'_, E::Buffer> {
        let mut parts = Parts::default();
        let samples = self.wanted_feature_samples(limit);
        if samples > self.feature_samples {
            let stage = &self.stage;
            let launches = stage.film.bands().iter().map(|band| {
                let pixels = 0..band.film.len() as u32;
                first_hits(&stage.scene, &stage.parameters, band, &pixels, samples)
            });
            parts.add(launches.collect(), |timings| &mut timings.features);
        }
        parts
    }

    /// Rays that all samples so far have traced, shadow rays included.
    pub fn rays(&self) -> Result<u64, ExecError> {
        let executor = self.stage.executor;
        let mut total = 0;
        for band in self.stage.film.bands() {
            let parameters = CountParams {
                threads: COUNTERS,
                pixels: band.film.len() as u32,
                ..CountParams::zeroed()
            };
            let launch = kernels::count_rays(&parameters, band.film.view(), self.ray_counts.view());
            executor.run(&[launch])?;
            total += self.ray_counts.read(executor)?.into_iter().map(u64::from).sum::<u64>();
        }
        Ok(total)
    }

    /// Brings the features of every pixel to as many camera rays as a picture of its samples
    /// deserves: as many as a pixel has samples on average, at most [`FEATURE_SAMPLES`]. The errors
    /// of later rounds may change by it, so this is for the end of a render.
    pub fn finish_features(&mut self) -> Result<(), ExecError> {
        self.trace_features(FEATURE_SAMPLES).run(self.stage.executor)?;
        self.feature_samples = self.wanted_feature_samples(FEATURE_SAMPLES);
        self.estimated = false;
        Ok(())
    }

    /// Copies the film to the host, with the features [so far](Self::finish_features) and, where
    /// they are asked for, with estimates of its errors.
    pub fn film(&mut self) -> Result<Film, ExecError> {
        self.run_estimate()?;
        let executor = self.stage.executor;
        let mut film = self.stage.film.read(executor)?;
        if let Some(estimation) = &self.estimation {
            film.estimates = Some(estimation.read(executor)?);
        }
        Ok(film)
    }
}
