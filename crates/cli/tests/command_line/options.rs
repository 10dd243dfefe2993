//! Options that are wrong, and their descriptions.

use crate::program::{names, run};

#[test]
fn options_that_are_wrong() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, parts) in [
        ("render --device voodoo", &["voodoo", "cpu"][..]),
        ("render --device voodoo:2", &["voodoo:2", "cpu"]),
        ("render --device=", &["--device"]),
        ("render --device cpu --spp 0", &["--spp", "1.."]),
        ("render --device cpu --spp 99999999999", &["--spp"]),
        ("render --device cpu --spp many", &["--spp", "many"]),
        ("render --device cpu --time -1", &["-1"]),
        ("render --device cpu --time=-1", &["--time", "between 0"]),
        ("render --device cpu --time 0", &["--time", "between 0"]),
        ("render --device cpu --time NaN", &["--time", "between 0"]),
        ("render --device cpu --time inf", &["--time", "between 0"]),
        ("render --device cpu --size 0x10", &["--size", "width", "from 1 to"]),
        ("render --device cpu --size 10x0", &["--size", "height", "from 1 to"]),
        ("render --device cpu --size 10x99999", &["--size", "height", "from 1 to"]),
        ("render --device cpu --size -5x5", &["-5"]),
        ("render --device cpu --size 10", &["--size", "WIDTHxHEIGHT"]),
        ("render --device cpu --size axb", &["--size", "WIDTHxHEIGHT"]),
        ("render --device cpu --size 1x2x3", &["--size", "WIDTHxHEIGHT"]),
        ("render --device cpu --size 99999999999999999999x1", &["--size", "WIDTHxHEIGHT"]),
        ("render --device cpu --max-depth 0", &["--max-depth", "1.."]),
        ("render --device cpu --rr-depth 0", &["--rr-depth", "1.."]),
        ("render --device cpu --seed -1", &["-1"]),
        ("render --device cpu --exposure nan", &["--exposure", "stops"]),
        ("render --device cpu --sampler halton", &["--sampler", "sobol"]),
        ("render --device cpu --integrator bdpt", &["--integrator", "lvc"]),
        ("render --device cpu --light-paths 0", &["--light-paths", "1.."]),
        ("render --device cpu --light-paths 99999999", &["--light-paths", "1.."]),
        ("render --device cpu --light-paths many", &["--light-paths", "many"]),
        ("render --device cpu --connections 0", &["--connections", "1..=64"]),
        ("render --device cpu --connections 65", &["--connections", "1..=64"]),
        ("render --device cpu --connections=-1", &["--connections", "-1"]),
        (
            "render --device cpu --integrator lvc --light-paths 4000000 --max-depth 9999",
            &["--light-paths", "--max-depth"],
        ),
        ("render --device cpu --unknown", &["--unknown"]),
        ("bench rays --device cpu --repetitions 0", &["--repetitions"]),
        ("bench paths --device cpu --time 0", &["--time"]),
        ("compare a.png", &["REFERENCE"]),
        ("frobnicate", &["frobnicate"]),
    ] {
        run(folder.path(), arguments).failed(parts);
        assert_eq!(names(folder.path()), [""; 0], "after {arguments}");
    }
}

#[test]
fn the_help_of_every_command() {
    let folder = tempfile::tempdir().unwrap();
    let settings = [
        "--size",
        "--seed",
        "--sampler",
        "--max-depth",
        "--rr-depth",
        "--integrator",
        "--light-paths",
        "--connections",
        "--no-light-tracing",
        "--bvh",
        "--device",
    ];
    let render =
        ["--output", "--spp", "[default: 64", "--time", "--exposure", "--tone-map", "--quiet"];
    let convergence = [
        "--allocators",
        "--estimators",
        "--errors",
        "--spp",
        "--levels",
        "--repetitions",
        "--reference-spp",
        "--cache",
        "--output",
        "--quiet",
    ];
    for (command, options) in [
        ("", &["render", "compare", "devices", "scenes", "bench"][..]),
        ("render", &[&settings[..], &render].concat()),
        ("compare", &["--output", "--gain", "--json", "--reference-samples"]),
        ("devices", &["--naga", "--validation"]),
        ("scenes", &["--verbose"]),
        ("bench", &["rays", "paths", "convergence"]),
        ("bench rays", &[&settings[..], &["--repetitions", "--checks"]].concat()),
        ("bench paths", &[&settings[..], &["--time"]].concat()),
        ("bench convergence", &[&settings[..], &convergence].concat()),
    ] {
        let help = run(folder.path(), &format!("{command} --help")).succeeded().stdout;
        for option in options {
            assert!(
                help.contains(option),
                "the help of {command} does not mention {option}:\n{help}"
            );
        }
    }
}

#[test]
fn the_version() {
    let folder = tempfile::tempdir().unwrap();
    let version = run(folder.path(), "--version").succeeded().stdout;
    assert_eq!(version, format!("raystream {}\n", env!("CARGO_PKG_VERSION")));
}

const TINY: &str = "render --device cpu --size 4x3 --spp 1 -q -o a.exr";

#[test]
fn options_without_effect_are_said() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, option) in [
        ("--estimator variance --allocator uniform", "--estimator"),
        ("--relative --allocator uniform", "--relative"),
        ("--initial-spp 3 --allocator uniform", "--initial-spp"),
        ("--filter-radius 2 --estimator halves", "--filter-radius"),
        ("--filter-features-only --allocator uniform", "--filter-features-only"),
        ("--no-smoothing", "--no-smoothing"),
        ("--halves", "--halves"),
        ("--light-paths 100", "--light-paths"),
        ("--no-light-tracing --integrator megakernel", "--no-light-tracing"),
        ("--exposure 2", "--exposure"),
        ("--tone-map aces", "--tone-map"),
        ("--validation", "--validation"),
        ("--naga", "--naga"),
        ("--exact", "--exact"),
    ] {
        let run = run(folder.path(), &format!("{TINY} {arguments}")).succeeded();
        let warning = format!("warning: {option} has no effect ");
        assert!(run.stderr.starts_with(&warning), "{arguments}: {:?}", run.stderr);
        assert_eq!(run.stderr.lines().count(), 1, "{:?}", run.stderr);
    }
    for arguments in [
        "--estimator variance --relative --no-smoothing",
        "--estimator halves --allocator uniform",
        "--filter-radius 2 --initial-spp 3 --round-budget 1",
        "--halves --allocator uniform",
        "--light-paths 100 --connections 1 --no-light-tracing --integrator lvc",
        "-o a.png --exposure 2 --tone-map aces --png-layers",
        "--seed 4294967295 --sampler independent --max-depth 3 --rr-depth 2 --bvh fast",
    ] {
        let run = run(folder.path(), &format!("{TINY} {arguments}")).succeeded();
        assert_eq!(run.stderr, "", "{arguments}");
    }
}

#[test]
fn other_commands_say_it_too() {
    let folder = tempfile::tempdir().unwrap();
    run(folder.path(), TINY).succeeded();
    let says = |arguments: &str, option: &str| {
        let warning = format!("warning: {option} has no effect ");
        run(folder.path(), arguments).succeeded().says(&[&warning]);
    };
    says("compare a.exr a.exr --gain 2", "--gain");
    let size = "--device cpu --size 4x3";
    says(&format!("bench rays {size} --repetitions 1 --checks 1 --max-depth 2"), "--max-depth");
    says(&format!("bench paths {size} --time 0.01 --connections 1"), "--connections");
    let convergence =
        "bench convergence cornell_ball@4x3 --device cpu --spp 1 --repetitions 1 --cache c -q";
    says(&format!("{convergence} --allocators uniform --errors relative"), "--errors");
}

#[test]
fn threads_can_be_limited() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, said) in
        [("devices --threads 3", "3 threads"), ("--threads 1 devices", "1 threads")]
    {
        let devices = run(folder.path(), arguments).succeeded().stdout;
        assert!(devices.contains(said), "{devices}");
    }
    run(folder.path(), &format!("{TINY} --threads 1")).succeeded();
    run(folder.path(), "compare a.exr a.exr --threads 2").succeeded();
    run(folder.path(), "devices --threads 0").failed(&["--threads", "1..=4096"]);
}
