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
