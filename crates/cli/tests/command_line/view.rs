//! `raystream view`, which hands over to the window's program.

use crate::program::Run;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::Command;

/// Runs `raystream view` as a program in `folder`, which has its own PATH.
fn view(folder: &Path, path: &Path, arguments: &[&str]) -> Run {
    let own = folder.join("raystream");
    if !own.exists() {
        std::fs::copy(env!("CARGO_BIN_EXE_raystream"), &own).unwrap();
    }
    let output = Command::new(own).arg("view").args(arguments).env("PATH", path).output().unwrap();
    Run::new(output)
}

/// A program in place of the window's, which says what it was told and ends with `status`.
fn put_program(folder: &Path, status: i32) {
    let path = folder.join("raystream-view");
    let script = format!(
        "#!/bin/sh\nfor word in \"$@\"; do echo \"[$word]\"; done\n\
         echo \"threads $RAYON_NUM_THREADS\"\nexit {status}\n"
    );
    std::fs::write(&path, script).unwrap();
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).unwrap();
}

#[test]
fn without_the_windows_program_it_says_how_to_get_it() {
    let folder = tempfile::tempdir().unwrap();
    let parts = ["raystream-view", "PATH", "cargo build --release -p raystream-view"];
    view(folder.path(), folder.path(), &["cornell_ball"]).failed(&parts);
}

#[test]
fn the_windows_program_is_told_all_that_follows() {
    let folder = tempfile::tempdir().unwrap();
    put_program(folder.path(), 0);
    let empty = tempfile::tempdir().unwrap();
    let told = view(
        folder.path(),
        empty.path(),
        &["a scene.json", "--size", "8x6", "--compare", "--exposure", "-1"],
    );
    let words = "[a scene.json]\n[--size]\n[8x6]\n[--compare]\n[--exposure]\n[-1]\n";
    assert!(told.succeeded().stdout.starts_with(words));
    let told = view(folder.path(), empty.path(), &["--help"]).succeeded();
    assert!(told.stdout.starts_with("[--help]\n"), "the options are the window's");
    let told = view(folder.path(), empty.path(), &["--threads", "3", "tea"]).succeeded();
    assert_eq!(told.stdout, "[tea]\nthreads 3\n");
}

#[test]
fn the_windows_program_is_found_in_path_and_its_failure_is_one() {
    let (folder, path) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    put_program(path.path(), 2);
    view(folder.path(), path.path(), &["tea"]).failed(&["exit status: 2"]);
}
