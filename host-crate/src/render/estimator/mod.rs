//! Estimators on a device: from the film to the errors that allocators go by.
//!
//! [`EstimateBuffers`] has the launches; [`Estimation`] knows when they are due.

mod buffers;

pub use buffers::{ComingRound, EstimateBuffers, Noise};

use super::round::launches::TimedLaunches;
use super::round::state::DeviceState;
use super::settings::sampling::{AllocatorKind, Sampling};
use super::timings::{Part, Timings};
use crate::exec::{Array, ExecError, Executor};
use crate::scene::FilmSize;
use raystream_shaders::estimator::Estimate;
use raystream_shaders::integrator::first_hits::FEATURE_SAMPLES;

/// Camera rays of each pixel's features that are enough for a filter.
const FILTER_FEATURE_SAMPLES: u32 = 8;

/// The errors of a render, and the features that filters look at: how far both are behind the film.
pub struct Estimation<B> {
    sampling: Sampling,
    /// There are some where errors are asked for: by an allocator or by [`Sampling::noise`].
    buffers: Option<EstimateBuffers<B>>,
    /// What the uniform allocator, which does not look, is given as errors.
    no_errors: Array<B, f32>,
    /// Whether the errors are those of the film as it is: a round, better features or another mean
    /// radiance change them.
    is_current: bool,
    /// Whether there are estimates, of the film as it is or as it was.
    has_estimated: bool,
    /// Mean radiance of the picture as the first round saw it: what relative errors are relative to
    /// must not change under way.
    mean_radiance: Option<f32>,
    /// Camera rays of each pixel's features.
    feature_samples: u32,
    /// How often the samples of the film have changed.
    changes: u64,
}

/// What filters see of a render: a picture of the same version is the same picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FilmVersion {
    changes: u64,
    feature_samples: u32,
    mean_radiance_bits: u32,
}

/// How far the film is.
#[derive(Clone, Copy, Debug)]
pub struct FilmSamples {
    /// Whole samples that a pixel has on average.
    pub average: u64,
    /// Samples that the coming round gives a pixel on average.
    pub coming: f64,
}

impl FilmSamples {
    /// Camera rays that the features of each pixel should have by now: as many as a pixel has
    /// samples on average, at most `limit`.
    fn feature_samples(self, limit: u32) -> u32 {
        self.average.min(u64::from(limit)) as u32
    }
}

impl<B: Send + Sync + 'static> Estimation<B> {
    /// Of a picture of `size`; no memory of its size is asked for where `sampling` needs no errors.
    pub fn new<E: Executor<Buffer = B>>(
        executor: &E,
        size: FilmSize,
        sampling: Sampling,
    ) -> Result<Self, ExecError> {
        let is_wanted = sampling.allocator != AllocatorKind::Uniform || sampling.noise.is_some();
        let buffers = || EstimateBuffers::new(executor, size, &sampling);
        Ok(Self {
            sampling,
            buffers: is_wanted.then(buffers).transpose()?,
            no_errors: Array::zeroed(executor, "no errors", 1)?,
            is_current: false,
            has_estimated: false,
            mean_radiance: None,
            feature_samples: 0,
            changes: 0,
        })
    }

    /// The errors by which allocators go, in rank order; of any length where nobody asks for them.
    pub fn errors(&self) -> &Array<B, f32> {
        self.buffers.as_ref().map_or(&self.no_errors, EstimateBuffers::errors)
    }

    /// Tells it that the film has changed.
    pub fn film_changed(&mut self) {
        self.is_current = false;
        self.changes += 1;
    }

    /// Of the film as it is.
    pub fn version(&self) -> FilmVersion {
        FilmVersion {
            changes: self.changes,
            feature_samples: self.feature_samples,
            mean_radiance_bits: self.mean_radiance().to_bits(),
        }
    }

    /// Launches that bring the features up to date and estimate the errors as they are, unless
    /// that has been done; nothing where errors are not estimated. Once they have been run,
    /// [`Self::updated`] must be told.
    pub fn update<'a, E: Executor<Buffer = B>>(
        &'a self,
        state: &'a DeviceState<E>,
        samples: FilmSamples,
    ) -> TimedLaunches<'a, B> {
        let mut launches = TimedLaunches::default();
        let Some(buffers) = self.buffers.as_ref().filter(|_| !self.is_current) else {
            return launches;
        };
        self.add_features(&mut launches, state, samples.feature_samples(FILTER_FEATURE_SAMPLES));
        let round = ComingRound {
            samples: samples.coming as f32,
            mean_radiance: self.mean_radiance.unwrap_or(0.0),
        };
        let camera = &state.parameters.camera;
        let estimates = buffers.launches(&state.film, camera, &self.sampling, round);
        launches.add(estimates, Part::Estimation);
        launches
    }

    /// The launches of [`Self::update`] have been run.
    pub fn updated(&mut self, samples: FilmSamples) {
        if self.buffers.is_some() {
            let traced = samples.feature_samples(FILTER_FEATURE_SAMPLES);
            self.feature_samples = self.feature_samples.max(traced);
            (self.is_current, self.has_estimated) = (true, true);
        }
    }

    /// Estimates the errors now; nothing where they are not estimated.
    pub fn run_update<E: Executor<Buffer = B>>(
        &mut self,
        state: &DeviceState<E>,
        samples: FilmSamples,
    ) -> Result<Timings, ExecError> {
        let timings = self.update(state, samples).run(&state.executor)?;
        self.updated(samples);
        Ok(timings)
    }

    /// Measures the mean radiance, once there is any.
    pub fn measure_mean_radiance<E: Executor<Buffer = B>>(
        &mut self,
        state: &DeviceState<E>,
        samples: FilmSamples,
    ) -> Result<Timings, ExecError> {
        if self.mean_radiance.is_some_and(|mean| mean > 0.0) || samples.average == 0 {
            return Ok(Timings::default());
        }
        let timings = self.run_update(state, samples)?;
        if let Some(buffers) = &self.buffers {
            let noise = buffers.noise(&state.executor, 0.0)?;
            self.mean_radiance = Some(noise.mean_radiance as f32);
            self.is_current = false;
        }
        Ok(timings)
    }

    /// The noise of the film; none where errors are not estimated. Relative to the mean radiance
    /// that has been measured or else, which nothing to come shall see, to the film's own.
    pub fn noise<E: Executor<Buffer = B>>(
        &mut self,
        state: &DeviceState<E>,
        samples: FilmSamples,
    ) -> Result<Option<Noise>, ExecError> {
        let measured = self.mean_radiance;
        self.measure_mean_radiance(state, samples)?;
        self.run_update(state, samples)?;
        let noise = match (&self.buffers, self.mean_radiance) {
            (Some(buffers), Some(mean)) => Some(buffers.noise(&state.executor, mean)?),
            _ => None,
        };
        if self.mean_radiance != measured {
            self.mean_radiance = measured;
            self.is_current = false;
        }
        Ok(noise)
    }

    /// The noise of another picture of the film, whose errors are estimated in rank order, relative
    /// to what `noise` is relative to, that of the film; none where errors are not estimated.
    pub fn noise_of<E: Executor<Buffer = B>>(
        &self,
        executor: &E,
        picture: &Array<B, Estimate>,
        noise: &Noise,
    ) -> Result<Option<Noise>, ExecError> {
        let mean_radiance = self.mean_radiance.unwrap_or(noise.mean_radiance as f32);
        let buffers = self.buffers.as_ref();
        buffers.map(|buffers| buffers.noise_of(executor, picture, mean_radiance)).transpose()
    }

    /// Mean radiance of the picture as the first round saw it; 0 where it has not been measured.
    pub fn mean_radiance(&self) -> f32 {
        self.mean_radiance.unwrap_or(0.0)
    }

    /// The same, where it has been measured.
    pub fn measured_mean_radiance(&self) -> Option<f32> {
        self.mean_radiance
    }

    /// Camera rays that each pixel's features have.
    pub fn feature_samples(&self) -> u32 {
        self.feature_samples
    }

    /// Goes on with another film, with features of as many camera rays and with a mean radiance
    /// that was measured before.
    pub fn restore(&mut self, feature_samples: u32, mean_radiance: Option<f32>) {
        self.feature_samples = feature_samples;
        self.mean_radiance = mean_radiance;
        self.film_changed();
    }

    /// Brings the features of every pixel to as many camera rays as a picture of its samples
    /// deserves: as many as a pixel has samples on average, at most [`FEATURE_SAMPLES`].
    pub fn finish_features<E: Executor<Buffer = B>>(
        &mut self,
        state: &DeviceState<E>,
        samples: FilmSamples,
    ) -> Result<(), ExecError> {
        let wanted = samples.feature_samples(FEATURE_SAMPLES);
        let mut launches = TimedLaunches::default();
        self.add_features(&mut launches, state, wanted);
        launches.run(&state.executor)?;
        self.feature_samples = self.feature_samples.max(wanted);
        self.is_current = false;
        Ok(())
    }

    /// Copies the estimates to the host, in rows; none where errors are not estimated.
    pub fn read<E: Executor<Buffer = B>>(
        &self,
        executor: &E,
    ) -> Result<Option<Vec<Estimate>>, ExecError> {
        self.buffers.as_ref().map(|buffers| buffers.read(executor)).transpose()
    }

    /// The same as they were when they were last estimated; none where they have not been.
    pub fn read_last<E: Executor<Buffer = B>>(
        &self,
        executor: &E,
    ) -> Result<Option<Vec<Estimate>>, ExecError> {
        if self.has_estimated { self.read(executor) } else { Ok(None) }
    }

    fn add_features<'a, E: Executor<Buffer = B>>(
        &self,
        launches: &mut TimedLaunches<'a, B>,
        state: &'a DeviceState<E>,
        samples: u32,
    ) {
        if samples > self.feature_samples {
            launches.add(state.first_hits(samples), Part::Features);
        }
    }
}
