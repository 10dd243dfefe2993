//! A render on one device, and its rounds: what it owns, what it can be asked, and how a round goes
//! from batch to batch.

use super::allocator::{Allocation, Allocator as _, RoundBuffers, Stream, Streams, Windows};
use super::estimator::{Estimation, FilmSamples, Noise};
use super::film::control::ControlFilm;
use super::film::{FilmBuffers, WINDOW_ALIGNMENT};
use super::integrator::{self, Integrator, IntegratorContext};
use super::reconstruction::{FilterView, FilteredPicture, Reconstruction};
use super::round::batch::BatchSize;
use super::round::launches::TimedLaunches;
use super::round::plan::{self, Done, Limits, RoundPlan, plan};
use super::round::state::{DeviceState, allocate_stream};
use super::scene::PreparedScene;
use super::settings::Settings;
use super::settings::sampling::{Sampling, Split};
use super::timings::{Part, Timings};
use crate::exec::device::Device;
use crate::exec::{Array, ExecError, Executor, kernels};
use crate::film::Film;
use bytemuck::Zeroable;
use raystream_shaders::film::accumulate::CountParams;
use raystream_shaders::math::random::hash;
use std::ops::Range;
use std::time::Instant;

/// A scene, a film and a sample stream on a device.
///
/// It owns the device: a clone of a [`Device`], which is cheap, or a reference to any other
/// executor.
pub struct Renderer<E: Executor = Device> {
    pub(super) state: DeviceState<E>,
    pub(super) estimation: Estimation<E::Buffer>,
    batch: BatchSize,
    pub(super) done: Done,
    seed: u32,
    pub(super) sampling: Sampling,
    allocation: Allocation<E>,
    /// None where no half of the samples is one.
    control: Option<ControlFilm<E::Buffer>>,
    /// None where the picture is not to be filtered.
    reconstruction: Option<Reconstruction<E::Buffer>>,
    ray_counts: Array<E::Buffer, u32>,
    /// What is left of a round of independent samples that was dropped before its end.
    pub(super) rest: Windows,
    /// See [`Self::skip_samples`].
    pub(super) skipped: u32,
    /// See [`Self::convergence`].
    convergence: f64,
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
        let scene_buffers = scene.buffers_for(&executor, settings.abilities())?;
        let film = FilmBuffers::new(&executor, settings.size)?;
        let (slots, contributions) = allocate_stream(&executor, settings.stream_slots)?;
        let parameters = scene.parameters(settings);
        let context = IntegratorContext {
            executor: &executor,
            scene: &scene_buffers,
            parameters: &parameters,
            settings,
        };
        let integrator = create(&context, slots.len() as u32)?;
        let sampling = settings.whole_sampling();
        let has_control = sampling.split() == Split::Control;
        let control = has_control.then(|| ControlFilm::new(&executor, settings.size));
        Ok(Self {
            estimation: Estimation::new(&executor, settings.size, sampling)?,
            batch: BatchSize::new(slots.len() as u32),
            done: Done::default(),
            seed: settings.seed,
            sampling,
            allocation: Allocation::new(sampling.allocator, &executor, film.pixels())?,
            control: control.transpose()?,
            reconstruction: reconstruction(&executor, settings)?,
            ray_counts: Array::zeroed(&executor, "ray counts", COUNTERS as usize)?,
            rest: Windows::default(),
            skipped: 0,
            convergence: 0.0,
            state: DeviceState {
                executor,
                scene: scene_buffers,
                film,
                parameters,
                integrator,
                slots,
                contributions,
            },
        })
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

    fn limits(&self) -> Limits {
        Limits {
            pixels: self.pixels(),
            slots: self.state.slots.len() as u32,
            samples_that_share: self.samples_that_share(),
            batch: self.batch.slots(),
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
        let samples = self.film_samples();
        let noise = self.estimation.noise(&self.state, samples)?;
        let (Some(noise), Some(reconstruction)) = (noise, &self.reconstruction) else {
            return Ok(noise);
        };
        self.reconstruct(reconstruction)?;
        let guarded = reconstruction.guarded();
        let left = self.estimation.noise_of(&self.state.executor, guarded, &noise)?;
        // Whether pixels want samples is said by what the allocator goes by.
        Ok(left.map(|left| Noise { unconverged: noise.unconverged, ..left }))
    }

    /// Filters the picture so far. Returns where the time went.
    fn reconstruct(
        &self,
        reconstruction: &Reconstruction<E::Buffer>,
    ) -> Result<Timings, ExecError> {
        let view = FilterView {
            camera: self.state.parameters.camera,
            mean_radiance: self.estimation.mean_radiance(),
        };
        let control = self.sampling.split() == Split::Control;
        reconstruction.run(&self.state.executor, &self.state.film, &view, control)
    }

    /// Whether the picture's relative error is at most [`Sampling::noise`], or that of every pixel
    /// is; never before the first adaptive round.
    pub fn has_converged(&mut self) -> Result<bool, ExecError> {
        let Some(threshold) = self.sampling.noise else { return Ok(false) };
        if self.done.paths < u64::from(self.sampling.initial_samples) * u64::from(self.pixels()) {
            return Ok(false);
        }
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
        let samples = self.film_samples();
        self.estimation.run_update(&self.state, samples)?;
        self.resolve()?;
        let DeviceState { executor, film, integrator, .. } = &self.state;
        let mut film = film.read(executor)?;
        film.splats = integrator.splats(executor)?.map(|sums| sums.mean());
        film.estimates = self.estimation.read(executor)?;
        let control = self.control.as_ref();
        film.corrections = control.map(|control| control.read(executor)).transpose()?;
        let denoised = self.reconstruction.as_ref().map(|picture| picture.read(executor));
        film.denoised = denoised.transpose()?;
        Ok(film)
    }

    /// Computes on the device what is to be added to the picture so that it is without bias, where
    /// there is a control film, and the filtered picture, where there is to be one: the last step
    /// before the film is read, which [`Self::film`] takes by itself. Returns where the time went.
    pub fn resolve(&self) -> Result<Timings, ExecError> {
        let mut launches = TimedLaunches::default();
        if let Some(control) = &self.control {
            launches.add(control.launches(&self.state.film), Part::Resolve);
        }
        let mut timings = launches.run(&self.state.executor)?;
        if let Some(reconstruction) = &self.reconstruction {
            timings += self.reconstruct(reconstruction)?;
        }
        Ok(timings)
    }
}

/// What [`Settings::denoise`] asks for.
fn reconstruction<E: Executor>(
    executor: &E,
    settings: &Settings,
) -> Result<Option<Reconstruction<E::Buffer>>, ExecError> {
    let create = |kind| {
        let filter = settings.sampling.estimation.filter;
        Reconstruction::new(executor, FilteredPicture::new(executor, settings.size, kind, filter)?)
    };
    settings.denoise.map(create).transpose()
}

/// A round under way: the caller takes it from batch to batch, and may look at the clock or tell
/// of progress in between. A round that is dropped before its end leaves out the samples of the
/// streams that it has not come to the end of; if samples are independent and all pixels get as
/// many, the next round goes on with them.
#[must_use = "a round traces nothing until its batches are taken"]
pub struct Round<'r, E: Executor> {
    renderer: &'r mut Renderer<E>,
    plan: RoundPlan,
    /// The streams that are still to be begun.
    streams: Streams,
    /// The stream that is being worked off.
    stream: Option<Stream>,
    /// The first slot of the next batch in the stream.
    next: u32,
    /// Whether no batch has been run.
    is_new: bool,
    timings: Timings,
}

/// What one submission has traced.
#[derive(Clone, Copy, Debug)]
pub struct Batch {
    /// Slots of the sample stream: as many paths, but for slots that stay empty.
    pub paths: u32,
    /// Where its time went.
    pub timings: Timings,
}

impl<'r, E: Executor> Round<'r, E> {
    /// Begins the round; `timings` are of what was done for it before.
    fn new(renderer: &'r mut Renderer<E>, plan: RoundPlan, timings: Timings) -> Self {
        let state = &renderer.state;
        let largest = state.slots.len() as u32;
        let streams = Streams::new(&state.film, plan.uniform, plan.adaptive, largest);
        renderer.done.rounds += 1;
        renderer.done.uniform += plan.uniform;
        renderer.rest = Windows::default();
        Self { renderer, plan, streams, stream: None, next: 0, is_new: true, timings }
    }

    /// Goes on with what is left of a round.
    fn of_rest(renderer: &'r mut Renderer<E>, rest: Windows) -> Self {
        let number = renderer.done.rounds.saturating_sub(1);
        let plan = RoundPlan { number, uniform: rest.samples(), adaptive: 0 };
        let (streams, timings) = (Streams::of_rest(rest), Timings::default());
        Self { renderer, plan, streams, stream: None, next: 0, is_new: true, timings }
    }

    /// Traces the next batch: slots of one stream, as many as the device works off in about a tenth
    /// of a second. None at the round's end.
    pub fn next_batch(&mut self) -> Result<Option<Batch>, ExecError> {
        let batch = self.renderer.batch.slots().next_multiple_of(WINDOW_ALIGNMENT);
        if self.stream.is_none() {
            // A window is no longer than a batch, so that it is in the film soon.
            let state = &self.renderer.state;
            self.stream = self.streams.next(&state.film, batch.min(state.slots.len() as u32));
        }
        let Some(stream) = &self.stream else { return Ok(None) };
        let slots = self.next..stream.slots.min(self.next + batch);
        let (paths, is_last) = (slots.end - slots.start, slots.end == stream.slots);
        let executor = &self.renderer.state.executor;
        let start = Instant::now();
        let timings = self.launches(stream, slots.clone()).run(executor)?;
        let elapsed = start.elapsed();
        let allocation = &self.renderer.allocation;
        let filled = if is_last { allocation.filled(executor, stream)? } else { 0 };

        let samples = self.renderer.film_samples();
        let is_updated = self.is_new && self.is_adaptive();
        let Renderer { estimation, done, batch, .. } = &mut *self.renderer;
        if is_updated {
            estimation.updated(samples);
        }
        estimation.film_changed();
        batch.record(paths, elapsed);
        done.paths += u64::from(filled);
        self.is_new = false;
        self.next = slots.end;
        if is_last {
            self.stream = None;
            self.next = 0;
            if self.has_independent_samples() {
                self.renderer.rest = self.streams.rest();
            }
        }
        self.timings += timings;
        Ok(Some(Batch { paths, timings }))
    }

    /// The launches of a batch: with the first one what the round needs before, with a stream's
    /// first one what fills it, with its last one what adds it to the film.
    fn launches(&self, stream: &Stream, slots: Range<u32>) -> TimedLaunches<'_, E::Buffer> {
        let Renderer { state, estimation, allocation, sampling, done, .. } = &*self.renderer;
        let number = self.plan.number;
        let mut launches = TimedLaunches::default();
        if self.is_new {
            if self.is_adaptive() {
                launches = estimation.update(state, self.renderer.film_samples());
            }
            let begin = state.integrator.begin_round(&state.stream_buffers(), number);
            launches.add(begin, Part::Tracing);
        }
        let buffers = RoundBuffers {
            film: &state.film,
            paths: done.paths,
            split: sampling.split(),
            errors: estimation.errors(),
            slots: &state.slots,
            contributions: &state.contributions,
            salt: if self.is_adaptive() { hash(self.renderer.seed ^ hash(number)) } else { 0 },
        };
        let (is_first, is_last) = (slots.start == 0, slots.end == stream.slots);
        if is_first {
            launches.add(allocation.fill(&buffers, stream), Part::Generation);
        }
        launches.add(state.integrator.trace(&state.stream_buffers(), slots), Part::Tracing);
        if is_last {
            launches.add(allocation.accumulate(&buffers, stream), Part::Accumulation);
        }
        launches
    }

    /// Whether all that has been traced is in the film: dropped now, the round loses nothing.
    pub fn is_in_film(&self) -> bool {
        self.stream.is_none()
    }

    /// Who renders it.
    pub fn renderer(&self) -> &Renderer<E> {
        self.renderer
    }

    /// Whether nothing is lost and nothing changes if the round is dropped now and another renderer
    /// goes on from a [`Checkpoint`](super::Checkpoint).
    pub fn can_be_kept(&self) -> bool {
        self.is_in_film() && self.has_independent_samples()
    }

    fn has_independent_samples(&self) -> bool {
        !self.is_adaptive() && self.renderer.samples_that_share().is_none()
    }

    fn is_adaptive(&self) -> bool {
        self.plan.adaptive > 0
    }

    /// Where the time of the batches so far went.
    pub fn timings(&self) -> Timings {
        self.timings
    }

    /// Traces what is left of the round. Returns where the time of all of it went.
    pub fn finish(mut self) -> Result<Timings, ExecError> {
        while self.next_batch()?.is_some() {}
        Ok(self.timings)
    }
}
