//! The method step by step: one round of a render at a time, as a sequence of pictures with what
//! there is to say of each.
//!
//! A [`Method`] renders as everybody does, by an executor that keeps what the kernels of a round
//! have written; [`seen`] takes that apart, [`stages`] says what a reader is shown of it and why,
//! [`pictures`] paints it.

pub mod beside;
pub mod pictures;
pub mod seen;
pub mod stages;
#[cfg(test)]
mod tests;
pub mod texts;

use crate::recording::Recording;
use raystream::exec::Executor;
use raystream::render::{
    AllocatorKind, BvhQuality, Estimator, IntegratorKind, PreparedScene, RenderError, Renderer,
    Sampling, Settings,
};
use raystream::scene::{FilmSize, Scene};
use seen::Seen;
use serde::Serialize;
use stages::{Round, Stage};

/// What a reader chooses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// The size of the picture.
    pub size: FilmSize,
    /// Who decides which pixels are sampled.
    pub allocator: AllocatorKind,
    /// What the error of a pixel is taken to be.
    pub estimator: Estimator,
    /// Whether dark places count as much as bright ones.
    pub relative: bool,
    /// Samples of a round, on average over the pixels; above 0.
    pub budget: f32,
    /// Renders with different seeds are independent.
    pub seed: u32,
}

/// A render whose rounds are looked at.
pub struct Method<E: Executor> {
    recording: Recording<E>,
    renderer: Renderer<Recording<E>>,
    choice: Choice,
    rounds: u32,
}

/// What there is to see of a round.
#[derive(Serialize)]
pub struct Told {
    /// Number of the round, from 1 on.
    pub round: u32,
    /// Its stages in their order.
    pub stages: Vec<Stage>,
}

impl<E: Executor> Method<E> {
    /// A render of `scene` that has not begun.
    ///
    /// # Errors
    /// If it cannot be prepared, or the device has no room for it.
    pub fn new(executor: E, scene: &Scene, choice: Choice) -> Result<Self, RenderError> {
        let prepared = PreparedScene::new(scene, BvhQuality::Fast)?;
        let recording = Recording::new(executor, seen::keep);
        let renderer = Renderer::new(recording.clone(), &prepared, &settings(scene, &choice))?;
        Ok(Self { recording, renderer, choice, rounds: 0 })
    }

    /// Who renders.
    pub fn executor(&self) -> &E {
        self.recording.executor()
    }

    /// Renders the next round.
    ///
    /// # Errors
    /// If the device fails.
    pub fn round(&mut self) -> Result<Told, RenderError> {
        let seen = loop {
            if self.choice.allocator == AllocatorKind::Uniform {
                let samples = self.choice.budget.round().max(1.0) as u32;
                self.renderer.uniform_round(samples).finish()?;
            } else {
                self.renderer.step(u64::MAX)?;
            }
            // A round in which no pixel wanted samples shows nothing.
            if let Some(seen) = Seen::of(&self.recording.take()) {
                break seen;
            }
        };
        self.rounds += 1;
        let round = Round { choice: &self.choice, number: self.rounds, seen: &seen };
        Ok(Told { round: self.rounds, stages: round.stages() })
    }
}

/// The settings of a render that a reader chose. All slots of a round fit one stream, and paths are
/// traced one by one, so that a slot's contribution is its own.
fn settings(scene: &Scene, choice: &Choice) -> Settings {
    let sampling = Sampling {
        allocator: choice.allocator,
        estimator: choice.estimator,
        relative: choice.relative,
        round_budget: Some(choice.budget),
        ..Sampling::default()
    };
    let pixels = choice.size.width * choice.size.height;
    let most = choice.budget.max(sampling.initial_samples as f32).ceil() as u32;
    Settings {
        size: choice.size,
        seed: choice.seed,
        sampling,
        integrator: IntegratorKind::Megakernel,
        stream_slots: Some(pixels.saturating_mul(most)),
        ..Settings::for_scene(scene)
    }
}
