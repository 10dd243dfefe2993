//! Films of several processes are those of one, bit for bit.

use crate::program::{has_mpi, run};
use raystream::film_file::FilmFile;
use raystream::image::read_layers;
use std::path::Path;

/// A small render, on the CPU.
pub const SMALL: &str = "render cornell_ball --device cpu --threads 1 --size 53x37 --spp 40 -q";
/// Each takes another way through allocators and integrators.
const WAYS: [&str; 6] = [
    "--allocator uniform",
    "--allocator runs",
    "--allocator runs --denoise",
    "--allocator paper --estimator halves",
    "--allocator atomic --estimator variance",
    "--allocator uniform --integrator lvc",
];

/// Fails unless the films in two files are the same. What time decided may differ: how long the
/// render took, and into how many rounds it was cut where that does not show.
#[track_caller]
pub fn assert_same_films(folder: &Path, one: &str, other: &str) {
    let [one_film, other_film] =
        [one, other].map(|name| FilmFile::read(&folder.join(name)).unwrap());
    let (a, b) = (&one_film.checkpoint, &other_film.checkpoint);
    assert!(a.radiance == b.radiance, "{one} and {other}: other sums");
    assert!(a.features == b.features, "{one} and {other}: other features");
    assert!(a.splats == b.splats, "{one} and {other}: other splats");
    assert_eq!(a.unit_exponent, b.unit_exponent);
    assert_eq!(a.progress.paths, b.progress.paths);
    assert_eq!(a.progress.uniform_samples, b.progress.uniform_samples);
    let (a, b) = (&one_film.header, &other_film.header);
    assert_eq!(a.difference(b), None);
    assert_eq!((&a.device, &a.scene), (&b.device, &b.scene));
}

#[track_caller]
pub fn assert_same_pictures(folder: &Path, one: &str, other: &str) {
    let [one_picture, other_picture] =
        [one, other].map(|name| read_layers(&folder.join(name)).unwrap().channels);
    assert!(one_picture.len() > 3 && one_picture.len() == other_picture.len());
    for (a, b) in one_picture.iter().zip(&other_picture) {
        let pairs = || a.values.iter().zip(&b.values);
        let same = pairs().all(|(a, b)| a.to_bits() == b.to_bits());
        assert!(same && a.name == b.name, "{one} and {other}: the layer {} differs", a.name);
    }
}

fn command(way: &str, name: &str) -> String {
    format!("{SMALL} {way} -o {name}.exr --checkpoint {name}.film")
}

#[test]
fn two_and_four_processes_make_the_film_of_one() {
    if !has_mpi() {
        return;
    }
    for way in WAYS {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        run(folder, &format!("raystream-mpi {}", command(way, "one"))).succeeded();
        for count in [2, 4] {
            let several = command(way, &format!("of{count}"));
            let said = run(
                folder,
                &format!("mpirun -n {count} -x RUST_LOG=raystream=debug raystream-mpi {several}"),
            )
            .succeeded();
            // Otherwise this would say nothing.
            let word = if way.contains("uniform") { "handed over" } else { "workers traced" };
            assert!(said.stderr.contains(word), "{way}: {}", said.stderr);
            assert_same_films(folder, "one.film", &format!("of{count}.film"));
            assert_same_pictures(folder, "one.exr", &format!("of{count}.exr"));
        }
    }
}

/// Software GPUs too: the options are the same.
#[test]
fn two_gpus_of_two_processes_make_the_film_of_one() {
    if !has_mpi() || !raystream_tests::has_gpu() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let command = |name: &str| {
        format!(
            "render cornell_ball --device gpu --size 24x16 --spp 24 -q --checkpoint {name}.film -o {name}.exr"
        )
    };
    run(folder, &format!("raystream-mpi {}", command("one"))).succeeded();
    run(folder, &format!("mpirun -n 2 raystream-mpi {}", command("two"))).succeeded();
    assert_same_films(folder, "one.film", "two.film");
}

/// Each process may have several devices.
#[test]
fn processes_may_have_several_devices() {
    if !has_mpi() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let way = "--allocator uniform";
    run(folder, &format!("raystream-mpi {}", command(way, "one"))).succeeded();
    let several = command(way, "several").replace("--device cpu", "--device cpu,cpu");
    let said = run(folder, &format!("mpirun -n 2 raystream-mpi {several}")).succeeded();
    // The film would be the same if a worker had been lost.
    assert!(!said.stderr.contains("is lost"), "{}", said.stderr);
    assert_same_films(folder, "one.film", "several.film");
}

/// As many processes as you like go on with the render of as many others.
#[test]
fn renders_go_on_with_another_number_of_processes() {
    if !has_mpi() {
        return;
    }
    for way in WAYS {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        let begin = |name: &str| command(way, name).replace("--spp 40", "--spp 16");
        run(folder, &format!("raystream-mpi {}", begin("one"))).succeeded();
        run(folder, &format!("mpirun -n 2 raystream-mpi {}", begin("two"))).succeeded();
        run(folder, "raystream-mpi resume one.film --spp 40 -q").succeeded();
        run(folder, "mpirun -n 3 raystream-mpi resume two.film --spp 40 -q").succeeded();
        assert_same_films(folder, "one.film", "two.film");
    }
}

/// One frame after the other.
#[test]
fn frames_are_rendered_by_all() {
    if !has_mpi() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let frames = |name: &str| {
        format!("{} --frames 1-3", command("--allocator uniform", &format!("{name}.#")))
    };
    run(folder, &format!("raystream-mpi {}", frames("one"))).succeeded();
    run(folder, &format!("mpirun -n 2 raystream-mpi {}", frames("two"))).succeeded();
    for frame in 1..=3 {
        assert_same_films(folder, &format!("one.{frame}.film"), &format!("two.{frame}.film"));
    }
}
