//! What users can set about reconstruction.

use crate::names::named;

/// How noise is taken out of a picture; see [`raystream_shaders::reconstruction`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum FilterKind {
    /// `bilateral` and `learned`, mixed in each pixel as an unbiased estimate of the error says is
    /// best.
    #[default]
    Auto,
    /// Gaussians in world distance, as wide as what throws light or shadow is far.
    AxisAligned,
    /// A joint bilateral filter: that of the estimator `bilateral`, with its
    /// [settings](crate::render::FilterSettings).
    Bilateral,
    /// Non-local means by colours and by features: three of them, mixed in each pixel.
    Features,
    /// Greedy error minimisation: the widest Gaussian that pays, by colours alone.
    Gem,
    /// A joint bilateral filter whose parameters a small network sets for each pixel.
    Learned,
    /// Adaptive manifolds: a wide joint bilateral filter over features.
    Manifolds,
    /// Nonlinearly weighted first-order regression: planes in the features of the first surface,
    /// fitted to each half of the samples with weights as of `nlm` of the other.
    Nfor,
    /// Non-local means: compares patches of each half of the samples, and filters the other half.
    Nlm,
    /// Open Image Denoise, where it is installed.
    Oidn,
}

named! {
    FilterKind {
        Auto: "auto",
        AxisAligned: "axis-aligned",
        Bilateral: "bilateral",
        Features: "features",
        Gem: "gem",
        Learned: "learned",
        Manifolds: "manifolds",
        Nfor: "nfor",
        Nlm: "nlm",
        Oidn: "oidn",
    }
}

impl FilterKind {
    /// Those that need no library which might not be installed.
    pub fn built_in() -> impl Iterator<Item = Self> {
        Self::ALL.iter().copied().filter(|&kind| kind != Self::Oidn)
    }
}
