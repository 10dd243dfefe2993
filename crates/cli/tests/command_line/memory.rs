//! Devices without enough memory.

use crate::program::{Run, names, program, run};
use raystream_tests::has_gpu;
use std::io::Write;
use std::process::Command;

/// A software GPU takes the process's memory, so limiting that limits the GPU. (A real GPU's driver
/// would not even start.)
#[cfg(target_os = "linux")]
#[test]
fn a_gpu_without_enough_memory() {
    let folder = tempfile::tempdir().unwrap();
    let devices =
        Run::new(program(folder.path(), &["devices"]).output().unwrap()).succeeded().stdout;
    let Some(gpu) = devices.lines().find(|line| line.contains("llvmpipe")) else {
        let _ = writeln!(
            std::io::stderr(),
            "NOT TESTED: no software GPU here whose memory could be limited"
        );
        assert!(
            std::env::var_os("RAYSTREAM_REQUIRE_GPU").is_none() || devices.contains("GPU"),
            "{devices}"
        );
        return;
    };
    let run = "ulimit -v 2500000 && exec \"$0\" render --size 4096x4096 --spp 1 --max-depth 1 \
               -o a.png --device \"$1\"";
    let output = Command::new("bash")
        .args(["-c", run, env!("CARGO_BIN_EXE_raystream"), gpu])
        .current_dir(folder.path())
        .env("NODEVICE_SELECT", "1")
        .output()
        .unwrap();
    Run::new(output).failed(&["has no room for", "smaller picture", "raystream devices"]);
    assert!(names(folder.path()).is_empty());
}

/// Errors are estimated over the whole picture at once, which not every device can be given.
#[test]
fn a_picture_too_large_for_estimates_is_sampled_uniformly() {
    if !has_gpu() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let options = "render --device gpu --size 2000x1500 --spp 1 --max-depth 1";
    let by_default = run(folder.path(), &format!("{options} -o a.exr")).succeeded();
    let asked_for = run(folder.path(), &format!("{options} -o b.exr --allocator runs"));
    // Devices with larger buffers just render it.
    if by_default.stderr.contains("warning: ") {
        by_default.says(&["--allocator uniform", "wrote a.exr"]);
        asked_for.failed(&["estimates the errors", "--device cpu"]);
    } else {
        asked_for.succeeded();
    }
}
