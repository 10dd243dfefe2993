//! A render: what it owns, and what it can be asked.

use super::allocator::{Allocation, RoundBuffers, Windows};
use super::denoised::DenoisedPicture;
use super::estimator::{Estimation, FilmSamples, Noise};
use super::film::control::ControlFilm;
use super::integrator::{self, Integrator, IntegratorContext};
use super::reconstruction::FilterView;
use super::round::Round;
use super::round::batch::BatchSize;
use super::round::launches::TimedLaunches;
use super::round::plan::{self, Done, Limits, RoundPlan, plan};
use super::round::state::DeviceState;
use super::scene::PreparedScene;
use super::settings::Settings;
use super::settings::sampling::{Sampling, Split};
use super::team::{Team, Worker};
use super::timings::{Part, Timings};
use crate::exec::device::Device;
use crate::exec::{Array, ExecError, Executor, kernels};
use crate::film::Film;
use bytemuck::Zeroable;
use raystream_shaders::film::accumulate::CountParams;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// A scene, a film and a sample stream on a device.
///
/// It owns the device: a clone of a [`Device`], which is cheap, or a reference to any other
/// executor.
pub struct Renderer<E: Executor = Device> {
    pub(super) state: DeviceState<E>,
    pub(super) estimation: Estimation<E::Buffer>,
    pub(super) batch: BatchSize,
    pub(super) done: Done,
    pub(super) seed: u32,
    pub(super) sampling: Sampling,
    pub(super) allocation: Allocation<E>,
    /// None where no half of the samples is one.
    control: Option<ControlFilm<E::Buffer>>,
    /// None where the picture is not to be filtered.
    denoised: Option<DenoisedPicture<E::Buffer>>,
    ray_counts: Array<E::Buffer, u32>,
    /// What is left of a round of independent samples that was dropped before its end.
    pub(super) rest: Windows,
    /// See [`Self::skip_samples`].
    pub(super) skipped: u32,
    /// See [`Self::convergence`].
    convergence: f64,
    /// Who else traces. What they have in films of their own is [gathered](Self::gather) before
    /// anybody looks at the film.
    team: Mutex<Team>,
}

/// Threads that count rays.
const COUNTERS: u32 = 4096;

impl<E: Executor> Renderer<E> {
    /// Copies the scene to the device and clears the film.
    pub fn new(executor: E, scene: &PreparedScene, settings: &Settings) -> Result<Self, ExecError> {
        Self::with_integrator(executor, scene, settings, integrator::create)
    }

    /// The same with an integrator of one's own instead of [`Settings::integrator`]: `create` is
    /// given what an integrator may look at and how many slots its streams have at most.
    pub fn with_integrator<C>(
        executor: E,
        scene: &PreparedScene,
        settings: &Settings,
        create: C,
    ) -> Result<Self, ExecError>
    where
        C: FnOnce(&IntegratorContext<'_, E>, u32) -> Result<Box<dyn Integrator<E>>, ExecError>,
    {
        let state = DeviceState::new(executor, scene, settings, create)?;
        let executor = &state.executor;
        let sampling = settings.whole_sampling();
        let has_control = sampling.split() == Split::Control;
        let control = has_control.then(|| ControlFilm::new(executor, settings.size));
        Ok(Self {
            estimation: Estimation::new(executor, settings.size, sampling)?,
            batch: BatchSize::new(state.slots.len() as u32),
            done: Done::default(),
            seed: settings.seed,
            sampling,
            allocation: Allocation::new(sampling.allocator, executor, state.film.pixels())?,
            control: control.transpose()?,
            denoised: DenoisedPicture::new(executor, settings)?,
            ray_counts: Array::zeroed(executor, "ray counts", COUNTERS as usize)?,
            rest: Windows::default(),
            skipped: 0,
            convergence: 0.0,
            team: Mutex::default(),
            state,
        })
    }

    /// Has a worker trace for the render from the next round on, with the same scene and settings.
    pub fn add_worker(&mut self, worker: Box<dyn Worker>) {
        self.team().add(worker);
    }

    pub(super) fn team(&self) -> MutexGuard<'_, Team> {
        self.team.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits for the workers and adds what is in their films to the render's own.
    pub(super) fn gather(&self) -> Result<(), ExecError> {
        let DeviceState { executor, film, .. } = &self.state;
        let mut team = self.team();
        team.hand_over(film.pixels(), |ranks, sums| film.add_ranks(executor, ranks.start, sums))?;
        for window in team.take_lost() {
            self.state.sample(&self.allocation, &self.round_buffers(0), &window)?;
        }
        Ok(())
    }

    /// What the launches of a round with the random number `salt` work on.
    pub(super) fn round_buffers(&self, salt: u32) -> RoundBuffers<'_, E::Buffer> {
        RoundBuffers {
            film: &self.state.film,
            paths: self.done.paths,
            split: self.sampling.split(),
            errors: self.estimation.errors(),
            slots: &self.state.slots,
            contributions: &self.state.contributions,
            salt,
        }
    }

    /// Pixels of the film.
    pub fn pixels(&self) -> u32 {
        self.state.film.pixels()
    }

    /// Paths traced so far.
    pub fn paths(&self) -> u64 {
        self.done.paths
    }

    /// Renders the next round, of at most `paths_left` paths (but always one sample of each pixel
    /// first), as [`plan()`] decides.
    pub fn step(&mut self, paths_left: u64) -> Result<Timings, ExecError> {
        self.next_round(paths_left)?.finish()
    }

    /// Begins the round that [`Self::step`] would render, for who wants to look at it between its
    /// batches. Where one of independent samples was dropped before its end, goes on with that.
    pub fn next_round(&mut self, paths_left: u64) -> Result<Round<'_, E>, ExecError> {
        let rest = std::mem::take(&mut self.rest);
        if (1..=paths_left).contains(&rest.slots(self.pixels())) {
            return Ok(Round::of_rest(self, rest));
        }
        let plan = plan(&self.sampling, &self.limits(), self.done, paths_left);
        let timings = if plan.adaptive > 0 {
            self.gather()?;
            let samples = self.film_samples();
            self.estimation.measure_mean_radiance(&self.state, samples)?
        } else {
            Timings::default()
        };
        Ok(Round::new(self, plan, timings))
    }

    /// Begins a round that gives every pixel `samples` more samples, in as many batches as it
    /// takes. How samples are cut into rounds changes the film with the integrator `lvc` alone,
    /// whose light paths are those of the round.
    pub fn uniform_round(&mut self, samples: u32) -> Round<'_, E> {
        let plan = RoundPlan { number: self.done.rounds, uniform: samples, adaptive: 0 };
        Round::new(self, plan, Timings::default())
    }

    /// Samples of each pixel that may share light paths, those of a round, at most; nothing where
    /// all samples are independent of each other.
    pub fn samples_that_share(&self) -> Option<u32> {
        let samples = self.state.integrator.slots_of_round() / u64::from(self.pixels());
        let samples = samples.clamp(1, u64::from(u32::MAX)) as u32;
        Some(samples).filter(|&samples| samples < u32::MAX)
    }

    pub(super) fn limits(&self) -> Limits {
        Limits {
            pixels: self.pixels(),
            slots: self.state.slots.len() as u32,
            samples_that_share: self.samples_that_share(),
            batch: self.batch.slots().saturating_add(self.team().batch_slots()),
        }
    }

    pub(super) fn film_samples(&self) -> FilmSamples {
        FilmSamples {
            average: self.done.paths / u64::from(self.pixels()),
            coming: plan::samples_of_round(&self.sampling, &self.limits(), self.done),
        }
    }

    /// The noise of the picture so far, of the filtered one with [`Settings::denoise`]; none where
    /// errors are not estimated, see [`Sampling`].
    pub fn noise(&mut self) -> Result<Option<Noise>, ExecError> {
        self.gather()?;
        let samples = self.film_samples();
        let noise = self.estimation.noise(&self.state, samples)?;
        let (Some(noise), Some(denoised)) = (noise, &self.denoised) else {
            return Ok(noise);
        };
        self.filter(denoised)?;
        let guarded = denoised.guarded();
        let left = self.estimation.noise_of(&self.state.executor, guarded, &noise)?;
        // Whether pixels want samples is said by what the allocator goes by.
        Ok(left.map(|left| Noise { unconverged: noise.unconverged, ..left }))
    }

    /// Filters the picture so far, unless that has been done. Returns where the time went.
    fn filter(&self, denoised: &DenoisedPicture<E::Buffer>) -> Result<Timings, ExecError> {
        let view = FilterView {
            camera: self.state.parameters.camera,
            mean_radiance: self.estimation.mean_radiance(),
        };
        let control = self.sampling.split() == Split::Control;
        let DeviceState { executor, film, .. } = &self.state;
        denoised.update(executor, film, self.estimation.version(), &view, control)
    }

    /// Whether the picture's relative error is at most [`Sampling::noise`], or that of every pixel
    /// is; never before the first adaptive round.
    pub fn has_converged(&mut self) -> Result<bool, ExecError> {
        let Some(threshold) = self.sampling.noise else { return Ok(false) };
        if self.done.paths < u64::from(self.sampling.initial_samples) * u64::from(self.pixels()) {
            return Ok(false);
        }
        self.gather()?;
        let samples = self.film_samples();
        self.estimation.measure_mean_radiance(&self.state, samples)?;
        let Some(noise) = self.noise()? else { return Ok(false) };
        // Where no light has been found yet, pixels must have looked for it long enough.
        if noise.mean_radiance == 0.0 {
            return Ok(noise.unconverged == 0);
        }
        self.convergence = (f64::from(threshold) / noise.relative_error).powi(2).min(1.0);
        Ok(noise.relative_error <= f64::from(threshold) || noise.unconverged == 0)
    }

    /// How far the picture is on its way to [`Sampling::noise`] in samples, from 0 to 1, by what
    /// [`Self::has_converged`] saw last: the squared error falls as samples rise.
    pub fn convergence(&self) -> f64 {
        self.convergence
    }

    /// Rays that all samples so far have traced, shadow rays included.
    pub fn rays(&self) -> Result<u64, ExecError> {
        self.gather()?;
        self.rays_in_film()
    }

    /// Rays that a path takes, by those whose samples are in the film; 0 without any. It waits for
    /// no worker.
    pub fn rays_per_path(&self) -> Result<f64, ExecError> {
        let paths = self.done.paths.saturating_sub(self.team().slots_given());
        let rays = self.rays_in_film()?;
        Ok(if paths == 0 { 0.0 } else { rays as f64 / paths as f64 })
    }

    fn rays_in_film(&self) -> Result<u64, ExecError> {
        let executor = &self.state.executor;
        let mut total = 0;
        for band in self.state.film.bands() {
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
    /// deserves. The errors of later rounds may change by it, so this is for the end of a render.
    pub fn finish_features(&mut self) -> Result<(), ExecError> {
        let samples = self.film_samples();
        self.estimation.finish_features(&self.state, samples)
    }

    /// [`Self::film`] of what is in the film on the device, skipped samples included.
    pub(super) fn film_on_device(&mut self) -> Result<Film, ExecError> {
        self.gather()?;
        let samples = self.film_samples();
        self.estimation.run_update(&self.state, samples)?;
        self.resolve()?;
        let DeviceState { executor, film, integrator, .. } = &self.state;
        let mut film = film.read(executor)?;
        film.splats = integrator.splats(executor)?.map(|sums| sums.mean());
        film.estimates = self.estimation.read(executor)?;
        let control = self.control.as_ref();
        film.corrections = control.map(|control| control.read(executor)).transpose()?;
        let denoised = self.denoised.as_ref().map(|picture| picture.read(executor));
        film.denoised = denoised.transpose()?;
        Ok(film)
    }

    /// Computes on the device what is to be added to the picture so that it is without bias, where
    /// there is a control film, and the filtered picture, where there is to be one and it is not
    /// there yet ([`Self::noise`] wants it, too): the last step before the film is read, which
    /// [`Self::film`] takes by itself. Returns where the time went.
    pub fn resolve(&self) -> Result<Timings, ExecError> {
        self.gather()?;
        let mut launches = TimedLaunches::default();
        if let Some(control) = &self.control {
            launches.add(control.launches(&self.state.film), Part::Resolve);
        }
        let mut timings = launches.run(&self.state.executor)?;
        if let Some(denoised) = &self.denoised {
            timings += self.filter(denoised)?;
        }
        Ok(timings)
    }
}
