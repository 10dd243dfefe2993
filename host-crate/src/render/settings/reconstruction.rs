//! What users can set about reconstruction.

use crate::names::named;

/// How noise is taken out of a picture; see [`raystream_shaders::reconstruction`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum FilterKind {
    /// `bilateral` and `learned`, mixed in each pixel as an unbiased estimate of the error says is
    /// best.
    #[default]
    Auto,
    /// A joint bilateral filter: that of the estimator `bilateral`, with its
    /// [settings](crate::render::FilterSettings).
    Bilateral,
    /// A joint bilateral filter whose parameters a small network sets for each pixel.
    Learned,
    /// Non-local means: compares patches of each half of the samples, and filters the other half.
    Nlm,
    /// First-order regression: planes in the features of the first surface, fitted to each half of
    /// the samples with weights as of `nlm` of the other.
    Regression,
}

named! {
    FilterKind {
        Auto: "auto",
        Bilateral: "bilateral",
        Learned: "learned",
        Nlm: "nlm",
        Regression: "regression",
    }
}
