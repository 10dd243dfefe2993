//! What a person chooses of a render, and the settings that follow.

use raystream::render::{AllocatorKind, Estimator, FilterKind, IntegratorKind, Sampling, Settings};
use std::time::Duration;

/// What a person chooses of a render.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choices {
    /// Who decides which pixels are sampled.
    pub allocator: AllocatorKind,
    /// What the error of a pixel is taken to be.
    pub estimator: Estimator,
    /// Whether dark places count as much as bright ones.
    pub relative: bool,
    /// What takes the noise out of the picture, if anything.
    pub filter: Option<FilterKind>,
    /// How paths are computed.
    pub integrator: IntegratorKind,
    /// Renders with different seeds are independent.
    pub seed: u32,
}

impl Default for Choices {
    fn default() -> Self {
        Self {
            allocator: AllocatorKind::Runs,
            estimator: Estimator::default(),
            relative: false,
            filter: None,
            integrator: IntegratorKind::Auto,
            seed: 0,
        }
    }
}

impl Choices {
    /// The settings of a render like `base`, which says how large the picture is and how long paths
    /// are; `noise` is the relative error at which pixels have converged.
    pub fn settings(&self, base: &Settings, noise: Option<f32>) -> Settings {
        Settings {
            seed: self.seed,
            sampling: Sampling {
                allocator: self.allocator,
                estimator: self.estimator,
                relative: self.relative,
                noise,
                ..Sampling::default()
            },
            integrator: self.integrator,
            denoise: self.filter,
            stream_slots: Some(slots(8, base)),
            ..*base
        }
    }

    /// The settings of a picture while the camera moves: what is there soonest.
    pub fn moving_settings(&self, base: &Settings) -> Settings {
        Settings {
            seed: self.seed,
            sampling: Sampling::UNIFORM,
            denoise: None,
            integrator: IntegratorKind::Auto,
            stream_slots: Some(slots(1, base)),
            ..*base
        }
    }

    /// What differs from other choices, for a label: the allocator, and more where that is needed.
    pub fn label(&self, other: Option<&Self>) -> String {
        let mut words = vec![self.allocator.name().to_owned()];
        let Some(other) = other else { return words.concat() };
        if self.allocator == AllocatorKind::Uniform && other.allocator != AllocatorKind::Uniform {
            return words.concat();
        }
        if self.estimator != other.estimator {
            words.push(self.estimator.name().to_owned());
        }
        if self.relative != other.relative {
            words.push(if self.relative { "relative" } else { "absolute" }.to_owned());
        }
        if self.integrator != other.integrator {
            words.push(self.integrator.name().to_owned());
        }
        if self.filter != other.filter {
            words.push(self.filter.map_or("not denoised", FilterKind::name).to_owned());
        }
        words.join(", ")
    }
}

/// Slots of a stream that takes `samples` of each pixel: what more would be is memory to clear with
/// every change.
fn slots(samples: u32, base: &Settings) -> u32 {
    let pixels = base.size.width.saturating_mul(base.size.height);
    pixels.saturating_mul(samples).max(1 << 14)
}

/// What ends a render by itself, whichever comes first; by default nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stops {
    /// Samples per pixel.
    pub samples: Option<u32>,
    /// Time of rendering.
    pub time: Option<Duration>,
    /// Estimated relative error, above 0; 1 is as large as the picture.
    pub noise: Option<f32>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use raystream::scene::{self, FilmSize};

    fn base() -> Settings {
        let mut scene = scene::load_named("cornell_ball").unwrap();
        scene.film = FilmSize { width: 64, height: 48 };
        scene.limits.max_depth = 3;
        Settings::for_scene(&scene)
    }

    #[test]
    fn settings_are_what_was_chosen() {
        let choices = Choices {
            allocator: AllocatorKind::Paper,
            estimator: Estimator::Halves,
            relative: true,
            filter: Some(FilterKind::Nlm),
            integrator: IntegratorKind::Streaming,
            seed: 7,
        };
        let settings = choices.settings(&base(), Some(0.25));
        assert_eq!((settings.size, settings.max_depth, settings.seed), (base().size, 3, 7));
        assert_eq!(settings.sampling.allocator, AllocatorKind::Paper);
        assert_eq!(settings.sampling.estimator, Estimator::Halves);
        assert!(settings.sampling.relative);
        assert_eq!(settings.sampling.noise, Some(0.25));
        assert_eq!(settings.integrator, IntegratorKind::Streaming);
        assert_eq!(settings.denoise, Some(FilterKind::Nlm));
        assert_eq!(settings.stream_slots, Some(8 * 64 * 48));
    }

    #[test]
    fn a_moving_picture_takes_nothing_that_costs_time() {
        let choices = Choices {
            filter: Some(FilterKind::Auto),
            integrator: IntegratorKind::Lvc,
            ..Choices::default()
        };
        let settings = choices.moving_settings(&choices.settings(&base(), Some(0.1)));
        assert_eq!(settings.denoise, None);
        assert_eq!(settings.integrator, IntegratorKind::Auto);
        assert_eq!(settings.sampling, Sampling::UNIFORM);
        assert_eq!(settings.stream_slots, Some(1 << 14));
        assert_eq!(settings.max_depth, 3, "it is the same picture");
    }

    #[test]
    fn labels_say_what_differs() {
        let runs = Choices::default();
        let uniform = Choices { allocator: AllocatorKind::Uniform, ..runs };
        assert_eq!(runs.label(None), "runs");
        assert_eq!((runs.label(Some(&uniform)), uniform.label(Some(&runs))).0, "runs");
        assert_eq!(uniform.label(Some(&runs)), "uniform");
        let halves = Choices { estimator: Estimator::Halves, relative: true, ..runs };
        assert_eq!(halves.label(Some(&runs)), "runs, halves, relative");
        assert_eq!(runs.label(Some(&halves)), "runs, bilateral, absolute");
        let other =
            Choices { integrator: IntegratorKind::Lvc, filter: Some(FilterKind::Nlm), ..runs };
        assert_eq!(other.label(Some(&runs)), "runs, lvc, nlm");
    }
}
