//! What was measured of a scene, as files and as a table to read.

use super::Measured;
use crate::files::Folder;
use crate::tables::{Column, csv, markdown};
use crate::{About, BenchError, SceneReport};
use raystream_figures::plot::{self, Curve};
use serde::Serialize;

/// A line of `integrators.csv`: one integrator.
#[derive(Serialize)]
struct Row {
    integrator: String,
    mpaths_per_second: f64,
    gain: f64,
    mrays_per_second: f64,
    tracing_mpaths_per_second: f64,
    memory_bytes: u64,
    mean: f64,
    mean_error: f64,
    z_score: f64,
    identical_share: f64,
}

/// A line of `repetitions.csv`: one render.
#[derive(Serialize)]
struct RepetitionRow {
    integrator: String,
    repetition: usize,
    mpaths_per_second: f64,
    mrays_per_second: f64,
    tracing_mpaths_per_second: f64,
    paths: u64,
    mean: f64,
    mean_error: f64,
}

/// A line of `lanes.csv`: one iteration over the stream.
#[derive(Serialize)]
struct LanesRow {
    integrator: String,
    iteration: usize,
    active: u64,
    held: u64,
}

/// Writes `integrators.csv`, `repetitions.csv`, `lanes.csv` and `lanes.svg` to `folder`, and
/// returns what to tell of it. `stream` is the number of slots that `measured` was traced with.
pub fn write_scene(
    measured: &[Measured],
    stream: u32,
    about: &About,
    folder: &Folder,
) -> Result<SceneReport, BenchError> {
    let rows: Vec<Row> = measured.iter().map(|m| row(m, &measured[0], stream)).collect();
    folder.write("integrators.csv", &csv(&rows)?)?;
    folder.write("repetitions.csv", &csv(measured.iter().flat_map(repetition_rows))?)?;
    folder.write("lanes.csv", &csv(measured.iter().flat_map(lanes_rows))?)?;
    let title = format!("{}: paths under way, a stream of {stream}", about.label);
    let curves: Vec<Curve> = measured.iter().flat_map(curves).collect();
    folder.write(
        "lanes.svg",
        &plot::lines(&title, "iteration, a segment each", "million paths", &curves)?,
    )?;

    let mut tables = about.heading();
    tables += "\n";
    tables += &markdown(&columns(&rows));
    let section = format!("{tables}\n![lanes]({}/lanes.svg)\n", about.folder());
    Ok(SceneReport { tables, section })
}

fn row(measured: &Measured, first: &Measured, stream: u32) -> Row {
    let speed = measured.median(|speed| speed.mpaths_per_second);
    let (mean, mean_error) = measured.mean();
    Row {
        integrator: measured.integrator.to_string(),
        mpaths_per_second: speed,
        gain: speed / first.median(|speed| speed.mpaths_per_second),
        mrays_per_second: measured.median(|speed| speed.mrays_per_second),
        tracing_mpaths_per_second: measured.median(tracing_speed),
        memory_bytes: measured.memory,
        mean,
        mean_error,
        z_score: measured.z_score(first),
        identical_share: f64::from(measured.identical) / f64::from(stream),
    }
}

/// Millions of paths by second of tracing on the device's own clock.
fn tracing_speed(speed: &crate::paths::PathSpeed) -> f64 {
    speed.outcome.paths as f64 / speed.outcome.timings.tracing().as_secs_f64().max(1e-9) / 1e6
}

fn repetition_rows(measured: &Measured) -> impl Iterator<Item = RepetitionRow> {
    measured.speeds.iter().zip(1..).map(|(speed, repetition)| RepetitionRow {
        integrator: measured.integrator.to_string(),
        repetition,
        mpaths_per_second: speed.mpaths_per_second,
        mrays_per_second: speed.mrays_per_second,
        tracing_mpaths_per_second: tracing_speed(speed),
        paths: speed.outcome.paths,
        mean: speed.mean,
        mean_error: speed.mean_error,
    })
}

fn lanes_rows(measured: &Measured) -> impl Iterator<Item = LanesRow> {
    measured.lanes.iter().zip(1..).map(|(lanes, iteration)| LanesRow {
        integrator: measured.integrator.to_string(),
        iteration,
        active: lanes.active,
        held: lanes.held,
    })
}

/// The paths under way and, where others are held up by them, the lanes.
fn curves(measured: &Measured) -> Vec<Curve> {
    let points = |lanes: fn(&super::Lanes) -> u64| {
        measured
            .lanes
            .iter()
            .zip(1_u32..)
            .map(|(l, k)| (f64::from(k), lanes(l) as f64 / 1e6))
            .collect::<Vec<_>>()
    };
    let paths = (measured.integrator.to_string(), points(|l| l.active));
    let waits = measured.lanes.iter().any(|lanes| lanes.held > lanes.active);
    let held =
        (format!("{}, with lanes that wait", measured.integrator.name()), points(|l| l.held));
    if waits { vec![paths, held] } else { vec![paths] }
}

fn columns(rows: &[Row]) -> Vec<Column> {
    let column =
        |title: &str, cell: &dyn Fn(&Row) -> String| Column::text(title, rows.iter().map(cell));
    vec![
        column("integrator", &|r| r.integrator.clone()),
        column("Mpaths/s", &|r| format!("{:.2}", r.mpaths_per_second)),
        Column::ratios("gain", &rows.iter().map(|r| Some(r.gain)).collect::<Vec<_>>()),
        column("Mrays/s", &|r| format!("{:.2}", r.mrays_per_second)),
        column("Mpaths/s of tracing alone", &|r| format!("{:.2}", r.tracing_mpaths_per_second)),
        column("device memory", &|r| {
            format!("{:.1} MiB", r.memory_bytes as f64 / f64::from(1 << 20))
        }),
        column("mean radiance", &|r| format!("{:.6} +- {:.1e}", r.mean, r.mean_error)),
        column("z", &|r| format!("{:.2}", r.z_score)),
        column("identical slots", &|r| format!("{:.4} %", 100.0 * r.identical_share)),
    ]
}
