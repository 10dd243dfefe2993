//! The commands beside `render`.

use crate::program::{names, program, render, run};
use std::process::Stdio;

/// A folder with two pictures of one size, one equal to the first, and one of another size.
fn pictures() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    render(folder.path(), "--size 8x6 --spp 4 -q -o a.exr -o same.exr -o a.png").succeeded();
    render(folder.path(), "--size 8x6 --spp 4 -q --seed 1 -o b.exr").succeeded();
    render(folder.path(), "--size 8x7 --spp 1 -q -o higher.exr").succeeded();
    folder
}

#[test]
fn compare_measures_the_difference() {
    let folder = pictures();
    let json = |arguments: &str| -> serde_json::Value {
        serde_json::from_str(
            &run(folder.path(), &format!("compare --json {arguments}")).succeeded().stdout,
        )
        .unwrap()
    };
    let equal = json("a.exr same.exr");
    assert_eq!(equal["rmse"], 0.0);
    assert_eq!(equal["ratio"], 1.0);
    assert_eq!(equal["ssim"], serde_json::Value::Null, "it has no 11 pixels");
    assert!(json("a.exr b.exr")["rmse"].as_f64().unwrap() > 0.0);
    let text = run(folder.path(), "compare a.exr same.exr").succeeded().stdout;
    assert!(text.starts_with("RMSE            0.000000\n"), "{text}");
    assert!(text.contains("\nSSIM            -  (no window"), "{text}");
    run(folder.path(), "compare a.png a.png").succeeded();
}

#[test]
fn compare_draws_the_difference() {
    let folder = pictures();
    run(folder.path(), "compare a.exr b.exr -o difference.png").succeeded();
    let difference = raystream::image::read_color(&folder.path().join("difference.png")).unwrap();
    assert_eq!(difference.width, 8);
    assert!(difference.height > 6, "the scale is below the picture");
    assert!(
        difference.pixels[..8 * 6].iter().any(|pixel| *pixel != glam::Vec3::ONE),
        "where nothing differs it is white"
    );
    let before = std::fs::read(folder.path().join("b.exr")).unwrap();
    run(folder.path(), "compare a.exr b.exr -o ./b.exr").failed(&[
        "b.exr",
        "replace",
        "another file",
    ]);
    assert_eq!(std::fs::read(folder.path().join("b.exr")).unwrap(), before);
}

#[test]
fn compare_names_what_is_wrong() {
    let folder = pictures();
    std::fs::write(folder.path().join("broken.exr"), b"\x76\x2f\x31\x01").unwrap();
    let before = names(folder.path());
    for (arguments, parts) in [
        ("a.exr higher.exr -o d.png", &["a.exr", "higher.exr", "8x6", "8x7"][..]),
        ("a.exr missing.exr", &["missing.exr"]),
        ("a.exr broken.exr", &["broken.exr"]),
        ("a.exr b.exr -o missing/d.png", &["missing/d.png", "create it"]),
        ("a.exr b.jpg", &["b.jpg", ".exr or .png"]),
        ("a.exr b.exr -o d.png --gain nan", &["gain"]),
        ("a.exr b.exr -o d.png --gain 0", &["gain"]),
        ("a.png a.png --reference-samples 4", &["a.png"]),
    ] {
        run(folder.path(), &format!("compare {arguments}")).failed(parts);
        assert_eq!(names(folder.path()), before, "after compare {arguments}");
    }
}

#[test]
fn lists() {
    let folder = tempfile::tempdir().unwrap();
    let devices = run(folder.path(), "devices").succeeded();
    assert!(
        devices.stdout.contains("\ncpu\n    CPU, ") || devices.stdout.starts_with("cpu\n    CPU, "),
        "{}",
        devices.stdout
    );
    assert!(!devices.stdout.contains("CPU, CPU"), "{}", devices.stdout);
    let scenes = run(folder.path(), "scenes").succeeded().stdout;
    for part in [
        "cornell_ball (the default)",
        "cornell_glass",
        "opening",
        "caustics",
        "tea",
        "metals",
        "daylight",
        "sibenik",
        "conference",
        "https://",
    ] {
        assert!(scenes.contains(part), "{scenes}");
    }
}

#[test]
fn measurements() {
    let folder = tempfile::tempdir().unwrap();
    let rays =
        run(folder.path(), "bench rays --device cpu --size 16x12 --repetitions 2 --checks 20")
            .succeeded()
            .stdout;
    for part in [
        "cornell_ball",
        "16x12",
        "primary",
        "diffuse bounce",
        "shadow",
        "Mrays/s",
        "20 rays checked",
    ] {
        assert!(rays.contains(part), "{part} is not in {rays}");
    }
    let paths = run(
        folder.path(),
        "bench paths cornell_ball cornell_glass --device cpu --size 16x12 --time 0.2",
    );
    let paths = paths.succeeded().stdout;
    for part in ["cornell_ball", "cornell_glass", "Mpaths/s", "tracing"] {
        assert!(paths.contains(part), "{part} is not in {paths}");
    }
    assert_eq!(names(folder.path()), [""; 0]);
}

/// `raystream scenes | head -1`
#[test]
fn a_reader_may_leave_early() {
    let folder = tempfile::tempdir().unwrap();
    for arguments in [
        &["scenes"][..],
        &["render", "--help"],
        &["bench", "paths", "--device", "cpu", "--size", "4x3", "--time", "0.1"],
    ] {
        let mut child = program(folder.path(), arguments)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        drop(child.stdout.take());
        let run = crate::program::Run::new(child.wait_with_output().unwrap()).succeeded();
        assert_eq!(run.stderr, "");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn an_output_that_is_full_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let full = std::fs::File::options().write(true).open("/dev/full").expect("Linux has /dev/full");
    let output = program(folder.path(), &["scenes"]).stdout(full).output().unwrap();
    crate::program::Run::new(output).failed(&["standard output", "No space left"]);
}
