//! Processes that are killed.

use crate::films::{SMALL, assert_same_films};
use crate::program::{has_mpi, process_of_rank, run, signal, start, wait_for};
use std::path::Path;

/// A render of some seconds.
const LONG: &str = "render cornell_ball --device cpu --threads 1 --size 96x64 --spp 1500 \
    --allocator uniform --checkpoint-every 0.3";

fn long(name: &str) -> String {
    format!("{LONG} --checkpoint {name}.film -o {name}.exr")
}

/// The render without a break, of one process.
fn whole(folder: &Path) {
    run(folder, &format!("raystream-mpi {} -q", long("whole"))).succeeded();
}

/// By default all are ended by `mpirun`, and the film is there as it was last kept.
#[test]
fn a_killed_process_leaves_a_film_that_goes_on() {
    if !has_mpi() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    whole(folder);
    for victim in [0, 1] {
        let name = format!("killed{victim}");
        let running = start(folder, &format!("mpirun -n 3 raystream-mpi {}", long(&name)));
        wait_for(&folder.join(format!("{name}.film")));
        signal(process_of_rank(running.id(), victim).unwrap(), "KILL");
        let ended = running.finish();
        assert_ne!(ended.status, Some(0), "{}", ended.stderr);
        let message = format!("process rank {victim} ");
        assert!(ended.stderr.contains(&message), "{}", ended.stderr);
        assert!(!folder.join(format!("{name}.exr")).exists(), "it was killed in time");
        run(folder, &format!("mpirun -n 2 raystream-mpi resume {name}.film --threads 1 -q"))
            .succeeded();
        assert_same_films(folder, "whole.film", &format!("{name}.film"));
    }
}

/// Where `mpirun` lets the others live, they do what the lost one had to do.
#[test]
fn a_render_survives_a_killed_process() {
    if !has_mpi() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    whole(folder);
    let command = format!("mpirun --enable-recovery -n 3 raystream-mpi {}", long("survived"));
    let running = start(folder, &command);
    wait_for(&folder.join("survived.film"));
    signal(process_of_rank(running.id(), 1).unwrap(), "KILL");
    let ended = running.finish().succeeded();
    assert!(ended.stderr.contains("(process 1 on "), "{}", ended.stderr);
    assert!(ended.stderr.contains("is lost"), "{}", ended.stderr);
    assert_same_films(folder, "whole.film", "survived.film");
}

/// Helpers end if the first process is gone, even where `mpirun` lets them live.
#[test]
fn nobody_stays_behind_alone() {
    if !has_mpi() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let command = format!("mpirun --enable-recovery -n 2 raystream-mpi {}", long("left"));
    let running = start(folder, &command);
    wait_for(&folder.join("left.film"));
    signal(process_of_rank(running.id(), 0).unwrap(), "KILL");
    let ended = running.finish();
    assert!(ended.stderr.contains("the first process is gone"), "{}", ended.stderr);
}

/// As Slurm ends a job: every process gets the signal, and the first one finishes.
#[test]
fn a_signal_leaves_picture_and_film() {
    if !has_mpi() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    whole(folder);
    let running = start(folder, &format!("mpirun -n 2 raystream-mpi {}", long("stopped")));
    wait_for(&folder.join("stopped.film"));
    for rank in [1, 0] {
        signal(process_of_rank(running.id(), rank).unwrap(), "TERM");
    }
    let ended = running.finish();
    assert_eq!(ended.status, Some(130), "{}", ended.stderr);
    assert!(folder.join("stopped.exr").exists(), "{}", ended.stderr);
    assert!(ended.stderr.contains("interrupted after"), "{}", ended.stderr);
    run(folder, "raystream-mpi resume stopped.film --threads 1 -q").succeeded();
    assert_same_films(folder, "whole.film", "stopped.film");
}

/// A render that nobody disturbs keeps quiet about it.
#[test]
fn nothing_is_said_of_processes_that_end_well() {
    if !has_mpi() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let ended = run(folder.path(), &format!("mpirun -n 3 raystream-mpi {SMALL}")).succeeded();
    assert_eq!((ended.stdout, ended.stderr), (String::new(), String::new()));
}
