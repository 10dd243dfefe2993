//! The program itself, under a virtual display.

#![allow(clippy::expect_used, clippy::unwrap_used, reason = "what fails is a test")]

use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

/// A virtual display that ends with the test; its number.
struct Display(Child, u32);

impl Drop for Display {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

impl Display {
    /// None, and a word about it, where there is no Xvfb.
    fn start() -> Option<Self> {
        // Its number is free: the display says which one it takes.
        let started = Command::new("Xvfb")
            .args(["-displayfd", "1", "-screen", "0", "1280x900x24", "-nolisten", "tcp"])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn();
        let Ok(mut child) = started else {
            let required = std::env::var_os("RAYSTREAM_REQUIRE_WINDOW").is_some();
            assert!(!required, "RAYSTREAM_REQUIRE_WINDOW is set, and there is no Xvfb");
            eprintln!("NOT TESTED: the program under a display, without Xvfb (package xvfb)");
            return None;
        };
        let mut line = String::new();
        let mut output = std::io::BufReader::new(child.stdout.take().unwrap());
        std::io::BufRead::read_line(&mut output, &mut line).unwrap();
        Some(Self(child, line.trim().parse().unwrap()))
    }
}

fn run(display: Option<&Display>, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_raystream-view"));
    command.args(arguments).env_remove("WAYLAND_DISPLAY").env_remove("WAYLAND_SOCKET");
    match display {
        Some(Display(_, number)) => command.env("DISPLAY", format!(":{number}")),
        None => command.env_remove("DISPLAY"),
    };
    command.output().unwrap()
}

/// The colours of a part of a PNG, from left to right.
fn colors(path: &Path, columns: std::ops::Range<u32>) -> std::collections::HashSet<[u8; 3]> {
    let image = image::open(path).unwrap().into_rgb8();
    let pixels = image.enumerate_pixels().filter(|(x, _, _)| columns.contains(x));
    pixels.map(|(_, _, pixel)| pixel.0).collect()
}

#[test]
fn the_program_opens_a_window_shows_a_picture_and_ends() {
    let Some(display) = Display::start() else { return };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("window.png");
    let start = Instant::now();
    let output = run(
        Some(&display),
        &[
            "--device",
            "cpu",
            "--size",
            "64x48",
            "--spp",
            "4",
            "--compare",
            "--after",
            "1",
            "--window",
            "900x600",
            "--screenshot",
            path.to_str().unwrap(),
        ],
    );
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{:?}: {errors}", output.status);
    assert!(start.elapsed() < Duration::from_secs(60), "{:?}", start.elapsed());
    assert!(colors(&path, 100..500).len() > 100, "there is a picture in the window");
    assert!(colors(&path, 700..900).len() > 10, "there are controls");
}

#[test]
fn a_screenshot_that_cannot_be_written_is_an_error() {
    let Some(display) = Display::start() else { return };
    let output = run(
        Some(&display),
        &[
            "--device",
            "cpu",
            "--size",
            "16x12",
            "--spp",
            "1",
            "--after",
            "0",
            "--screenshot",
            "/no/such/folder/window.png",
        ],
    );
    assert_eq!(output.status.code(), Some(2));
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(errors.contains("/no/such/folder"), "{errors}");
}

#[cfg(target_os = "linux")]
#[test]
fn without_a_screen_it_says_so() {
    let output = run(None, &[]);
    assert_eq!(output.status.code(), Some(2));
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(errors.contains("screen") && errors.contains("raystream render"), "{errors}");
}
