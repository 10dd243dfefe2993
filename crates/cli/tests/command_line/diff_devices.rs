//! `raystream diff-devices`

use crate::program::run;

const TINY: &str = "diff-devices --size 6x4 --spp 2";

/// All instructions of a CPU find the same.
#[test]
fn devices_that_are_the_same_are_said_to_be() {
    let folder = tempfile::tempdir().unwrap();
    let run = run(folder.path(), &format!("{TINY} --device cpu:scalar,cpu --denoise bilateral"));
    let run = run.succeeded();
    assert!(run.stdout.contains(" are the same, byte for byte, after each of "), "{}", run.stdout);
    assert!(run.stdout.contains("launches and 48 paths"), "{}", run.stdout);
    assert_eq!(run.stderr, "");
}

#[test]
fn anything_but_two_devices_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    for devices in ["cpu", "cpu,cpu,cpu"] {
        let run = run(folder.path(), &format!("{TINY} --device {devices}"));
        run.failed(&[&format!("--device {devices}"), "name two devices", "cpu,gpu"]);
    }
    run(folder.path(), &format!("{TINY} --device cpu,nothing")).failed(&["nothing"]);
}

#[test]
fn options_without_effect_are_said() {
    let folder = tempfile::tempdir().unwrap();
    let run = run(folder.path(), &format!("{TINY} --device cpu,cpu --exact")).succeeded();
    assert!(run.stderr.starts_with("warning: --exact has no effect on the CPU"), "{}", run.stderr);
}
