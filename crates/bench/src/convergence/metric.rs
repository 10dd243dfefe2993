//! The errors that curves are compared by.

use super::curve::Point;
use serde::Serialize;

/// Which error counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Metric {
    /// Over all pixels.
    #[serde(rename = "rmse")]
    Rmse,
    /// Without the worst 0.1 % of the pixels.
    #[serde(rename = "trimmed_rmse")]
    TrimmedRmse,
    /// Squared errors by the squared brightness of their pixel, over all pixels.
    #[serde(rename = "relative_mse")]
    RelativeMse,
}

impl Metric {
    /// All.
    pub const ALL: [Self; 3] = [Self::Rmse, Self::TrimmedRmse, Self::RelativeMse];

    /// The error of a point.
    pub fn of(self, point: &Point) -> f64 {
        match self {
            Self::Rmse => point.errors.rmse,
            Self::TrimmedRmse => point.errors.trimmed_rmse,
            Self::RelativeMse => point.errors.relative_mse,
        }
    }

    /// Its name in titles.
    pub fn title(self) -> &'static str {
        match self {
            Self::Rmse => "RMSE (radiance)",
            Self::TrimmedRmse => "RMSE without the worst 0.1 % of the pixels (radiance)",
            Self::RelativeMse => "relative MSE",
        }
    }

    /// The error of a point that the noise of a reference, an RMSE, is set against.
    pub fn absolute(self, point: &Point) -> f64 {
        match self {
            Self::RelativeMse => point.errors.rmse,
            Self::Rmse | Self::TrimmedRmse => self.of(point),
        }
    }

    /// The points of a curve as pairs of time in seconds and error.
    pub fn over_time(self, curve: &[Point]) -> Vec<(f64, f64)> {
        curve.iter().map(|p| (p.wall.as_secs_f64(), self.of(p))).collect()
    }

    /// The points of a curve as pairs of samples per pixel and error.
    pub fn over_samples(self, curve: &[Point]) -> Vec<(f64, f64)> {
        curve.iter().map(|p| (p.samples, self.of(p))).collect()
    }
}
