//! `render --integrator` and `bench integrators`, on tiny pictures.

use crate::program::{csv, names, run};
use std::collections::BTreeMap;

const ALL: [&str; 4] = ["megakernel", "compaction", "regeneration", "streaming"];

#[test]
fn every_integrator_renders_the_same_picture() {
    let folder = tempfile::tempdir().unwrap();
    let picture = |integrator: &str| {
        let file = format!("{integrator}.exr");
        let tiny = "render --device cpu --size 24x16 --spp 8 --initial-spp 2 --round-budget 2";
        run(folder.path(), &format!("{tiny} --integrator {integrator} -o {file}")).succeeded();
        let path = folder.path().join(file);
        let settings = raystream::image::read_settings(&path).unwrap();
        assert_eq!(settings["integrator"], integrator);
        raystream::image::read_color(&path).unwrap()
    };
    let [expected, others @ ..] = ALL.map(picture);
    for (name, other) in ALL[1..].iter().zip(others) {
        assert_eq!(other, expected, "{name}");
    }
    run(folder.path(), "render --device cpu --integrator photons").failed(&[
        "--integrator",
        "photons",
        "streaming",
    ]);
}

#[test]
fn everything_is_measured() {
    let folder = tempfile::tempdir().unwrap();
    let tiny = "bench integrators cornell_ball@24x16 --device cpu --time 0.05 --repetitions 2 \
                --stream 1000 --output out";
    let stdout =
        run(folder.path(), tiny).succeeded().says(&["streaming, 2 of 2", "out/report.md"]).stdout;
    let out = folder.path().join("out");
    assert_eq!(names(&out), ["cornell_ball@24x16", "report.md"]);
    let scene = out.join("cornell_ball@24x16");
    assert_eq!(names(&scene), ["integrators.csv", "lanes.csv", "lanes.svg", "repetitions.csv"]);
    let rows = csv(&scene.join("integrators.csv"));
    assert_eq!(rows.iter().map(|row| row["integrator"].as_str()).collect::<Vec<_>>(), ALL);
    for row in &rows {
        let number = |name: &str| row[name].parse::<f64>().unwrap();
        assert_eq!(number("identical_share"), 1.0, "{row:?}");
        assert!(
            number("z_score").abs() < 5.0 && number("mean") > 0.0 && number("mean_error") > 0.0,
            "{row:?}"
        );
        assert!(
            number("mpaths_per_second") > 0.0
                && number("mrays_per_second") > number("mpaths_per_second"),
            "{row:?}"
        );
        assert!(stdout.contains(&row["integrator"]), "{stdout}");
    }
    let memory = |row: usize| rows[row]["memory_bytes"].parse::<u64>().unwrap();
    // The pools: as large as a stream may be, and a quarter of that.
    assert!(memory(1) - memory(0) > 700 << 20 && memory(3) - memory(0) > 150 << 20, "{rows:?}");
    assert_eq!(csv(&scene.join("repetitions.csv")).len(), 2 * ALL.len());

    let mut segments: BTreeMap<String, u64> = BTreeMap::new();
    for row in csv(&scene.join("lanes.csv")) {
        let number = |name: &str| row[name].parse::<u64>().unwrap();
        assert!(number("held") >= number("active") && number("held") <= 1000, "{row:?}");
        *segments.entry(row["integrator"].clone()).or_default() += number("active");
    }
    // The segments of all paths are as many, counted on the device or by the paths' lengths.
    assert_eq!(segments.len(), ALL.len());
    assert!(
        segments.values().all(|&count| count == segments["megakernel"] && count > 1000),
        "{segments:?}"
    );
    let plot = std::fs::read_to_string(scene.join("lanes.svg")).unwrap();
    for part in ALL.iter().chain(&["lanes that wait", "iteration"]) {
        assert!(plot.contains(part), "{part} is not in the plot");
    }
    let report = std::fs::read_to_string(out.join("report.md")).unwrap();
    assert!(
        report.contains("cornell_ball@24x16/lanes.svg") && report.contains("identical slots"),
        "{report}"
    );
}

#[test]
fn some_are_measured() {
    let folder = tempfile::tempdir().unwrap();
    let tiny = "bench integrators cornell_ball@16x12 --device cpu --time 0.02 --repetitions 1 \
                --stream 100 --quiet";
    for (arguments, expected) in [
        ("--integrators streaming,megakernel", "streaming"),
        ("--integrator compaction", "compaction"),
    ] {
        let run = run(folder.path(), &format!("{tiny} {arguments} --output out")).succeeded();
        assert_eq!(run.stderr, "");
        let rows = csv(&folder.path().join("out/cornell_ball@16x12/integrators.csv"));
        assert_eq!(
            rows.iter().map(|row| row["integrator"].as_str()).collect::<Vec<_>>(),
            ["megakernel", expected]
        );
    }
}

#[test]
fn arguments_that_are_wrong() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("file"), b"").unwrap();
    for (arguments, parts) in [
        ("--integrators all", &["--integrators", "streaming"][..]),
        ("--integrators streaming --integrator compaction", &["--integrators", "--integrator"]),
        ("--time 0", &["--time"]),
        ("--repetitions 0", &["--repetitions"]),
        ("--stream 0", &["--stream"]),
        ("--stream 5000000", &["--stream", "4194304"]),
        ("no_such_scene", &["no_such_scene", "cornell_ball"]),
        ("cornell_ball@0x0", &["cornell_ball@0x0"]),
        ("cornell_ball cornell_ball", &["cornell_ball", "once"]),
        ("--output file", &["file", "folder"]),
    ] {
        run(folder.path(), &format!("bench integrators --device cpu {arguments}")).failed(parts);
        assert_eq!(names(folder.path()), ["file"], "after {arguments}");
    }
}
