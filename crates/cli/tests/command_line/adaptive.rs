//! Adaptive sampling by options.

use crate::program::{names, render, run};
use raystream::image::{LayeredImage, read_layers, read_settings};
use std::path::Path;

const OPTIONS: [&str; 12] = [
    "--allocator",
    "--estimator",
    "--relative",
    "--initial-spp",
    "--round-budget",
    "--noise",
    "--filter-radius",
    "--filter-position",
    "--filter-normal",
    "--filter-albedo",
    "--filter-features-only",
    "--no-smoothing",
];

/// Renders with `arguments`; the layers and what the header says of each setting.
#[track_caller]
fn layers(
    folder: &Path,
    arguments: &str,
) -> (LayeredImage, impl Fn(&str) -> Option<String> + use<>) {
    render(folder, &format!("{arguments} -o x.exr")).succeeded();
    let path = folder.join("x.exr");
    let settings = read_settings(&path).unwrap();
    let setting = move |name: &str| {
        let suffix = format!(".{name}");
        settings
            .iter()
            .find(|(key, _)| *key == name || key.ends_with(&suffix))
            .map(|(_, value)| value.clone())
    };
    (read_layers(&path).unwrap(), setting)
}

#[test]
fn every_allocator_writes_its_layers_and_settings() {
    let folder = tempfile::tempdir().unwrap();
    for allocator in ["uniform", "paper", "atomic", "runs"] {
        for estimator in ["bilateral", "halves", "variance"] {
            let arguments = format!(
                "--allocator {allocator} --estimator {estimator} --relative --initial-spp 2 \
                 --round-budget 1.5 --spp 8 --size 16x12"
            );
            let (image, setting) = layers(folder.path(), &arguments);
            let adaptive = allocator != "uniform";
            for name in ["filtered.R", "filtered.G", "filtered.B", "error.V"] {
                let channel = image.channel(name);
                assert_eq!(channel.is_some(), adaptive, "{name} of {arguments}");
                assert!(
                    channel.is_none_or(|values| values.iter().all(|v| v.is_finite())),
                    "{name} of {arguments}"
                );
            }
            let samples = image.channel("samples.N").expect("every render has sample counts");
            assert_eq!(samples.iter().sum::<f32>(), 8.0 * 16.0 * 12.0, "{arguments}");
            assert_eq!(samples.iter().any(|&n| n != 8.0), adaptive, "{arguments}");

            assert_eq!(setting("allocator").as_deref(), Some(allocator));
            assert_eq!(setting("samples").as_deref(), Some("8"));
            for (name, value) in [
                ("estimator", estimator),
                ("relative", "true"),
                ("initial_spp", "2"),
                ("round_budget", "1.5"),
            ] {
                assert_eq!(
                    setting(name).as_deref(),
                    adaptive.then_some(value),
                    "{name} of {arguments}"
                );
            }
            assert_eq!(setting("noise"), None);
        }
    }
}

#[test]
fn the_noise_ends_a_render() {
    let folder = tempfile::tempdir().unwrap();
    for allocator in ["uniform", "paper", "atomic", "runs"] {
        let (image, setting) =
            layers(folder.path(), &format!("--allocator {allocator} --noise 0.5 --size 16x12"));
        assert_eq!(setting("noise").as_deref(), Some("0.5"));
        assert!(image.channel("error.V").is_some(), "{allocator} has estimated errors");
    }
    // With --spp, what comes first.
    let (image, _) = layers(folder.path(), "--noise 0.00001 --spp 6 --size 16x12");
    assert_eq!(image.channel("samples.N").unwrap().iter().sum::<f32>(), 6.0 * 16.0 * 12.0);
}

#[test]
fn one_sample_is_enough() {
    let folder = tempfile::tempdir().unwrap();
    let (image, setting) = layers(folder.path(), "--spp 1 --size 16x12");
    assert!(image.channel("samples.N").unwrap().iter().all(|&n| n == 1.0));
    assert_eq!(setting("allocator").as_deref(), Some("runs"));
}

#[test]
fn values_that_are_wrong() {
    let folder = tempfile::tempdir().unwrap();
    for (option, values) in [
        ("--noise", &["0", "x", "2", "nan"][..]),
        ("--initial-spp", &["1", "0", "65537", "few"]),
        ("--round-budget", &["0", "nan", "inf", "half"]),
        ("--filter-radius", &["99", "1.5"]),
        ("--filter-position", &["0", "inf"]),
        ("--filter-normal", &["0", "nan"]),
        ("--filter-albedo", &["0", "x"]),
        ("--allocator", &["nonsense"]),
        ("--estimator", &["nonsense"]),
    ] {
        for value in values {
            render(folder.path(), &format!("{option} {value}")).failed(&[option, value]);
            assert_eq!(names(folder.path()), [""; 0], "after {option} {value}");
        }
    }
}

#[test]
fn the_help_names_every_option() {
    let folder = tempfile::tempdir().unwrap();
    let help = run(folder.path(), "render --help").succeeded().stdout;
    for option in OPTIONS {
        assert!(help.contains(option), "{option} is not in {help}");
    }
}
