//! Rows of CSV files, and tables in Markdown.

use super::curve::Point;
use super::rounds::{Round, UniformRates, millions_per_second};
use super::speedup::REFERENCE_MARGIN;
use super::{Measured, Measurement};
use crate::bench::BenchError;
use serde::Serialize;
use std::time::Duration;

/// The CSV file with a line for each of `rows`, below one with the names of its fields.
pub fn csv<R: Serialize>(rows: impl IntoIterator<Item = R>) -> Result<Vec<u8>, BenchError> {
    let error = |reason: String| BenchError::Report { what: "a CSV file".into(), reason };
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in rows {
        writer.serialize(row).map_err(|e| error(e.to_string()))?;
    }
    writer.into_inner().map_err(|e| error(e.to_string()))
}

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
    rays: u64,
    rmse: f64,
    trimmed_rmse: f64,
    relative_mse: f64,
    mean_ratio: f64,
    limited_by_reference: bool,
}

/// All points of all curves; `noise` is the RMSE of the reference.
pub fn curve_rows(measurement: &Measurement, noise: f64) -> impl Iterator<Item = CurveRow> {
    let row = move |measured: &Measured, p: &Point| CurveRow {
        configuration: measured.configuration.name(),
        checkpoint: p.checkpoint,
        samples_per_pixel: p.samples,
        seconds: p.wall.as_secs_f64(),
        features_seconds: p.device.features.as_secs_f64(),
        estimation_seconds: p.device.estimation.as_secs_f64(),
        generation_seconds: p.device.generation.as_secs_f64(),
        tracing_seconds: p.device.tracing.as_secs_f64(),
        accumulation_seconds: p.device.accumulation.as_secs_f64(),
        rays: p.rays,
        rmse: p.errors.rmse,
        trimmed_rmse: p.errors.trimmed_rmse,
        relative_mse: p.errors.relative_mse,
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

/// All rounds, numbered from 1 in each configuration, with the rates of uniform rounds of the same length.
pub fn round_rows(measurement: &Measurement) -> impl Iterator<Item = RoundRow> {
    let row = |measured: &Measured, uniform: &UniformRates, index: usize, round: &Round| {
        let uniform = uniform.of_length(round.paths);
        RoundRow {
            configuration: measured.configuration.name(),
            round: index + 1,
            paths: round.paths,
            features_ms: milliseconds(round.timings.features),
            estimation_ms: milliseconds(round.timings.estimation),
            generation_ms: milliseconds(round.timings.generation),
            tracing_ms: milliseconds(round.timings.tracing),
            accumulation_ms: milliseconds(round.timings.accumulation),
            wall_ms: milliseconds(round.wall),
            tracing_mpaths_per_second: millions_per_second(round.paths, round.timings.tracing),
            tracing_mrays_per_second: millions_per_second(round.rays, round.timings.tracing),
            uniform_mpaths_per_second: uniform.map(|rate| rate.paths / 1e6),
            uniform_mrays_per_second: uniform.map(|rate| rate.rays / 1e6),
        }
    };
    measurement.configurations.iter().flat_map(move |m| {
        m.rounds.iter().enumerate().map(move |(index, round)| row(m, &measurement.uniform_rates, index, round))
    })
}

fn milliseconds(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}

/// A column of a Markdown table.
pub struct Column {
    title: String,
    cells: Vec<String>,
}

impl Column {
    /// Text as it is.
    pub fn text(title: &str, cells: impl IntoIterator<Item = String>) -> Self {
        Self { title: title.to_owned(), cells: cells.into_iter().collect() }
    }

    /// Ratios to two digits, with the largest in bold where there are several; a dash where there is none.
    pub fn ratios(title: &str, ratios: &[Option<f64>]) -> Self {
        let best = ratios.iter().flatten().copied().fold(f64::NEG_INFINITY, f64::max);
        let several = ratios.iter().flatten().count() > 1;
        let cell = |ratio: &Option<f64>| match ratio {
            Some(ratio) if several && *ratio == best => format!("**{ratio:.2}**"),
            Some(ratio) => format!("{ratio:.2}"),
            None => "-".into(),
        };
        Self { title: title.to_owned(), cells: ratios.iter().map(cell).collect() }
    }
}

/// A Markdown table of columns of equal length.
pub fn markdown(columns: &[Column]) -> String {
    let width = |column: &Column| {
        column.cells.iter().chain([&column.title]).map(|cell| cell.chars().count()).max().unwrap_or_default()
    };
    let widths: Vec<usize> = columns.iter().map(width).collect();
    let line = |cell: &dyn Fn(usize) -> String| {
        let cells: Vec<_> = widths.iter().enumerate().map(|(i, &width)| format!("{:<width$}", cell(i))).collect();
        format!("| {} |\n", cells.join(" | "))
    };
    let mut text = line(&|i| columns[i].title.clone());
    text += &line(&|i| "-".repeat(widths[i]));
    let rows = columns.iter().map(|column| column.cells.len()).min().unwrap_or_default();
    for row in 0..rows {
        text += &line(&|i| columns[i].cells[row].clone());
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_best_ratio_is_bold() {
        let columns = [
            Column::text("name", ["a", "long name", "c"].map(String::from)),
            Column::ratios("gain", &[Some(1.239), None, Some(2.0)]),
        ];
        assert_eq!(
            markdown(&columns),
            "| name      | gain     |\n\
             | --------- | -------- |\n\
             | a         | 1.24     |\n\
             | long name | -        |\n\
             | c         | **2.00** |\n"
        );
        assert_eq!(Column::ratios("alone", &[None, Some(1.0)]).cells, ["-", "1.00"]);
    }

    #[test]
    fn csv_has_a_header_and_empty_cells() {
        #[derive(Serialize)]
        struct Row {
            name: &'static str,
            value: Option<f64>,
        }
        let rows = [Row { name: "a, b", value: Some(0.5) }, Row { name: "c", value: None }];
        assert_eq!(String::from_utf8(csv(rows).unwrap()).unwrap(), "name,value\n\"a, b\",0.5\nc,\n");
    }
}
