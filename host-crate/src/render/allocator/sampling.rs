//! How a render spends its samples.

use crate::names::named;
use crate::render::estimator::settings::{EstimationSettings, Estimator};

/// How a render spends its samples: a first uniform round, then rounds of what the allocator makes
/// of the estimated error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampling {
    /// Who decides which pixels a round samples.
    pub allocator: AllocatorKind,
    /// What the error of a pixel is taken to be; `uniform` does not ask.
    pub estimator: Estimator,
    /// Whether errors are relative to the brightness of their pixel: dark places then count as much
    /// as bright ones.
    pub relative: bool,
    /// Samples per pixel of the first round, which is uniform; at least 2.
    pub initial_samples: u32,
    /// Samples of a later round, on average over the pixels; above 0. By default half of what
    /// pixels have, but at least 1.
    pub round_budget: Option<f32>,
    /// Estimated relative error (1 is as large as the picture) at which a pixel has converged and
    /// gets no more samples.
    pub noise: Option<f32>,
    /// How estimators look at a pixel's neighbours.
    pub estimation: EstimationSettings,
}

/// Who decides which pixels a round samples; see [`crate::render::allocator`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum AllocatorKind {
    /// Every pixel equally.
    Uniform,
    /// Streams of pixels whose error exceeds random thresholds (Podee et al.).
    Paper,
    /// In proportion to the error, slots and sums by atomics (Podee et al., equation 2).
    Atomic,
    /// In proportion to the error, each pixel a run of consecutive slots.
    #[default]
    Runs,
}

named! {
    AllocatorKind {
        Uniform: "uniform",
        Paper: "paper",
        Atomic: "atomic",
        Runs: "runs",
    }
}

impl Default for Sampling {
    /// [`Sampling::ADAPTIVE`].
    fn default() -> Self {
        Self::ADAPTIVE
    }
}

impl Sampling {
    /// Every pixel equally.
    pub const UNIFORM: Self = Self {
        allocator: AllocatorKind::Uniform,
        estimator: Estimator::Variance,
        relative: false,
        initial_samples: 5,
        round_budget: None,
        noise: None,
        estimation: EstimationSettings::DEFAULT,
    };

    /// By the estimated error: the default allocator and estimator.
    pub const ADAPTIVE: Self =
        Self { allocator: AllocatorKind::Runs, estimator: Estimator::Bilateral, ..Self::UNIFORM };

    /// Samples per pixel, on average, of a round after pixels have got `average` samples each:
    /// [`Self::round_budget`], or enough that the errors, which have changed little, need not be
    /// estimated too often.
    pub fn samples_of_round(&self, average: f64) -> f64 {
        self.round_budget.map_or_else(|| (average / 2.0).max(1.0), f64::from)
    }
}
