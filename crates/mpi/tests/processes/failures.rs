//! What is wrong is said once, ends all processes, and has status 2.

use crate::films::SMALL;
use crate::program::{has_mpi, run};
use raystream_tests::Run;
use std::path::Path;

/// Runs two processes with arguments of their own.
fn two(folder: &Path, one: &str, other: &str) -> Run {
    run(folder, &format!("mpirun -n 1 raystream-mpi {one} : -n 1 raystream-mpi {other}"))
}

#[test]
fn processes_must_render_the_same() {
    if !has_mpi() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let other_scene = SMALL.replace("cornell_ball", "cornell_glass");
    two(folder, SMALL, &other_scene).failed_once(&["process 1 on ", " has another scene"]);
    let other_seed = format!("{SMALL} --seed 7");
    two(folder, SMALL, &other_seed).failed_once(&["process 1 on ", " by other settings"]);
    let missing = SMALL.replace("cornell_ball", "missing.json");
    two(folder, SMALL, &missing).failed_once(&["process 1 on ", "missing.json"]);
    assert!(std::fs::read_dir(folder).unwrap().next().is_none(), "nothing is written");
}

#[test]
fn errors_are_said_once() {
    if !has_mpi() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let three = |arguments: &str| run(folder, &format!("mpirun -n 3 raystream-mpi {arguments}"));
    three("render missing.json").failed_once(&["missing.json"]);
    three("render --sppp 3").failed_once(&["--sppp"]);
    three("resume missing.film").failed_once(&["missing.film"]);
    three("bench rays").failed_once(&["bench"]);
    let nowhere = format!("{SMALL} -o no/such/folder/a.exr");
    three(&nowhere).failed_once(&["no/such/folder"]);
    let help = three("render --help").succeeded().stdout;
    assert_eq!(help.matches("Usage: raystream-mpi render").count(), 1, "{help}");
    let help = three("--help").succeeded().stdout;
    assert_eq!(help.matches("mpirun -n").count(), 1, "{help}");
}
