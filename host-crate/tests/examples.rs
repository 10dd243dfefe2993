//! The examples run, and write pictures.

#![allow(clippy::expect_used, reason = "what fails is a test")]

use std::path::{Path, PathBuf};
use std::process::Command;

/// Where Cargo puts the examples: beside the folder of this test's executable.
fn executable(name: &str) -> PathBuf {
    let this = std::env::current_exe().expect("this test has a path");
    let profile = this.parent().and_then(Path::parent).expect("a profile's folder");
    let path = profile.join("examples").join(name).with_extension(std::env::consts::EXE_EXTENSION);
    assert!(path.is_file(), "{}: run `cargo build --examples` first", path.display());
    path
}

/// Runs an example on the CPU with 2 samples per pixel; what it says.
fn run(name: &str) -> String {
    let folder = tempfile::tempdir().expect("a folder");
    let picture = folder.path().join("picture.png");
    let output = Command::new(executable(name))
        .arg(&picture)
        .args(["2", "cpu"])
        .output()
        .expect("the example starts");
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
    let image = raystream::image::read_color(&picture).expect("a picture");
    let mean =
        image.pixels.iter().map(|c| c.element_sum()).sum::<f32>() / image.pixels.len() as f32;
    assert!(mean > 0.05 && mean < 2.9, "{name}: the mean is {mean}");
    said
}

#[test]
fn render() {
    run("render");
}

#[test]
fn own_scene() {
    run("own_scene");
}

#[test]
fn own_integrator() {
    assert_eq!(run("own_integrator").trim(), "all slots agree");
}

#[test]
fn progressive() {
    run("progressive");
}
