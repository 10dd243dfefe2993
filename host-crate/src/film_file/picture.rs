//! Pictures of films whose scenes are not at hand.

use super::FilmFile;
use crate::exec::Executor;
use crate::film::Film;
use crate::render::film::control::ControlFilm;
use crate::render::film::splats::SplatSums;
use crate::render::reconstruction::{FilterView, FilteredPicture, Reconstruction};
use crate::render::{Checkpoint, FilmBuffers, FilterKind, FilterSettings, RenderError};

impl FilmFile {
    /// The film with the corrections by its control film, with what light tracing has found and,
    /// if `denoise` names a filter, with a picture by that, which wants
    /// [halves](Film::halves). Features are as far as they were when it was written, and errors are
    /// not estimated; [`Renderer::film`](crate::render::Renderer::film) has both.
    ///
    /// # Errors
    /// If the device fails or has not enough memory.
    pub fn film<E: Executor>(
        &self,
        executor: &E,
        denoise: Option<FilterKind>,
    ) -> Result<Film, RenderError> {
        let Checkpoint { size, radiance, unit_exponent, features, splats, progress } =
            &self.checkpoint;
        let buffers = FilmBuffers::new(executor, *size, *unit_exponent)?;
        buffers.write(executor, radiance, features)?;
        let mut film = buffers.read(executor)?;
        film.splats = splats.as_ref().map(SplatSums::mean);
        if self.header.has_control {
            let control = ControlFilm::new(executor, *size)?;
            executor.run(&control.launches(&buffers))?;
            film.corrections = Some(control.read(executor)?);
        }
        if let Some(kind) = denoise {
            let settings = FilterSettings::default();
            let filtered = FilteredPicture::new(executor, *size, kind, settings)?;
            let picture = Reconstruction::new(executor, filtered)?;
            let mean_radiance = progress.mean_radiance_bits.map_or(0.0, f32::from_bits);
            let view = FilterView { camera: self.header.camera, mean_radiance };
            picture.run(executor, &buffers, &view, self.header.has_control)?;
            film.denoised = Some(picture.read(executor)?);
        }
        Ok(film)
    }
}
