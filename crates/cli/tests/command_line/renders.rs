//! What a render says and writes.

use crate::program::{program, render};
use raystream::image::{read_layers, read_settings};
use std::process::Stdio;
use std::time::{Duration, Instant};

#[test]
fn the_seed_decides_every_layer() {
    let folder = tempfile::tempdir().unwrap();
    let layers = |name: &str, seed: u32| {
        render(folder.path(), &format!("--size 16x12 --spp 5 --seed {seed} -o {name}")).succeeded();
        let image = read_layers(&folder.path().join(name)).unwrap();
        assert_eq!((image.width, image.height), (16, 12));
        image
            .channels
            .into_iter()
            .map(|c| (c.name, c.values.iter().map(|v| v.to_bits()).collect()))
            .collect()
    };
    let first: Vec<(String, Vec<u32>)> = layers("a.exr", 7);
    assert!(first.len() > 3);
    assert_eq!(first, layers("b.exr", 7));
    assert_ne!(first, layers("c.exr", 8));
}

#[test]
fn the_header_tells_how_it_was_made() {
    let folder = tempfile::tempdir().unwrap();
    let options = "--size 4x3 --spp 2 --seed 9 --max-depth 3 --rr-depth 2 --sampler independent";
    render(folder.path(), &format!("{options} -o a.exr")).succeeded();
    let settings = read_settings(&folder.path().join("a.exr")).unwrap();
    for (name, value) in [
        ("scene", "cornell_ball"),
        ("samples", "2"),
        ("seed", "9"),
        ("max_depth", "3"),
        ("rr_depth", "2"),
        ("sampler", "independent"),
        ("integrator", "auto"),
        ("version", env!("CARGO_PKG_VERSION")),
    ] {
        assert!(
            settings.iter().any(|(key, text)| key.ends_with(name) && text == value),
            "{name} in {settings:?}"
        );
    }
}

#[test]
fn bidirectional_renders_by_every_allocator() {
    let folder = tempfile::tempdir().unwrap();
    for allocator in ["uniform", "paper", "atomic", "runs"] {
        let options = format!(
            "opening --integrator lvc --allocator {allocator} --size 16x12 --spp 8 --initial-spp 2"
        );
        render(folder.path(), &format!("{options} --light-paths 300 --connections 2 -o a.exr"))
            .succeeded();
        let image = read_layers(&folder.path().join("a.exr")).unwrap();
        assert!(image.channel("G").unwrap().iter().any(|&green| green > 0.0), "{allocator}");
        let settings = read_settings(&folder.path().join("a.exr")).unwrap();
        for (name, value) in [("integrator", "lvc"), ("light_paths", "300"), ("connections", "2")] {
            assert!(
                settings.iter().any(|(key, text)| key.ends_with(name) && text == value),
                "{name} in {settings:?}"
            );
        }
    }
    render(folder.path(), "--integrator lvc --no-light-tracing --size 16x12 --spp 8 -o b.exr")
        .succeeded();
    let settings = read_settings(&folder.path().join("b.exr")).unwrap();
    assert!(
        settings.iter().any(|(key, text)| key.ends_with("light_tracing") && text == "off"),
        "{settings:?}"
    );
    render(folder.path(), "--integrator lvc --size 16x12 --spp 8 -o a.exr").succeeded();
    let settings = read_settings(&folder.path().join("a.exr")).unwrap();
    assert!(
        settings.iter().all(|(key, _)| !key.ends_with("light_paths")),
        "a pilot run decides: {settings:?}"
    );
}

#[test]
fn without_a_number_of_samples_there_are_64() {
    let folder = tempfile::tempdir().unwrap();
    render(folder.path(), "--size 4x3 -o a.exr").succeeded();
    let image = read_layers(&folder.path().join("a.exr")).unwrap();
    let samples = image.channel("samples.N").unwrap();
    assert_eq!(samples.iter().sum::<f32>(), 64.0 * samples.len() as f32);
}

#[test]
fn the_time_limits() {
    let folder = tempfile::tempdir().unwrap();
    let start = Instant::now();
    render(folder.path(), "--size 16x12 --time 1 -o a.exr").succeeded().says(&["wrote a.exr"]);
    assert!(start.elapsed() >= Duration::from_secs(1));
    let settings = read_settings(&folder.path().join("a.exr")).unwrap();
    let seconds = settings
        .iter()
        .find(|(key, _)| key.ends_with("seconds"))
        .unwrap()
        .1
        .parse::<f64>()
        .unwrap();
    assert!((1.0..2.0).contains(&seconds), "{seconds} s of rendering");
    // Whichever comes first.
    render(folder.path(), "--size 4x3 --time 1000 --spp 3 -o b.exr")
        .succeeded()
        .says(&["3 samples per pixel"]);
}

#[test]
fn progress_is_plain_lines_in_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let run = render(folder.path(), "--size 16x12 --time 6 -o a.png").succeeded();
    assert_eq!(run.stdout, "");
    assert!(!run.stderr.contains(['\r', '\x1b']), "{:?}", run.stderr);
    let progress: Vec<_> = run.stderr.lines().filter(|line| line.contains(" %  ")).collect();
    assert_eq!(progress.len(), 1, "a line every five seconds: {}", run.stderr);
    assert!(progress[0].contains("samples/s") && progress[0].contains("s left"), "{}", progress[0]);
}

#[test]
fn quiet_says_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let run = render(folder.path(), "--size 4x3 --spp 1 --quiet -o a.png").succeeded();
    assert_eq!((run.stdout.as_str(), run.stderr.as_str()), ("", ""));
}

/// `raystream render 2>&1 | head -1` must not lose the picture.
#[test]
fn nobody_needs_to_read_along() {
    let folder = tempfile::tempdir().unwrap();
    let arguments =
        ["render", "--device", "cpu", "--size", "4x3", "--spp", "1", "-vv", "-o", "a.exr"];
    let mut command = program(folder.path(), &arguments);
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stderr.take());
    drop(child.stdout.take());
    assert!(child.wait().unwrap().success());
    read_layers(&folder.path().join("a.exr")).unwrap();
}
