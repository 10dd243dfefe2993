//! `bench convergence` on a tiny picture.

use crate::program::{Row, Run, csv, names, run};
use std::collections::BTreeMap;
use std::path::Path;

const TINY: &str = "bench convergence cornell_ball@16x12 --device cpu --spp 8 --levels 4 \
                    --reference-spp 32 --repetitions 1 --allocators runs --cache cache \
                    --output out";

fn tiny(folder: &Path) -> Run {
    run(folder, TINY).succeeded()
}

#[test]
fn everything_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let stdout = tiny(folder.path())
        .says(&["rendering the reference by auto with 32", "uniform, 1 of 1"])
        .stdout;
    assert!(
        stdout.contains("## cornell_ball@16x12") && stdout.contains("runs-bilateral"),
        "{stdout}"
    );
    let out = folder.path().join("out");
    assert_eq!(names(&out), ["cornell_ball@16x12", "report.md"]);
    let scene = out.join("cornell_ball@16x12");
    let files = [
        "breakdown.svg",
        "convergence-relative.svg",
        "convergence-samples.svg",
        "convergence-trimmed-samples.svg",
        "convergence-trimmed.svg",
        "convergence.svg",
        "curves.csv",
        "equal-time",
        "equal_time.csv",
        "rounds.csv",
        "smallest.csv",
        "speedups.csv",
    ];
    assert_eq!(names(&scene), files);
    assert_pictures(&scene.join("equal-time"));
    assert_curves(&csv(&scene.join("curves.csv")));

    let rounds = csv(&scene.join("rounds.csv"));
    assert_eq!(rounds.iter().filter(|row| row["configuration"] == "uniform").count(), 6);
    assert!(rounds.iter().all(|row| number(row, "tracing_ms") > 0.0));
    let speedups = csv(&scene.join("speedups.csv"));
    assert_eq!(speedups.len(), 3, "one level: all pixels, without the worst, and relative");
    assert!(
        speedups.iter().all(|row| row["uniform_samples"] == "4" && row["baseline"] == "uniform")
    );
    let report = std::fs::read_to_string(out.join("report.md")).unwrap();
    for part in
        ["runs-bilateral", "cornell_ball@16x12/convergence.svg", "equal-time/uniform-error.png"]
    {
        assert!(report.contains(part), "{part} is not in {report}");
    }
}

/// Asserts that pictures have the size of the scene's, and those of errors a legend beside it.
fn assert_pictures(folder: &Path) {
    let size = |picture: &str| {
        let picture = raystream::image::read_color(&folder.join(picture)).unwrap();
        (picture.width, picture.height)
    };
    assert_eq!([size("reference.png"), size("uniform.png")], [(16, 12); 2]);
    let (width, height) = size("uniform-error.png");
    assert!(width > 16 && height > 12, "there is a legend");
}

/// Asserts that the curve of uniform sampling has its checkpoints in order, and that all have
/// errors.
fn assert_curves(curves: &[Row]) {
    let uniform: Vec<_> = curves.iter().filter(|row| row["configuration"] == "uniform").collect();
    let samples: Vec<_> = uniform.iter().map(|row| number(row, "samples_per_pixel")).collect();
    assert_eq!(samples, [1.0, 2.0, 3.0, 4.0, 6.0, 8.0]);
    for pair in uniform.windows(2) {
        assert!(number(pair[0], "seconds") < number(pair[1], "seconds"));
        assert!(number(pair[0], "rays") < number(pair[1], "rays"));
    }
    for row in curves {
        let (rmse, trimmed) = (number(row, "rmse"), number(row, "trimmed_rmse"));
        // A thousandth of so few pixels is none: both are one, but for the order of their sum.
        assert!(rmse > 0.0 && (trimmed / rmse - 1.0).abs() < 1e-12, "{row:?}");
        assert!((-1.0..1.0).contains(&number(row, "ssim")), "{row:?}");
    }
    assert!(curves.iter().any(|row| row["configuration"] == "runs-bilateral"));
}

fn number(row: &Row, name: &str) -> f64 {
    row[name].parse().unwrap()
}

#[test]
fn the_reference_is_kept_and_checked() {
    let folder = tempfile::tempdir().unwrap();
    tiny(folder.path());
    let cache = folder.path().join("cache");
    let [name] = <[String; 1]>::try_from(names(&cache)).unwrap();
    let path = cache.join(&name);
    let first = raystream::image::read_color(&path).unwrap();

    let again = tiny(folder.path()).says(&["reference from", &name]);
    assert!(!again.stderr.contains("rendering the reference"), "{}", again.stderr);

    let whole = std::fs::read(&path).unwrap();
    std::fs::write(&path, &whole[..whole.len() / 2]).unwrap();
    tiny(folder.path()).says(&[&name, "cannot be used", "rendering the reference again"]);
    assert_eq!(raystream::image::read_color(&path).unwrap(), first);
    tiny(folder.path()).says(&["reference from"]);

    // Pixels of something else, under the header of the reference.
    let layers = raystream::image::read_layers(&path).unwrap();
    let mut header = raystream::image::read_settings(&path).unwrap();
    header.insert("kernels".into(), "others".into());
    let header: Vec<_> = header.into_iter().collect();
    raystream::image::write_layers(&path, &layers, &header).unwrap();
    tiny(folder.path()).says(&["cannot be used", "differs in kernels"]);

    // Another depth is another picture, beside the first.
    run(folder.path(), &format!("{TINY} --max-depth 3"))
        .succeeded()
        .says(&["rendering the reference"]);
    assert_eq!(names(&cache).len(), 2);

    // And so is one by another integrator, whose light paths count.
    let by_lvc = format!("{TINY} --reference-integrator lvc");
    run(folder.path(), &by_lvc).succeeded().says(&["rendering the reference by lvc with 32"]);
    run(folder.path(), &by_lvc).succeeded().says(&["reference from"]);
    run(folder.path(), &format!("{by_lvc} --connections 3"))
        .succeeded()
        .says(&["rendering the reference by lvc"]);
    assert_eq!(names(&cache).len(), 4);
    // They count for no other.
    tiny(folder.path());
    run(folder.path(), &format!("{TINY} --connections 3")).succeeded().says(&["reference from"]);
    assert_eq!(names(&cache).len(), 4);
}

#[test]
fn filters_are_measured_with_everything() {
    let folder = tempfile::tempdir().unwrap();
    run(folder.path(), &format!("{TINY} --filters nlm,bilateral")).succeeded();
    let scene = folder.path().join("out/cornell_ball@16x12");
    let curves = csv(&scene.join("curves.csv"));
    let end = |name: &str| {
        let rows = curves.iter().filter(|row| row["configuration"] == name);
        rows.max_by_key(|row| row["checkpoint"].parse::<u32>().unwrap()).unwrap()
    };
    for sampling in ["uniform", "runs-bilateral"] {
        let plain = end(sampling);
        assert_eq!(number(plain, "reconstruction_seconds"), 0.0);
        for filter in ["nlm", "bilateral"] {
            let filtered = end(&format!("{sampling}+{filter}"));
            assert_eq!(filtered["samples_per_pixel"], plain["samples_per_pixel"]);
            assert!(number(filtered, "reconstruction_seconds") > 0.0, "{filtered:?}");
            assert!(number(filtered, "rmse") != number(plain, "rmse"), "{filtered:?}");
        }
    }
    let speedups = csv(&scene.join("speedups.csv"));
    let metrics = speedups.iter().filter(|row| row["configuration"] == "uniform+nlm");
    let metrics: Vec<_> = metrics.map(|row| (&*row["metric"], &*row["baseline"])).collect();
    let expected = ["rmse", "trimmed_rmse", "relative_mse"].map(|metric| (metric, "uniform"));
    assert_eq!(metrics, expected);
}

#[test]
fn integrators_are_set_against_each_other() {
    let folder = tempfile::tempdir().unwrap();
    let command = "bench convergence cornell_ball@16x12 --device cpu --integrators streaming,lvc \
                   --reference-integrator lvc --spp 16 --levels 4,8 --initial-spp 2 \
                   --reference-spp 32 --repetitions 2 --allocators runs,atomic --cache cache \
                   --output out";
    let stdout = run(folder.path(), command)
        .succeeded()
        .says(&[
            "rendering the reference by lvc with 32",
            "streaming-uniform, 2 of 2",
            "lvc-runs-bilateral, 1 of 2",
        ])
        .stdout;
    for part in [
        "integrators: streaming, lvc\n",
        "32 samples per pixel by lvc",
        "mean of streaming-uniform: at most",
        "mean of lvc-uniform: at most",
        "the spread of 32 rounds",
        "that `streaming-uniform` needs",
        "each integrator by itself",
    ] {
        assert!(stdout.contains(part), "{part} is not in {stdout}");
    }
    let scene = folder.path().join("out/cornell_ball@16x12");
    let all = [
        "streaming-uniform",
        "streaming-runs-bilateral",
        "streaming-atomic-bilateral",
        "lvc-uniform",
        "lvc-runs-bilateral",
        "lvc-atomic-bilateral",
    ];
    for file in ["curves.csv", "rounds.csv"] {
        let rows = csv(&scene.join(file));
        let mut configurations: Vec<_> = rows.iter().map(|row| &row["configuration"]).collect();
        configurations.dedup();
        assert_eq!(configurations, all, "{file}");
    }
    assert_compared(&scene);
    let plot = std::fs::read_to_string(scene.join("convergence.svg")).unwrap();
    assert!(all.iter().all(|name| plot.contains(name)), "{plot}");
    assert!(names(&scene.join("equal-time")).contains(&"streaming-uniform.png".to_owned()));
}

/// Asserts that each is compared with what it should be, at two levels and by two errors.
fn assert_compared(scene: &Path) {
    let mut pairs = BTreeMap::new();
    for row in csv(&scene.join("speedups.csv")) {
        *pairs.entry((row["configuration"].clone(), row["baseline"].clone())).or_insert(0) += 1;
    }
    let expected = [
        ("lvc-atomic-bilateral", "lvc-uniform"),
        ("lvc-atomic-bilateral", "streaming-uniform"),
        ("lvc-runs-bilateral", "lvc-atomic-bilateral"),
        ("lvc-runs-bilateral", "lvc-uniform"),
        ("lvc-runs-bilateral", "streaming-uniform"),
        ("lvc-uniform", "streaming-uniform"),
        ("streaming-atomic-bilateral", "streaming-uniform"),
        ("streaming-runs-bilateral", "streaming-atomic-bilateral"),
        ("streaming-runs-bilateral", "streaming-uniform"),
    ];
    let expected: BTreeMap<_, _> = expected.map(|(a, b)| ((a.to_owned(), b.to_owned()), 6)).into();
    assert_eq!(pairs, expected);
    for file in ["equal_time.csv", "smallest.csv"] {
        let rows = csv(&scene.join(file));
        assert!(
            rows.iter().any(|row| row["configuration"] == "lvc-runs-bilateral"
                && row["baseline"] == "lvc-uniform")
        );
        assert!(rows.iter().all(|row| row["baseline"].ends_with("-uniform")), "{rows:?}");
    }
}

#[test]
fn one_integrator_is_in_no_name() {
    let folder = tempfile::tempdir().unwrap();
    run(folder.path(), &format!("{TINY} --integrators lvc,lvc"))
        .succeeded()
        .says(&["rendering the reference by auto", "uniform, 1 of 1"]);
    let scene = folder.path().join("out/cornell_ball@16x12");
    let speedups = csv(&scene.join("speedups.csv"));
    assert!(
        speedups
            .iter()
            .all(|row| row["configuration"] == "runs-bilateral" && row["baseline"] == "uniform")
    );
    let report = std::fs::read_to_string(folder.path().join("out/report.md")).unwrap();
    assert!(
        report.contains("integrator: lvc\n") && !report.contains("each integrator by itself"),
        "{report}"
    );
}

#[test]
fn scenes_that_ship_are_taken_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let small = "--device cpu --spp 4 --levels 2 --reference-spp 16 --repetitions 1 \
                 --allocators uniform --cache cache --output out";
    let scenes = "opening@16x12 caustics@12x12";
    run(
        folder.path(),
        &format!(
            "bench convergence {scenes} --integrators megakernel,lvc \
             --reference-integrator lvc {small}"
        ),
    )
    .succeeded();
    assert_eq!(names(&folder.path().join("out")), ["caustics@12x12", "opening@16x12", "report.md"]);
}

#[test]
fn arguments_that_are_wrong() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("file"), b"").unwrap();
    for (arguments, parts) in [
        ("--spp 8 --levels 4,16", &["--levels 16", "8 samples", "raise --spp"][..]),
        ("--levels 0", &["--levels", "1.."]),
        ("--levels some", &["--levels", "some"]),
        ("--spp 0", &["--spp"]),
        ("--spp 1000000", &["--spp"]),
        ("--repetitions 0", &["--repetitions"]),
        ("--reference-spp 3", &["--reference-spp", "4.."]),
        ("--integrators streaming,photons", &["--integrators", "photons", "lvc"]),
        ("--integrators ,", &["--integrators"]),
        ("--reference-integrator photons", &["--reference-integrator", "photons", "lvc"]),
        ("--reference-integrator streaming,lvc", &["--reference-integrator", "streaming,lvc"]),
        ("--allocators all", &["--allocators", "runs"]),
        ("--estimators guess", &["--estimators", "bilateral"]),
        ("--errors squared", &["--errors", "relative"]),
        ("no_such_scene", &["no_such_scene", "cornell_ball"]),
        ("missing.json", &["missing.json"]),
        ("cornell_ball@600", &["cornell_ball@600", "WIDTHxHEIGHT"]),
        ("cornell_ball cornell_ball", &["cornell_ball", "once"]),
        ("--seed 1919247974", &["--seed", "reference"]),
        ("--cache . --output file", &["file", "folder"]),
        ("--cache . --output file/below", &["file/below", "folder"]),
        ("--cache file", &["file", "folder"]),
    ] {
        run(folder.path(), &format!("bench convergence --device cpu {arguments}")).failed(parts);
        assert_eq!(names(folder.path()), ["file"], "after {arguments}");
    }
}
