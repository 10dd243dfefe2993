//! Everything that was measured of a scene, as files and as tables to read.

use super::gains::Speedup;
use super::metric::Metric;
use super::pictures::{self, Pictures};
use super::reference::Reference;
use super::rounds::{Breakdown, millions_per_second, parts};
use super::speedup::{Comparisons, REFERENCE_MARGIN, SMALLEST_FROM, uniform_counterpart};
use super::tables::{curve_rows, round_rows};
use super::{Measured, Measurement, Plan};
use crate::files::Folder;
use crate::tables::{Column, csv, markdown};
use crate::{About, BenchError, SceneReport};
use raystream::exec::Executor;
use raystream::render::{AllocatorKind, PreparedScene, Settings};
use raystream_figures::plot::{self, Curve};

/// Writes `curves.csv`, `rounds.csv`, `speedups.csv`, `equal_time.csv`, `smallest.csv`, the plots
/// and the pictures of a scene to `folder`, and returns what to tell of it.
pub fn write_scene<E: Executor>(
    executor: &E,
    scene: &PreparedScene,
    settings: &Settings,
    plan: &Plan,
    reference: &Reference,
    measurement: &Measurement,
    about: &About,
    folder: &Folder,
) -> Result<SceneReport, BenchError> {
    let noise = reference.noise();
    let comparisons = Comparisons::of(&measurement.configurations, &plan.levels, noise);
    folder.write("curves.csv", &csv(curve_rows(measurement, noise))?)?;
    folder.write("rounds.csv", &csv(round_rows(measurement))?)?;
    folder.write("speedups.csv", &csv(&comparisons.speedups)?)?;
    folder.write("equal_time.csv", &csv(&comparisons.equal_time)?)?;
    folder.write("smallest.csv", &csv(&comparisons.smallest)?)?;
    let breakdowns: Vec<(String, Breakdown)> = measurement
        .configurations
        .iter()
        .filter_map(|m| {
            Some((m.name.clone(), Breakdown::of(&m.rounds, measurement.uniform_rates(m)?)))
        })
        .collect();
    write_plots(measurement, &breakdowns, about, folder)?;
    let pictures = pictures::write(
        executor,
        scene,
        settings,
        plan,
        reference,
        measurement,
        &folder.folder(PICTURES)?,
    )?;

    let mut tables = about.heading();
    tables += &format!(
        "- reference: {} samples per pixel by {}, RMSE {noise:.2e} by its halves; errors below \
         {REFERENCE_MARGIN} times that are limited by it\n",
        reference.samples,
        reference.integrator.name()
    );
    for mean in &measurement.means {
        tables += &format!("- {mean}\n");
    }
    for warning in &measurement.warnings {
        tables += &format!("- **warning**: {warning}\n");
    }
    tables += &summary(measurement, &comparisons, &plan.levels, &breakdowns);
    let section = format!("{tables}\n{}", illustrations(&about.folder(), pictures.as_ref()));
    Ok(SceneReport { tables, section })
}

/// The folder of the pictures, in that of the scene.
const PICTURES: &str = "equal-time";

fn write_plots(
    measurement: &Measurement,
    breakdowns: &[(String, Breakdown)],
    about: &About,
    folder: &Folder,
) -> Result<(), BenchError> {
    let curves = |metric: Metric, x: fn(&super::Point) -> f64| -> Vec<Curve> {
        let points = |m: &Measured| m.curve.iter().map(|p| (x(p), metric.of(p))).collect();
        measurement.configurations.iter().map(|m| (m.name.clone(), points(m))).collect()
    };
    let seconds = |p: &super::Point| p.wall.as_secs_f64();
    let samples = |p: &super::Point| p.samples;
    for (file, metric, x, x_title) in [
        ("convergence.svg", Metric::Rmse, seconds as fn(&super::Point) -> f64, "time in seconds"),
        ("convergence-trimmed.svg", Metric::TrimmedRmse, seconds, "time in seconds"),
        ("convergence-relative.svg", Metric::RelativeMse, seconds, "time in seconds"),
        ("convergence-samples.svg", Metric::Rmse, samples, "samples per pixel"),
        ("convergence-trimmed-samples.svg", Metric::TrimmedRmse, samples, "samples per pixel"),
    ] {
        let (y_title, curves) = (metric.title(), curves(metric, x));
        folder.write(file, &plot::curves(&about.label, x_title, y_title, &curves)?)?;
    }
    let bars: Vec<plot::Bar> = breakdowns
        .iter()
        .map(|(name, breakdown)| {
            let per_path = |(part, time): (&'static str, std::time::Duration)| {
                (part, time.as_secs_f64() * 1e9 / breakdown.paths.max(1) as f64)
            };
            (name.clone(), parts(&breakdown.timings).map(per_path).into())
        })
        .collect();
    let title = format!("{}: where the time of a path goes", about.label);
    folder
        .write("breakdown.svg", &plot::bars(&title, "device time in nanoseconds per path", &bars)?)
}

/// The tables of a scene.
fn summary(
    measurement: &Measurement,
    comparisons: &Comparisons,
    levels: &[u32],
    breakdowns: &[(String, Breakdown)],
) -> String {
    let mut text = String::new();
    if let [first, others @ ..] = &measurement.configurations[..]
        && !others.is_empty()
    {
        let baseline = &first.name;
        let against_first: Vec<_> =
            others.iter().map(|other| Pair { configuration: other, baseline: first }).collect();
        text += &format!(
            "\nEqual error: the time (and the samples) that `{baseline}` needs, by what each \
             configuration needs; the best in bold. A dash: its curve does not span that error, \
             see `speedups.csv`.\n\n"
        );
        text += &markdown(&equal_error(comparisons, levels, &against_first));
        text +=
            &format!("\nEqual time: the error of `{baseline}`, by that of each configuration.\n\n");
        text += &markdown(&equal_time(comparisons, levels, &against_first));
    }
    let against_own = against_own_uniform(&measurement.configurations);
    if !against_own.is_empty() {
        text += "\nEqual error, each integrator by itself: the time (and the samples) that \
                 uniform sampling with the same integrator needs, by what each configuration \
                 needs; levels are those of that uniform sampling.\n\n";
        text += &markdown(&equal_error(comparisons, levels, &against_own));
    }
    if let Some(columns) = against_atomic(measurement, comparisons, levels) {
        text += "\nEqual error: the time that `atomic` with the same estimator needs, by what \
                 each configuration needs.\n\n";
        text += &markdown(&columns);
    }
    text += "\nRounds, the first of each configuration aside (it is uniform): device time of an \
             average round, tracing rates, and (medians over the rounds) generation and \
             accumulation by tracing, and rates by those of uniform rounds of the same \
             lengths.\n\n";
    text + &markdown(&rounds(breakdowns))
}

/// A configuration and the uniform sampling that it is compared with.
struct Pair<'a> {
    configuration: &'a Measured,
    baseline: &'a Measured,
}

impl Pair<'_> {
    /// Whether a row of these names is about this pair.
    fn is(&self, configuration: &str, baseline: &str) -> bool {
        (&*self.configuration.name, &*self.baseline.name) == (configuration, baseline)
    }
}

/// Each adaptive configuration and uniform sampling with its own integrator; nothing where there is
/// one integrator alone, which makes that the first table.
fn against_own_uniform(configurations: &[Measured]) -> Vec<Pair<'_>> {
    let integrator = |m: &Measured| m.configuration.integrator;
    if configurations.iter().all(|m| integrator(m) == integrator(&configurations[0])) {
        return Vec::new();
    }
    let adaptive = configurations.iter().filter(|m| !m.configuration.is_uniform());
    adaptive
        .filter_map(|m| {
            Some(Pair { configuration: m, baseline: uniform_counterpart(configurations, m)? })
        })
        .collect()
}

/// The titles of the two errors in narrow columns.
fn short(metric: Metric) -> &'static str {
    match metric {
        Metric::Rmse => "",
        Metric::TrimmedRmse => " (trimmed)",
        Metric::RelativeMse => " (relative)",
    }
}

/// The column of the configurations' names.
fn names(pairs: &[Pair<'_>]) -> Column {
    Column::text("configuration", pairs.iter().map(|pair| pair.configuration.name.clone()))
}

fn equal_error(comparisons: &Comparisons, levels: &[u32], pairs: &[Pair<'_>]) -> Vec<Column> {
    let mut columns = vec![names(pairs)];
    let find = |pair: &Pair<'_>, metric, level| -> Option<&Speedup> {
        comparisons.speedups.iter().find(|s| {
            pair.is(&s.configuration, &s.baseline)
                && s.metric == metric
                && s.uniform_samples == level
        })
    };
    for &level in levels {
        for metric in Metric::ALL {
            let times: Vec<_> =
                pairs.iter().map(|pair| find(pair, metric, level)?.time_ratio).collect();
            let samples: Vec<_> =
                pairs.iter().map(|pair| find(pair, metric, level)?.samples_ratio).collect();
            columns.push(Column::ratios(&format!("time at {level} spp{}", short(metric)), &times));
            columns.push(Column::ratios(&format!("samples{}", short(metric)), &samples));
        }
    }
    for metric in Metric::ALL {
        let cell = |pair: &Pair<'_>| {
            let smallest = comparisons
                .smallest
                .iter()
                .find(|s| pair.is(&s.configuration, &s.baseline) && s.metric == metric);
            smallest.map_or_else(String::new, |s| {
                let ratio = s.time_ratio.map_or_else(|| "-".into(), |ratio| format!("{ratio:.2}"));
                format!("{ratio} ({} of {})", s.reached, s.checkpoints)
            })
        };
        let title = format!("smallest beyond {SMALLEST_FROM} spp{}", short(metric));
        columns.push(Column::text(&title, pairs.iter().map(cell)));
    }
    let mean = |pair: &Pair<'_>| {
        pair.configuration
            .curve
            .last()
            .map_or_else(|| "-".into(), |p| format!("{:.4}", p.errors.mean_ratio))
    };
    columns.push(Column::text("mean by reference's", pairs.iter().map(mean)));
    columns
}

fn equal_time(comparisons: &Comparisons, levels: &[u32], pairs: &[Pair<'_>]) -> Vec<Column> {
    let mut columns = vec![names(pairs)];
    for &level in levels {
        for metric in Metric::ALL {
            let find = |pair: &Pair<'_>| {
                comparisons.equal_time.iter().find(|e| {
                    pair.is(&e.configuration, &e.baseline)
                        && e.metric == metric
                        && e.uniform_samples == level
                })
            };
            let seconds = pairs.iter().find_map(find).map_or(0.0, |equal| equal.seconds);
            let ratios: Vec<_> = pairs.iter().map(|pair| find(pair)?.error_ratio).collect();
            columns.push(Column::ratios(
                &format!("{seconds:.3} s, {level} spp{}", short(metric)),
                &ratios,
            ));
        }
    }
    columns
}

fn against_atomic(
    measurement: &Measurement,
    comparisons: &Comparisons,
    levels: &[u32],
) -> Option<Vec<Column>> {
    let atomic = measurement
        .configurations
        .iter()
        .filter(|m| m.configuration.allocator == AllocatorKind::Atomic);
    let atomic: Vec<&str> = atomic.map(|m| &*m.name).collect();
    let rows: Vec<_> =
        comparisons.speedups.iter().filter(|s| atomic.contains(&&*s.baseline)).collect();
    let names: Vec<&str> = measurement.configurations.iter().map(|m| &*m.name).collect();
    let names: Vec<&str> =
        names.into_iter().filter(|name| rows.iter().any(|s| s.configuration == *name)).collect();
    if names.is_empty() {
        return None;
    }
    let mut columns =
        vec![Column::text("configuration", names.iter().map(|&name| name.to_owned()))];
    for &level in levels {
        for metric in Metric::ALL {
            let find = |name: &&str| {
                rows.iter().find(|s| {
                    s.configuration == *name && s.metric == metric && s.uniform_samples == level
                })
            };
            let times: Vec<_> = names.iter().map(|name| find(name)?.time_ratio).collect();
            columns.push(Column::ratios(&format!("time at {level} spp{}", short(metric)), &times));
        }
    }
    Some(columns)
}

fn rounds(breakdowns: &[(String, Breakdown)]) -> Vec<Column> {
    let column = |title: &str, cell: &dyn Fn(&Breakdown) -> Option<String>| {
        Column::text(title, breakdowns.iter().map(|(_, b)| cell(b).unwrap_or_else(|| "-".into())))
    };
    let mut columns = vec![
        Column::text("configuration", breakdowns.iter().map(|(name, _)| name.clone())),
        column("rounds", &|b| Some(b.rounds.to_string())),
    ];
    for (index, (part, _)) in parts(&Default::default()).iter().enumerate() {
        columns.push(column(&format!("{part} ms"), &|b| {
            let (_, time) = parts(&b.timings)[index];
            Some(format!("{:.3}", time.as_secs_f64() * 1e3 / b.rounds.max(1) as f64))
        }));
    }
    let two_digits = |value: Option<f64>| value.map(|value| format!("{value:.2}"));
    columns.push(column("Mpaths/s", &|b| {
        two_digits(millions_per_second(b.paths, b.timings.tracing()))
    }));
    columns
        .push(column("Mrays/s", &|b| two_digits(millions_per_second(b.rays, b.timings.tracing()))));
    columns.push(column("generation + accumulation by tracing", &|b| {
        b.overhead.map(|o| format!("{:.2} %", 100.0 * o))
    }));
    columns.push(column("paths by uniform's", &|b| two_digits(b.paths_ratio)));
    columns.push(column("rays by uniform's", &|b| two_digits(b.rays_ratio)));
    columns
}

/// Plots and pictures.
fn illustrations(folder: &str, pictures: Option<&Pictures>) -> String {
    let mut text = String::new();
    for plot in [
        "convergence",
        "convergence-trimmed",
        "convergence-samples",
        "convergence-trimmed-samples",
        "breakdown",
    ] {
        text += &format!("![{plot}]({folder}/{plot}.svg)\n\n");
    }
    let Some(Pictures { seconds, brightest, pictures }) = pictures else { return text };
    text += &format!(
        "After {seconds:.3} s, the time of the first level: pictures, and squared errors from 0 \
         to {brightest:.3e}.\n\n"
    );
    let link = |name: &str| format!("![{name}]({folder}/{PICTURES}/{name}.png)");
    text + &markdown(&[
        Column::text("configuration", pictures.iter().map(|p| p.name.clone())),
        Column::text("samples per pixel", pictures.iter().map(|p| format!("{:.2}", p.samples))),
        Column::text("RMSE", pictures.iter().map(|p| format!("{:.3e}", p.errors.rmse))),
        Column::text("trimmed", pictures.iter().map(|p| format!("{:.3e}", p.errors.trimmed_rmse))),
        Column::text("picture", pictures.iter().map(|p| link(&p.name))),
        Column::text("squared error", pictures.iter().map(|p| link(&format!("{}-error", p.name)))),
    ])
}
