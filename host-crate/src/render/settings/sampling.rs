//! How a render spends its samples.

use super::estimation::{EstimationSettings, Estimator};
use crate::names::named;
use raystream_shaders::film::stream;

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
    /// Samples of a later round, on average over the pixels; above 0. By default as many as pixels
    /// have, by `paper` and `atomic` half of that, but at least 1.
    pub round_budget: Option<f32>,
    /// Estimated relative error (1 is as large as the picture) at which a pixel has converged and
    /// gets no more samples.
    pub noise: Option<f32>,
    /// How estimators look at a pixel's neighbours.
    pub estimation: EstimationSettings,
    /// Whether samples are split into two independent halves even where neither the estimator nor
    /// the allocator needs them. The halves are less well stratified than the whole would be.
    pub halves: bool,
}

/// [`Sampling::control_share`] of `runs`: a fifth. Less leaves pixels that nobody has looked at
/// twice, more takes from those that need it (docs/ADAPTIVE.md).
const CONTROL_SHARE: u64 = 51;

/// Which of the two independent halves of a pixel (see [`raystream_shaders::film`]) its samples are
/// of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Split {
    /// All are of the first half.
    Whole,
    /// The halves take turns.
    ByTurns,
    /// Those that every pixel gets alike are of the first half, which is the control film; those
    /// that errors decide about are of the second.
    Control,
}

impl Split {
    /// The half of samples that every pixel gets alike, see
    /// [`RunWindow::half`](stream::RunWindow::half).
    pub fn of_uniform(self) -> u32 {
        match self {
            Self::Whole | Self::Control => stream::FIRST,
            Self::ByTurns => stream::BY_TURNS,
        }
    }

    /// The half of samples that errors decide about.
    pub fn of_adaptive(self) -> u32 {
        match self {
            Self::Whole => stream::FIRST,
            Self::ByTurns => stream::BY_TURNS,
            Self::Control => stream::SECOND,
        }
    }
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
    /// Each pixel is filled up to what its error deserves, in a run of consecutive slots; a share
    /// goes to every pixel alike, as the control film.
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
        halves: false,
    };

    /// By the estimated error: the default allocator and estimator.
    pub const ADAPTIVE: Self =
        Self { allocator: AllocatorKind::Runs, estimator: Estimator::Bilateral, ..Self::UNIFORM };

    /// How the samples of this render are split into halves.
    pub fn split(&self) -> Split {
        if self.allocator == AllocatorKind::Runs {
            Split::Control
        } else if self.halves || self.noise.is_some() || self.estimator.needs_halves() {
            Split::ByTurns
        } else {
            Split::Whole
        }
    }

    /// The part of all samples after the first round, in 256ths, that every pixel gets alike,
    /// whatever its error: those of the control film (see [`raystream_shaders::film::control`]). It
    /// bounds what an estimate can do wrong, too: no pixel starves.
    pub fn control_share(&self) -> u64 {
        if self.split() == Split::Control { CONTROL_SHARE } else { 0 }
    }

    /// Samples per pixel, on average, of a round after pixels have got `average` samples each:
    /// [`Self::round_budget`], or enough that the errors, which have changed little, need not be
    /// estimated too often.
    pub fn samples_of_round(&self, average: f64) -> f64 {
        let growth = if self.allocator == AllocatorKind::Runs { 1.0 } else { 0.5 };
        self.round_budget.map_or_else(|| (growth * average).max(1.0), f64::from)
    }
}
