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
