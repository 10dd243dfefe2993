//! The filtered picture of a render, and whether it is that of the film as it is.

use super::estimator::FilmVersion;
use super::film::FilmBuffers;
use super::reconstruction::{FilterView, FilteredPicture, Reconstruction};
use super::settings::Settings;
use super::timings::Timings;
use crate::exec::{Array, ExecError, Executor};
use raystream_shaders::estimator::Estimate;
use std::sync::{Mutex, PoisonError};

/// What [`Settings::denoise`] asks for, made anew only where the film has changed.
pub struct DenoisedPicture<B> {
    reconstruction: Reconstruction<B>,
    /// The film that the picture is of; none before the first.
    of: Mutex<Option<FilmVersion>>,
}

impl<B: Send + Sync + 'static> DenoisedPicture<B> {
    /// None where no filter is asked for.
    pub fn new<E: Executor<Buffer = B>>(
        executor: &E,
        settings: &Settings,
    ) -> Result<Option<Self>, ExecError> {
        let Some(kind) = settings.denoise else { return Ok(None) };
        let filter = settings.sampling.estimation.filter;
        let picture = FilteredPicture::new(executor, settings.size, kind, filter)?;
        let reconstruction = Reconstruction::new(executor, picture)?;
        Ok(Some(Self { reconstruction, of: Mutex::default() }))
    }

    /// Filters `film`, which is of this `version`, unless that has been done; arguments as of
    /// [`Reconstruction::run`]. Returns where the time went.
    pub fn update<E: Executor<Buffer = B>>(
        &self,
        executor: &E,
        film: &FilmBuffers<B>,
        version: FilmVersion,
        view: &FilterView,
        control: bool,
    ) -> Result<Timings, ExecError> {
        let mut of = self.of.lock().unwrap_or_else(PoisonError::into_inner);
        if *of == Some(version) {
            return Ok(Timings::default());
        }
        // What fails half way leaves a picture of nothing.
        *of = None;
        let timings = self.reconstruction.run(executor, film, view, control)?;
        *of = Some(version);
        Ok(timings)
    }

    /// Pictures and their squared errors, in rank order, before the mean is put right.
    pub fn guarded(&self) -> &Array<B, Estimate> {
        self.reconstruction.guarded()
    }

    /// Copies the picture with its squared errors to the host, in rows.
    pub fn read<E: Executor<Buffer = B>>(&self, executor: &E) -> Result<Vec<Estimate>, ExecError> {
        self.reconstruction.read(executor)
    }
}
