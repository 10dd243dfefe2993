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
}

impl Metric {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Rmse, Self::TrimmedRmse];

    /// The error of a point.
    pub fn of(self, point: &Point) -> f64 {
        match self {
            Self::Rmse => point.errors.rmse,
            Self::TrimmedRmse => point.errors.trimmed_rmse,
        }
    }

    /// Its name in titles.
    pub fn title(self) -> &'static str {
        match self {
            Self::Rmse => "RMSE",
            Self::TrimmedRmse => "RMSE without the worst 0.1 % of the pixels",
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
