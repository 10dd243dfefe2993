//! Ctrl-C.
#![cfg(unix)]

use crate::program::{Run, names, program};
use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// A render that would take days; returned once it is under way.
fn start(folder: &Path) -> (Child, String, impl BufRead + use<>) {
    let arguments = [
        "render", "--device", "cpu", "--size", "64x48", "--spp", "16000000", "-o", "a.exr", "-o",
        "b.png",
    ];
    let mut child =
        program(folder, &arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut stderr = BufReader::new(child.stderr.take().unwrap());
    let mut said = String::new();
    // The line of progress after some seconds shows that samples have been taken.
    while !said.contains("samples/s") {
        assert_ne!(stderr.read_line(&mut said).unwrap(), 0, "it ended by itself: {said}");
    }
    (child, said, stderr)
}

fn signal(child: &Child, name: &str) {
    assert!(
        Command::new("kill")
            .args([format!("-{name}"), child.id().to_string()])
            .status()
            .unwrap()
            .success()
    );
}

/// Waits for the end, not for ever.
fn finish(mut child: Child, mut said: String, mut stderr: impl Read) -> Run {
    let patience = Instant::now() + Duration::from_secs(60);
    let status = loop {
        if let Some(status) = child.try_wait().unwrap() {
            break status;
        }
        if Instant::now() > patience {
            child.kill().unwrap();
            panic!("it does not end after a signal");
        }
        std::thread::sleep(Duration::from_millis(20));
    };
    stderr.read_to_string(&mut said).unwrap();
    Run { status: status.code(), stdout: String::new(), stderr: said }
}

#[test]
fn writes_what_there_is() {
    for name in ["INT", "TERM"] {
        let folder = tempfile::tempdir().unwrap();
        let (child, said, stderr) = start(folder.path());
        signal(&child, name);
        let run =
            finish(child, said, stderr).says(&["interrupted after", "wrote a.exr", "wrote b.png"]);
        assert_eq!(run.status, Some(130));
        assert_eq!(names(folder.path()), ["a.exr", "b.png"]);
        let layers = raystream::image::read_layers(&folder.path().join("a.exr")).unwrap();
        let samples = layers.channel("samples.N").unwrap();
        assert!(samples.iter().all(|n| *n >= 1.0), "every pixel has a sample");
    }
}

#[test]
fn twice_ends_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let (child, said, stderr) = start(folder.path());
    signal(&child, "INT");
    signal(&child, "INT");
    let run = finish(child, said, stderr);
    assert_eq!(run.status, Some(130), "{}", run.stderr);
    // Between the two the first may have written a picture, whole.
    for name in names(folder.path()) {
        raystream::image::read_color(&folder.path().join(name)).unwrap();
    }
}

/// A program that waits for the end of what it reads, with a file that has none.
#[cfg(target_os = "linux")]
fn start_reading(folder: &Path, arguments: &[&str], fifo: &str) -> Child {
    let made = Command::new("mkfifo").arg(folder.join(fifo)).status().unwrap();
    assert!(made.success());
    let child = program(folder, arguments).stderr(Stdio::piped()).spawn().unwrap();
    // Opening it waits for who reads.
    let writer = std::fs::OpenOptions::new().write(true).open(folder.join(fifo)).unwrap();
    // As long as the test's process lives.
    std::mem::forget(writer);
    child
}

/// It ends with 130 within half a second, and two for a busy machine.
fn ends_at_once(mut child: Child, name: &str, said: &str) {
    let stderr = child.stderr.take().unwrap();
    let started = Instant::now();
    signal(&child, name);
    let run = finish(child, String::new(), stderr).says(&[said]);
    assert_eq!(run.status, Some(130), "{}", run.stderr);
    assert!(started.elapsed() < Duration::from_millis(2500), "{:?}", started.elapsed());
    assert!(!run.stderr.contains("wrote") && !run.stderr.contains("error"), "{}", run.stderr);
}

const WITHOUT_PICTURE: &str = "interrupted before there was a picture";

#[cfg(target_os = "linux")]
#[test]
fn reading_is_interrupted() {
    for name in ["INT", "TERM"] {
        for file in ["scene.json", "a.obj", "a.mtl"] {
            let scene = raystream_tests::scene_folder::SceneFolder::new().without(file);
            let folder = scene.path("");
            let arguments = ["render", "--device", "cpu", "scene.json", "-o", "a.png"];
            let child = start_reading(&folder, &arguments, file);
            std::thread::sleep(Duration::from_millis(50));
            ends_at_once(child, name, WITHOUT_PICTURE);
            assert!(!names(&folder).contains(&"a.png".to_owned()));
        }
    }
}

/// Moments of reading an OBJ of many triangles, of parsing it and of building the hierarchy.
#[test]
fn loading_and_building_are_interrupted() {
    let folder = tempfile::tempdir().unwrap();
    write_large_scene(folder.path(), 300);
    let before = names(folder.path());
    let arguments =
        ["render", "--device", "cpu", "large.json", "--spp", "1000000", "-o", "a.png", "-v"];
    let start = || program(folder.path(), &arguments).stderr(Stdio::piped()).spawn().unwrap();
    for delay in [20, 60, 100, 200] {
        let child = start();
        std::thread::sleep(Duration::from_millis(delay));
        // On a fast machine the last may find a picture.
        if delay < 200 {
            ends_at_once(child, "INT", "interrupted");
            assert_eq!(names(folder.path()), before);
        } else {
            signal(&child, "INT");
            assert_eq!(child.wait_with_output().unwrap().status.code(), Some(130));
        }
    }
}

/// A grid of `side` x `side` squares that no smooth hierarchy fits, and a scene file.
fn write_large_scene(folder: &Path, side: usize) {
    use std::fmt::Write as _;
    let mut obj = String::new();
    for (y, x) in (0..=side).flat_map(|y| (0..=side).map(move |x| (y, x))) {
        let at = |i: usize| 2.0 * i as f64 / side as f64 - 1.0;
        let _ = writeln!(obj, "v {:.5} {:.5} {:.5}", at(x), at(y), (x * 31 + y * 17) % 7);
    }
    for (y, x) in (0..side).flat_map(|y| (0..side).map(move |x| (y, x))) {
        let first = y * (side + 1) + x + 1;
        let _ = writeln!(obj, "f {first} {} {} {}", first + 1, first + side + 2, first + side + 1);
    }
    std::fs::write(folder.join("large.obj"), obj).unwrap();
    let scene = serde_json::json!({
        "format": 1, "name": "large", "obj": "large.obj", "film": {"width": 32, "height": 24},
        "camera": {"origin": [0, 0, 30], "target": [0, 0, 0], "up": [0, 1, 0], "fov_y": 40},
        "quads": [{"corner": [9, 9, 9], "u": [9, 0, 0], "v": [0, -9, 0], "radiance": [9, 9, 9]}],
    });
    std::fs::write(folder.join("large.json"), scene.to_string()).unwrap();
}

#[cfg(target_os = "linux")]
#[test]
fn other_commands_are_interrupted_and_what_takes_long_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let child = start_reading(folder.path(), &["bench", "rays", "./slow.json"], "slow.json");
    std::thread::sleep(Duration::from_millis(5500));
    ends_at_once(child, "TERM", "loading ./slow.json, 5 s so far\ninterrupted\n");
}
