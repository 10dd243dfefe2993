//! Reconstruction on a device: from the film to a picture with less noise, and to the error that is
//! left in it; see [`raystream_shaders::reconstruction`].
//!
//! [`FilteredPicture`] is what a filter makes of a film. [`Reconstruction`] makes a picture to look
//! at of that, by guard and mean.

pub mod auto;
pub(super) mod axis_aligned;
mod bilateral;
mod features;
mod gem;
mod halves;
mod inputs;
pub mod learned;
mod manifolds;
mod mixture;
mod nfor;
mod nlm;
pub mod oidn;

pub use inputs::{FilterInputs, FilterView};

use self::auto::Auto;
use self::axis_aligned::AxisAligned;
use self::bilateral::Bilateral;
use self::features::ByFeatures;
use self::gem::Gem;
use self::learned::Learned;
use self::manifolds::Manifolds;
use self::nfor::Nfor;
use self::nlm::Nlm;
use self::oidn::Oidn;
use super::film::control::ControlFilm;
use super::film::{FilmBuffers, in_rows, row_place};
use super::round::launches::TimedLaunches;
use super::settings::estimation::FilterSettings;
use super::settings::reconstruction::FilterKind;
use super::timings::{Part, Timings};
use crate::clock::Instant;
use crate::exec::{Array, ExecError, Executor, Launch, kernels};
use crate::scene::FilmSize;
use bytemuck::Zeroable;
use raystream_shaders::estimator::Estimate;
use raystream_shaders::estimator::filtered::FilteredPixel;
use raystream_shaders::estimator::guide::Guide;
use raystream_shaders::reconstruction::mean::MeanParams;

/// Standard deviation, in pixels, of the Gaussian over which the guard averages.
const GUARD_SIGMA: f32 = 1.0;

/// A filter: makes a picture with less noise of guides and halves.
///
/// What it makes need not converge: the guard, which is the same for all, sees to that. It owns
/// the memory that it works in.
pub trait Filter<B>: Send + Sync {
    /// The launches after which `filtered`, in rank order, is the filtered picture of `inputs`.
    fn launches<'a>(
        &'a self,
        inputs: &'a FilterInputs<B>,
        view: &FilterView,
        filtered: &'a Array<B, FilteredPixel>,
    ) -> Vec<Launch<'a, B>>;

    /// What is done in the host's memory once these have been run, in the place of them: for
    /// libraries that are no kernels.
    fn on_host(&self) -> Option<&dyn HostFilter> {
        None
    }
}

/// A filter that works in the host's memory.
pub trait HostFilter: Send + Sync {
    /// The filtered picture of guides, both in rows.
    ///
    /// # Errors
    /// If the library fails that it calls.
    fn filter(&self, size: FilmSize, guides: &[Guide]) -> Result<Vec<FilteredPixel>, ExecError>;
}

/// A filter for pictures of `size`; `settings` are those of `bilateral`, which `auto` has too.
///
/// # Errors
/// If the device has no room for what it works in, or a library is not there.
pub fn create<E: Executor>(
    executor: &E,
    size: FilmSize,
    kind: FilterKind,
    settings: FilterSettings,
) -> Result<Box<dyn Filter<E::Buffer>>, ExecError> {
    Ok(match kind {
        FilterKind::Auto => Box::new(Auto::new(executor, size, settings)?),
        FilterKind::AxisAligned => Box::new(AxisAligned::new(executor, size)?),
        FilterKind::Bilateral => Box::new(Bilateral::new(settings)),
        FilterKind::Features => Box::new(ByFeatures::new(executor, size)?),
        FilterKind::Gem => Box::new(Gem::new(executor, size)?),
        FilterKind::Learned => Box::new(Learned::new(executor, size, &learned::weights())?),
        FilterKind::Manifolds => Box::new(Manifolds::new(executor, size)?),
        FilterKind::Nfor => Box::new(Nfor::new(executor, size)?),
        FilterKind::Oidn => Box::new(Oidn::load()?),
        FilterKind::Nlm => Box::new(Nlm::new(executor, size)?),
    })
}

/// A filter, what it looks at, and what it makes of that.
pub struct FilteredPicture<B> {
    inputs: FilterInputs<B>,
    filter: Box<dyn Filter<B>>,
    filtered: Array<B, FilteredPixel>,
}

impl<B: Send + Sync + 'static> FilteredPicture<B> {
    /// Of a picture of `size`, by [`create`] with the same arguments.
    ///
    /// # Errors
    /// If the device has no room for it, or cannot give its parts to a kernel as a whole.
    pub fn new<E: Executor<Buffer = B>>(
        executor: &E,
        size: FilmSize,
        kind: FilterKind,
        settings: FilterSettings,
    ) -> Result<Self, ExecError> {
        let filter = create(executor, size, kind, settings)?;
        Self::with_filter(executor, size, filter)
    }

    /// The same with a filter of one's own.
    ///
    /// # Errors
    /// Likewise.
    pub fn with_filter<E: Executor<Buffer = B>>(
        executor: &E,
        size: FilmSize,
        filter: Box<dyn Filter<B>>,
    ) -> Result<Self, ExecError> {
        let pixels = (size.width * size.height) as usize;
        let inputs = FilterInputs::new(executor, size)?;
        let filtered = Array::zeroed(executor, "a filtered picture", pixels)?;
        Ok(Self { inputs, filter, filtered })
    }

    /// What the filter looks at.
    pub fn inputs(&self) -> &FilterInputs<B> {
        &self.inputs
    }

    /// The filtered picture, in rank order.
    pub fn filtered(&self) -> &Array<B, FilteredPixel> {
        &self.filtered
    }

    /// The launches after which [`Self::filtered`] is the picture of `film`, by a filter that does
    /// nothing [on the host](Filter::on_host).
    pub fn launches<'a>(
        &'a self,
        film: &'a FilmBuffers<B>,
        view: &FilterView,
    ) -> Vec<Launch<'a, B>> {
        let mut launches = self.inputs.launches(film);
        launches.extend(self.filter.launches(&self.inputs, view, &self.filtered));
        launches
    }

    /// Filters the inputs as the launches `before` leave them, so that [`Self::filtered`] is the
    /// picture of these, and runs the launches `after`. Returns where the time went.
    ///
    /// # Errors
    /// If the device fails, or a library that the filter is.
    pub fn run<'a, E: Executor<Buffer = B>>(
        &'a self,
        executor: &E,
        before: Vec<Launch<'a, B>>,
        view: &FilterView,
        after: Vec<Launch<'a, B>>,
    ) -> Result<Timings, ExecError> {
        let mut launches = TimedLaunches::default();
        launches.add(before, Part::Reconstruction);
        launches
            .add(self.filter.launches(&self.inputs, view, &self.filtered), Part::Reconstruction);
        let mut timings = Timings::default();
        if let Some(filter) = self.filter.on_host() {
            timings += launches.run(executor)?;
            let start = Instant::now();
            self.run_on_host(executor, filter)?;
            timings[Part::Reconstruction] += start.elapsed();
            launches = TimedLaunches::default();
        }
        launches.add(after, Part::Reconstruction);
        timings += launches.run(executor)?;
        Ok(timings)
    }

    fn run_on_host<E: Executor<Buffer = B>>(
        &self,
        executor: &E,
        filter: &dyn HostFilter,
    ) -> Result<(), ExecError> {
        let size = self.inputs.size;
        let guides = in_rows(size, &self.inputs.guides.read(executor)?);
        let rows = filter.filter(size, &guides)?;
        let ranks = 0..rows.len() as u32;
        let ranked: Vec<_> = ranks.map(|rank| rows[row_place(size, rank)]).collect();
        self.filtered.write(executor, &ranked)
    }
}

/// A filtered picture to look at: it converges to the truth, its mean is the right one, and the
/// error that is left is known.
pub struct Reconstruction<B> {
    picture: FilteredPicture<B>,
    guarded: Array<B, Estimate>,
    mean: ControlFilm<B>,
}

impl<B: Send + Sync + 'static> Reconstruction<B> {
    /// Of what a filter makes of a picture of `size`.
    ///
    /// # Errors
    /// If the device has no room for it, or cannot give its parts to a kernel as a whole.
    pub fn new<E: Executor<Buffer = B>>(
        executor: &E,
        picture: FilteredPicture<B>,
    ) -> Result<Self, ExecError> {
        let size = picture.inputs.size;
        let pixels = (size.width * size.height) as usize;
        Ok(Self {
            picture,
            guarded: Array::zeroed(executor, "a reconstructed picture", pixels)?,
            mean: ControlFilm::new(executor, size)?,
        })
    }

    /// What the filter looks at.
    pub fn inputs(&self) -> &FilterInputs<B> {
        &self.picture.inputs
    }

    /// Pictures and their squared errors, in rank order, before the mean is put right.
    pub fn guarded(&self) -> &Array<B, Estimate> {
        &self.guarded
    }

    /// Filters `film`. With `control` the first half of the film's samples is a control film, whose
    /// mean is the right one. Returns where the time went.
    ///
    /// # Errors
    /// If the device fails, or a library that the filter is.
    pub fn run<E: Executor<Buffer = B>>(
        &self,
        executor: &E,
        film: &FilmBuffers<B>,
        view: &FilterView,
        control: bool,
    ) -> Result<Timings, ExecError> {
        let before = self.inputs().launches(film);
        self.picture.run(executor, before, view, self.after_filter(control))
    }

    /// The same of inputs that have been written, and are still to be
    /// [calibrated](FilterInputs::calibration).
    ///
    /// # Errors
    /// Likewise.
    pub fn run_inputs<E: Executor<Buffer = B>>(
        &self,
        executor: &E,
        view: &FilterView,
        control: bool,
    ) -> Result<Timings, ExecError> {
        let before = self.inputs().calibration();
        self.picture.run(executor, before, view, self.after_filter(control))
    }

    /// The launches of the guard and of the mean.
    fn after_filter(&self, control: bool) -> Vec<Launch<'_, B>> {
        let FilteredPicture { inputs, filtered, .. } = &self.picture;
        let parameters = inputs.parameters();
        let mut launches = vec![kernels::guard_terms(
            &parameters,
            inputs.guides.view(),
            filtered.view(),
            inputs.rows.view(),
        )];
        launches.extend(inputs.blur(GUARD_SIGMA));
        launches.push(kernels::guard(
            &parameters,
            inputs.guides.view(),
            filtered.view(),
            inputs.rows.view(),
            self.guarded.view(),
        ));
        let parameters = MeanParams {
            threads: parameters.threads,
            width: parameters.width,
            height: parameters.height,
            control: u32::from(control),
            ..MeanParams::zeroed()
        };
        let (differences, counts) = self.mean.differences();
        launches.push(kernels::filtered_differences(
            &parameters,
            inputs.guides.view(),
            inputs.first.view(),
            self.guarded.view(),
            differences.view(),
            counts.view(),
        ));
        launches.extend(self.mean.spread());
        launches
    }

    /// Copies the picture with its squared errors to the host, in rows.
    ///
    /// # Errors
    /// If the device fails.
    pub fn read<E: Executor<Buffer = B>>(&self, executor: &E) -> Result<Vec<Estimate>, ExecError> {
        let mut rows = in_rows(self.picture.inputs.size, &self.guarded.read(executor)?);
        for (pixel, correction) in rows.iter_mut().zip(self.mean.read(executor)?) {
            pixel.filtered += correction;
        }
        Ok(rows)
    }
}
