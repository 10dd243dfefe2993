//! What a render is between two of its streams, and how to go on from there.
//!
//! With the scene, the settings and the device a [`Checkpoint`] is all that it takes: a render that
//! goes on from one makes the film, bit for bit, that it would have made without a break.

use super::allocator::Windows;
use super::error::RenderError;
use super::film::splats::SplatSums;
use super::renderer::Renderer;
use super::round::plan::Done;
use super::round::state::DeviceState;
use super::settings::sampling::Split;
use crate::exec::{ExecError, Executor};
use crate::film::Film;
use crate::scene::FilmSize;
use raystream_shaders::film::sums::PixelSums;
use raystream_shaders::integrator::first_hits::FeaturePixel;
use serde::{Deserialize, Serialize};

/// The state of a render.
#[derive(Clone, Debug, PartialEq)]
pub struct Checkpoint {
    /// Size of the picture in pixels.
    pub size: FilmSize,
    /// Radiance and sample counts, in rows from the top left.
    pub radiance: Vec<PixelSums>,
    /// The unit of these sums is 2 to this power.
    pub unit_exponent: i32,
    /// First-hit features, likewise.
    pub features: Vec<FeaturePixel>,
    /// What light tracing has found, if there is any.
    pub splats: Option<SplatSums>,
    /// How far it is.
    pub progress: RenderProgress,
}

/// How far a render is: the numbers that are not in its film.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct RenderProgress {
    /// Paths traced.
    pub paths: u64,
    /// Samples that every pixel has got alike, or will have at the end of the round under way.
    pub uniform_samples: u32,
    /// Rounds begun.
    pub rounds: u32,
    /// What the round under way has still to do; nothing between rounds.
    pub rest: Windows,
    /// Samples of each pixel that are left to other films: the numbers of its own begin there.
    pub skipped_samples: u32,
    /// Camera rays of each pixel's features.
    pub feature_samples: u32,
    /// The bits of the mean radiance that relative errors are relative to, once it is measured.
    pub mean_radiance_bits: Option<u32>,
}

impl<E: Executor> Renderer<E> {
    /// Copies the state to the host. Taken where [`Round::can_be_kept`](super::Round::can_be_kept),
    /// or between rounds, it is all of it.
    ///
    /// # Errors
    /// If the device fails.
    pub fn checkpoint(&self) -> Result<Checkpoint, ExecError> {
        self.gather()?;
        let executor = &self.state.executor;
        let film = &self.state.film;
        let mut radiance = film.read_sums(executor)?;
        let [first, second] = self.skipped_by_half();
        for pixel in &mut radiance {
            pixel.first_samples -= first;
            pixel.second_samples -= second;
        }
        Ok(Checkpoint {
            size: film.size(),
            radiance,
            unit_exponent: film.unit_exponent(),
            features: film.read_features(executor)?,
            splats: self.state.integrator.splats(executor)?,
            progress: RenderProgress {
                paths: self.done.paths,
                uniform_samples: self.done.uniform,
                rounds: self.done.rounds,
                rest: self.rest,
                skipped_samples: self.skipped,
                feature_samples: self.estimation.feature_samples(),
                mean_radiance_bits: self.estimation.measured_mean_radiance().map(f32::to_bits),
            },
        })
    }

    /// Goes on from `checkpoint`, which a renderer of the same scene, settings and kind of device
    /// has given.
    ///
    /// # Errors
    /// If the device fails, or the checkpoint does not fit: its picture has another size, or its
    /// integrator has kept something else.
    pub fn restore(&mut self, checkpoint: &Checkpoint) -> Result<(), RenderError> {
        self.gather()?;
        let executor = &self.state.executor;
        let pixels = [checkpoint.radiance.len(), checkpoint.features.len()];
        let shape = |sums: &SplatSums| (sums.words.len(), sums.unit_exponent, sums.light_paths);
        let own = self.state.integrator.splats(executor)?;
        if checkpoint.size != self.state.film.size()
            || pixels != [self.pixels() as usize; 2]
            || checkpoint.unit_exponent != self.state.film.unit_exponent()
            || checkpoint.splats.as_ref().map(shape) != own.as_ref().map(shape)
        {
            return Err(RenderError::CheckpointDiffers);
        }
        let RenderProgress { paths, uniform_samples, rounds, .. } = checkpoint.progress;
        self.skipped = checkpoint.progress.skipped_samples;
        self.done = Done { paths, uniform: uniform_samples, rounds };
        self.rest = checkpoint.progress.rest;
        let [first, second] = self.skipped_by_half();
        let shifted = |pixel: &PixelSums| PixelSums {
            first_samples: pixel.first_samples + first,
            second_samples: pixel.second_samples + second,
            ..*pixel
        };
        let radiance: Vec<_> = checkpoint.radiance.iter().map(shifted).collect();
        self.state.film.write(executor, &radiance, &checkpoint.features)?;
        if let Some(splats) = &checkpoint.splats {
            self.state.integrator.restore(executor, splats)?;
        }
        let mean_radiance = checkpoint.progress.mean_radiance_bits.map(f32::from_bits);
        self.estimation.restore(checkpoint.progress.feature_samples, mean_radiance);
        Ok(())
    }

    /// A look at a render under way, for which nothing is computed: samples and what light tracing
    /// found, the features and the estimates of the last round that asked for them, if one has. It
    /// has no corrections and no filtered picture; [`Self::film`] has.
    ///
    /// # Errors
    /// If the device fails.
    pub fn glance(&self) -> Result<Film, RenderError> {
        self.gather()?;
        let DeviceState { executor, film, integrator, .. } = &self.state;
        let splats = integrator.splats(executor)?.map(|sums| sums.mean());
        let estimates = self.estimation.read_last(executor)?;
        let has_features = self.estimation.feature_samples() > 0;
        let film = if has_features { film.read(executor)? } else { film.read_radiance(executor)? };
        Ok(Film { splats, estimates, ..film })
    }

    /// Copies the film to the host, with the features [so far](Self::finish_features) and, where
    /// there are such, with estimates of its errors, with the corrections by the control film and
    /// with what light tracing found. Errors are those of the samples alone.
    ///
    /// # Errors
    /// If the device fails.
    pub fn film(&mut self) -> Result<Film, RenderError> {
        if self.skipped == 0 {
            return Ok(self.film_on_device()?);
        }
        // Filters and estimators go by the numbers of samples.
        let kept = self.checkpoint()?;
        let progress = RenderProgress { skipped_samples: 0, ..kept.progress };
        self.restore(&Checkpoint { progress, ..kept.clone() })?;
        let film = self.film_on_device()?;
        self.restore(&kept)?;
        Ok(film)
    }

    /// Leaves the first `samples` samples of each pixel to other films: its own begin with the one
    /// after. For a render that has not begun.
    ///
    /// # Errors
    /// If the device fails.
    pub fn skip_samples(&mut self, samples: u32) -> Result<(), RenderError> {
        let mut checkpoint = self.checkpoint()?;
        checkpoint.progress.skipped_samples = samples;
        self.restore(&checkpoint)
    }

    /// The skipped samples of both halves.
    fn skipped_by_half(&self) -> [u32; 2] {
        match self.sampling.split() {
            Split::ByTurns => [self.skipped.div_ceil(2), self.skipped / 2],
            Split::Whole | Split::Control => [self.skipped, 0],
        }
    }
}
