//! Rows of CSV files.

use super::curve::Point;
use super::rounds::{Round, millions_per_second};
use super::speedup::REFERENCE_MARGIN;
use super::{Measured, Measurement};
use serde::Serialize;
use std::time::Duration;

/// A point of a curve.
#[derive(Serialize)]
pub struct CurveRow {
    configuration: String,
    checkpoint: u32,
    samples_per_pixel: f64,
    seconds: f64,
    features_seconds: f64,
    estimation_seconds: f64,
    generation_seconds: f64,
    tracing_seconds: f64,
    accumulation_seconds: f64,
    reconstruction_seconds: f64,
    rays: u64,
    rmse: f64,
    trimmed_rmse: f64,
    relative_mse: f64,
    ssim: Option<f64>,
    mean_ratio: f64,
    limited_by_reference: bool,
}

/// All points of all curves; `noise` is the RMSE of the reference.
pub fn curve_rows(measurement: &Measurement, noise: f64) -> impl Iterator<Item = CurveRow> {
    let row = move |measured: &Measured, p: &Point| CurveRow {
        configuration: measured.name.clone(),
        checkpoint: p.checkpoint,
        samples_per_pixel: p.samples,
        seconds: p.wall.as_secs_f64(),
        features_seconds: p.device.features().as_secs_f64(),
        estimation_seconds: p.device.estimation().as_secs_f64(),
        generation_seconds: p.device.generation().as_secs_f64(),
        tracing_seconds: p.device.tracing().as_secs_f64(),
        accumulation_seconds: p.device.accumulation().as_secs_f64(),
        reconstruction_seconds: p.device.reconstruction().as_secs_f64(),
        rays: p.rays,
        rmse: p.errors.rmse,
        trimmed_rmse: p.errors.trimmed_rmse,
        relative_mse: p.errors.relative_mse,
        ssim: p.errors.ssim,
        mean_ratio: p.errors.mean_ratio,
        limited_by_reference: p.errors.rmse < REFERENCE_MARGIN * noise,
    };
    measurement.configurations.iter().flat_map(move |m| m.curve.iter().map(move |p| row(m, p)))
}

/// A round.
#[derive(Serialize)]
pub struct RoundRow {
    configuration: String,
    round: usize,
    paths: u64,
    features_ms: f64,
    estimation_ms: f64,
    generation_ms: f64,
    tracing_ms: f64,
    accumulation_ms: f64,
    wall_ms: f64,
    tracing_mpaths_per_second: Option<f64>,
    tracing_mrays_per_second: Option<f64>,
    uniform_mpaths_per_second: Option<f64>,
    uniform_mrays_per_second: Option<f64>,
}

/// All rounds, numbered from 1 in each configuration, with the rates of uniform rounds of the same
/// length by the same integrator.
pub fn round_rows(measurement: &Measurement) -> impl Iterator<Item = RoundRow> {
    let row = |measured: &Measured, index: usize, round: &Round| {
        let uniform =
            measurement.uniform_rates(measured).and_then(|uniform| uniform.of_length(round.paths));
        RoundRow {
            configuration: measured.name.clone(),
            round: index + 1,
            paths: round.paths,
            features_ms: milliseconds(round.timings.features()),
            estimation_ms: milliseconds(round.timings.estimation()),
            generation_ms: milliseconds(round.timings.generation()),
            tracing_ms: milliseconds(round.timings.tracing()),
            accumulation_ms: milliseconds(round.timings.accumulation()),
            wall_ms: milliseconds(round.wall),
            tracing_mpaths_per_second: millions_per_second(round.paths, round.timings.tracing()),
            tracing_mrays_per_second: millions_per_second(round.rays, round.timings.tracing()),
            uniform_mpaths_per_second: uniform.map(|rate| rate.paths / 1e6),
            uniform_mrays_per_second: uniform.map(|rate| rate.rays / 1e6),
        }
    };
    measurement.configurations.iter().flat_map(move |m| {
        m.rounds.iter().enumerate().map(move |(index, round)| row(m, index, round))
    })
}

fn milliseconds(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}
