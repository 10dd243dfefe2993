//! What a configuration gains over another, as rows of CSV files.

use super::metric::Metric;
use serde::Serialize;

/// How much sooner a configuration reaches an error than a baseline does.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Speedup {
    /// Name of the configuration.
    pub configuration: String,
    /// Name of what it is compared with.
    pub baseline: String,
    /// Which error.
    pub metric: Metric,
    /// Samples per pixel with which uniform sampling has that error: the baseline or, where that is
    /// `atomic`, uniform sampling with its integrator.
    pub uniform_samples: u32,
    /// The error.
    pub error: f64,
    /// When the baseline reaches it.
    pub baseline_seconds: Option<f64>,
    /// When the configuration reaches it.
    pub seconds: Option<f64>,
    /// The baseline's time by the configuration's.
    pub time_ratio: Option<f64>,
    /// The baseline's samples by the configuration's.
    pub samples_ratio: Option<f64>,
    /// Why a figure is missing, or what to know of it.
    pub note: String,
}

/// The error at the time that uniform sampling needs for a level.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EqualTime {
    /// Name of the configuration.
    pub configuration: String,
    /// Name of the uniform sampling that it is compared with.
    pub baseline: String,
    /// Which error.
    pub metric: Metric,
    /// Samples per pixel that uniform sampling has at this time.
    pub uniform_samples: u32,
    /// The time.
    pub seconds: f64,
    /// Uniform sampling's error.
    pub uniform_error: f64,
    /// The configuration's error; nothing if its curve does not span this time.
    pub error: Option<f64>,
    /// Uniform sampling's error by the configuration's.
    pub error_ratio: Option<f64>,
}

/// The smallest speed-up over uniform sampling at any of its checkpoints with less error than after
/// 16 samples.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Smallest {
    /// Name of the configuration.
    pub configuration: String,
    /// Name of the uniform sampling that it is compared with.
    pub baseline: String,
    /// Which error.
    pub metric: Metric,
    /// The smallest ratio of times; nothing if no checkpoint's error is reached.
    pub time_ratio: Option<f64>,
    /// Samples per pixel of uniform sampling where it is.
    pub uniform_samples: Option<u32>,
    /// Checkpoints whose error the curve spans.
    pub reached: usize,
    /// Checkpoints that count.
    pub checkpoints: usize,
}
