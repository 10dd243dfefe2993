//! Renders that are kept in film files: interrupted, killed, gone on with, in parts, in frames.

use crate::program::{Run, names, program, render, run};
use raystream::film_file::FilmFile;
use raystream::image::{LayeredImage, read_color, read_layers};
use raystream::render::Checkpoint;
use raystream_tests::gltf::Gltf;
use serde_json::json;
use std::path::Path;
use std::process::Stdio;
use std::time::Duration;

fn checkpoint(folder: &Path, name: &str) -> Checkpoint {
    FilmFile::read(&folder.join(name)).unwrap().checkpoint
}

fn layers(folder: &Path, name: &str) -> LayeredImage {
    read_layers(&folder.join(name)).unwrap()
}

#[test]
fn a_render_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for sampling in ["--allocator uniform", "--allocator uniform --integrator lvc"] {
        let begin = format!("caustics --size 24x16 --seed 5 {sampling}");
        render(folder, &format!("{begin} --spp 40 -o whole.exr")).succeeded();
        render(folder, &format!("{begin} --spp 16 -o part.exr --checkpoint a.film"))
            .succeeded()
            .says(&["wrote a.film", "resume a.film --spp N"]);
        run(folder, "resume a.film --spp 40 -o resumed.exr")
            .succeeded()
            .says(&["going on from 16.00 samples per pixel", "40 samples per pixel"]);
        assert!(layers(folder, "resumed.exr") == layers(folder, "whole.exr"), "{sampling}");
        // Where nothing is asked for, the last end counts, and has been reached.
        run(folder, "resume a.film -o again.exr").succeeded();
        assert!(layers(folder, "again.exr") == layers(folder, "whole.exr"), "{sampling}");
    }
}

/// From another folder, with all that the first command said.
#[test]
fn the_folder_of_the_command_counts() {
    let folder = tempfile::tempdir().unwrap();
    let (home, away) = (folder.path().join("home"), folder.path().join("away"));
    std::fs::create_dir(&home).unwrap();
    std::fs::create_dir(&away).unwrap();
    render(&home, "caustics --size 9x7 --spp 4 -o a.exr --checkpoint ../a.film").succeeded();
    run(&away, "resume ../a.film --spp 8 -o b.exr --checkpoint-every 5").succeeded();
    run(&away, "resume ../a.film --spp 9").succeeded();
    assert_eq!((names(&home), names(&away)), (vec!["a.exr".into()], vec!["b.exr".into()]));
    std::fs::remove_dir_all(&home).unwrap();
    run(&away, "resume ../a.film").failed(&["was begun in the folder", "cannot be entered"]);
}

/// The default sampling, ended by a signal and by kill -9 again and again.
#[test]
#[cfg(unix)]
fn a_hundred_kills_change_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let arguments = "render --device cpu caustics --size 32x24 --spp 3000 --round-budget 8 -q \
                     -o a.exr --checkpoint a.film --checkpoint-every 0.02";
    let resume = "resume a.film -q --checkpoint-every 0.02";
    run(folder, arguments).succeeded();
    let whole = (checkpoint(folder, "a.film"), layers(folder, "a.exr"));
    for name in names(folder) {
        std::fs::remove_file(folder.join(name)).unwrap();
    }
    let (mut kills, mut paths) = (0, 0);
    loop {
        let has_film = folder.join("a.film").exists();
        let arguments: Vec<_> =
            if has_film { resume } else { arguments }.split_whitespace().collect();
        let mut command = program(folder, &arguments);
        let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        if kills < 100 {
            // The golden ratio spreads the moments evenly, in an order that means nothing.
            let moment = (f64::from(kills) * 0.618_033_988_75).fract();
            std::thread::sleep(Duration::from_millis(40).mul_f64(1.0 + 4.0 * moment));
            let _ = child.kill();
        }
        let has_ended = child.wait().unwrap().success();
        kills += u32::from(!has_ended);
        if folder.join("a.film").exists() {
            let kept = checkpoint(folder, "a.film").progress.paths;
            assert!(kept >= paths, "what was kept stays");
            paths = kept;
        }
        if has_ended {
            break;
        }
    }
    println!("{kills} kills");
    assert!(kills > 20, "{kills} kills are too few to say anything");
    assert!(checkpoint(folder, "a.film") == whole.0, "after {kills} kills");
    assert!(layers(folder, "a.exr") == whole.1, "after {kills} kills");
}

#[test]
fn parts_are_one_render() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let scene = "opening --size 20x15 --spp 37 -q";
    render(folder, &format!("{scene} --allocator uniform -o w.exr --checkpoint w.film"))
        .succeeded();
    for part in 0..16 {
        let files = format!("-o p{part}.png --checkpoint p{part}.film");
        let part = format!("--part {part}/16");
        render(folder, &format!("{scene} --allocator uniform {part} {files}")).succeeded();
    }
    let parts = |parts: &[u32]| parts.iter().map(|p| format!("p{p}.film ")).collect::<String>();
    run(folder, "merge p3.film p0.film -o some.film")
        .succeeded()
        .says(&["14 of 16 parts are missing"]);
    run(folder, "resume some.film --spp 99").failed(&["2 parts of 16", "merge all of them"]);
    let rest = parts(&[15, 1, 2, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14]);
    run(folder, &format!("merge {rest} some.film -o all.film")).succeeded();
    let all: Vec<u32> = (0..16).collect();
    run(folder, &format!("merge {} -o other.film", parts(&all))).succeeded();
    assert!(checkpoint(folder, "all.film").radiance == checkpoint(folder, "other.film").radiance);
    assert!(checkpoint(folder, "all.film").radiance == checkpoint(folder, "w.film").radiance);
    run(folder, "picture all.film -o all.exr -o all.png").succeeded();
    let picture = |name: &str| read_color(&folder.join(name)).unwrap().pixels;
    assert_eq!(picture("all.exr"), picture("w.exr"));
    run(folder, "resume all.film --spp 40 -o more.exr").succeeded();
}

/// Several devices make the film of one.
#[test]
fn devices_render_together() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (name, options) in [("u", "--allocator uniform"), ("a", "--denoise")] {
        for (device, file) in [("cpu", "one"), ("cpu,cpu,CPU", "three")] {
            let files = format!("-o {name}-{file}.exr --checkpoint {name}-{file}.film");
            let scene = "opening --size 20x15 --spp 37 -q";
            run(folder, &format!("render {scene} {options} --device {device} {files}")).succeeded();
        }
        let [one, three] = ["one", "three"].map(|file| format!("{name}-{file}"));
        let film = |name: &str| checkpoint(folder, &format!("{name}.film"));
        assert!(film(&one).radiance == film(&three).radiance, "{options}");
        let picture = |name: &str| layers(folder, &format!("{name}.exr"));
        assert!(picture(&one) == picture(&three), "{options}");
        // A render of several devices goes on, on one or on several.
        run(folder, &format!("resume {three}.film --spp 40 -o more.exr")).succeeded();
    }
    run(folder, "render opening --device cpu,nothing -o b.png").failed(&["'nothing'", "cpu"]);
    run(folder, "render opening --device cpu, -o b.png").failed(&["''", "cpu"]);
    run(folder, "bench paths opening --device cpu,cpu").failed(&["'cpu,cpu'"]);
}

#[test]
fn adaptive_parts_are_independent() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for part in 0..2 {
        let files = format!("-o p.png --checkpoint p{part}.film");
        let part = format!("--spp 32 --size 20x15 --part {part}/2");
        render(folder, &format!("opening {part} {files}")).succeeded();
    }
    run(folder, "merge p0.film p1.film -o all.film").succeeded();
    let [one, other, all] = ["p0.film", "p1.film", "all.film"].map(|name| checkpoint(folder, name));
    assert!(one.radiance != other.radiance);
    for ((one, other), all) in one.radiance.iter().zip(&other.radiance).zip(&all.radiance) {
        assert_eq!(one.samples() + other.samples(), all.samples());
    }
    run(folder, "picture all.film -o a.exr --denoise").succeeded();
    let names: Vec<_> = layers(folder, "a.exr").channels.iter().map(|c| c.name.clone()).collect();
    assert!(names.iter().any(|name| name.starts_with("denoised")), "{names:?}");
}

#[test]
fn frames_have_files_of_their_own() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let scene = "caustics --size 9x7 --spp 2";
    render(folder, &format!("{scene} --frames 8-10x2 -o a.###.exr --checkpoint a.##.film"))
        .succeeded()
        .says(&["frame 8", "frame 10", "wrote a.008.exr", "wrote a.10.film"]);
    assert_eq!(names(folder), ["a.008.exr", "a.010.exr", "a.08.film", "a.10.film"]);
    assert!(layers(folder, "a.008.exr") != layers(folder, "a.010.exr"), "their noise differs");
    render(folder, &format!("{scene} --seed 10 -o b.exr")).succeeded();
    assert!(layers(folder, "a.010.exr") == layers(folder, "b.exr"));
    run(folder, "resume a.10.film --spp 5").succeeded().says(&["wrote a.010.exr"]);
    for (arguments, parts) in [
        ("--frames 1-2", ["name the pictures", "picture.####.exr"]),
        ("--frames 1-2 -o a.exr", ["a.exr", "every frame"]),
        ("--frames 1-2 -o a#.exr --checkpoint a.film", ["a.film", "every frame"]),
        ("--frames 2-1 -o a#.exr", ["'2-1' are not frames", "1-240"]),
        ("missing.#.json --frames 7 -o a#.exr", ["frame 7", "missing.7.json"]),
    ] {
        let scene = if arguments.starts_with("missing") { "" } else { scene };
        render(folder, &format!("{scene} {arguments}")).failed(&parts);
    }
}

#[test]
fn frames_show_an_animation() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let mut gltf = Gltf::triangle();
    let node = gltf.node(json!({"mesh": 0}));
    let times = gltf.floats(&[[0.0], [1.0]]);
    let places = gltf.floats(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]);
    gltf.json["animations"] = json!([{
        "samplers": [{"input": times, "output": places}],
        "channels": [{"sampler": 0, "target": {"node": node, "path": "translation"}}]}]);
    std::fs::write(folder.join("a.glb"), gltf.glb()).unwrap();
    let small = "a.glb --size 16x12 --spp 2";
    let files = "-o a.#.exr --checkpoint a.#.film -q";
    render(folder, &format!("{small} --frames 1-2 --fps 4 {files}")).succeeded();
    render(folder, &format!("{small} --at 0.25 --seed 1 -q -o b.exr")).succeeded();
    assert!(layers(folder, "a.1.exr") == layers(folder, "b.exr"));
    run(folder, "resume a.2.film --spp 3 -q -o c.exr").succeeded();
    let kept = FilmFile::read_header(&folder.join("a.2.film")).unwrap().command.arguments;
    assert!(kept.contains(&"--at=0.5".to_owned()), "{kept:?}");
    for (arguments, part) in [
        ("--fps 4 -o a.exr", "--frames"),
        ("--frames 1-2 --fps 0 -o a.#.exr", "29.97"),
        ("--frames 1-2 --fps 4 --at 1 -o a.#.exr", "--at"),
    ] {
        render(folder, &format!("{small} {arguments}")).says(&[part]);
    }
}

const SCENE: &str = r#"{
    "format": 2,
    "name": "a triangle",
    "film": {"width": 9, "height": 7},
    "camera": {"origin": [0, 0, 3], "target": [0, 0, 0], "up": [0, 1, 0], "fov_y": 40},
    "background": [1, 1, 1],
    "materials": {"wall": {"type": "diffuse", "reflectance": [0.5, 0.5, 0.5]}},
    "meshes": [{"file": "t.obj", "material": "wall"}]
}"#;
const OBJ: &str = "v -1 -1 0\nv 1 -1 0\nv 0 1 0\nf 1 2 3\n";

/// A folder with a scene `s.json`.
fn with_scene() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("s.json"), SCENE).unwrap();
    std::fs::write(folder.path().join("t.obj"), OBJ).unwrap();
    folder
}

#[test]
fn damaged_film_files_are_refused() {
    let folder = with_scene();
    let folder = folder.path();
    render(folder, "s.json --spp 4 -o a.png --checkpoint w.film").succeeded();
    let bytes = std::fs::read(folder.join("w.film")).unwrap();
    let changed = |place: usize, to: u8| {
        let mut bytes = bytes.clone();
        bytes[place] ^= to;
        bytes
    };
    for (bytes, parts) in [
        (changed(bytes.len() - 40, 1), ["checksum is wrong", "cut short"]),
        (changed(30, 0x80), ["is not a valid film file", "cut short"]),
        (changed(16, 76), ["format 78", "use the version that wrote it"]),
        (bytes[..bytes.len() - 9].to_vec(), ["checksum is wrong", "cut short"]),
        (bytes[..20].to_vec(), ["ends too early", "cut short"]),
        (Vec::new(), ["is not a film file", "name one"]),
    ] {
        std::fs::write(folder.join("d.film"), bytes).unwrap();
        for command in ["resume d.film", "picture d.film -o b.png"] {
            run(folder, command).failed(&parts).says(&["d.film"]);
        }
        run(folder, "merge d.film -o m.film").failed(&["d.film"]);
    }
    assert_eq!(names(folder), ["a.png", "d.film", "s.json", "t.obj", "w.film"]);
}

#[test]
fn films_of_something_else_are_refused() {
    let folder = with_scene();
    let folder = folder.path();
    let small = "s.json --allocator uniform --spp 4 -o a.png";
    render(folder, &format!("{small} --checkpoint a.film --part 0/2")).succeeded();
    render(folder, &format!("{small} --checkpoint b.film --part 1/2 --seed 1")).succeeded();
    render(folder, &format!("{small} --checkpoint w.film")).succeeded();
    for (arguments, parts) in [
        ("resume a.png", ["a.png", "is not a film file"]),
        ("resume missing.film", ["missing.film", "no such file"]),
        ("resume s.json", ["s.json", "is not a film file"]),
        ("resume w.film --device nothing", ["nothing", "raystream devices"]),
        ("resume w.film --noise 0.1", ["w.film", "--halves or --noise"]),
        ("picture w.film -o w.film", ["w.film", "extension"]),
        ("picture w.film --denoise -o b.png", ["w.film", "halves"]),
        ("merge a.film w.film -o all.film", ["w.film", "not of a part"]),
        ("merge a.film a.film -o all.film", ["same part", "leave out"]),
        ("merge a.film b.film -o all.film", ["b.film", "its settings are not those of a.film"]),
        ("merge a.film -o a.film", ["a.film", "would replace a part"]),
    ] {
        run(folder, arguments).failed(&parts);
    }
    std::fs::write(folder.join("s.json"), SCENE.replace("0.5", "0.6")).unwrap();
    run(folder, "resume w.film --spp 9").failed(&["w.film", "another scene"]);
    std::fs::write(folder.join("s.json"), SCENE).unwrap();
    run(folder, "resume w.film --spp 9").succeeded();
    for (arguments, parts) in [
        ("s.json --spp 4 --part 0/9", ["0/9", "larger --spp"]),
        ("s.json --spp 4 --part 2/2", ["'2/2' is not a part", "0/16"]),
        ("s.json --part 0/2", ["--spp", "required"]),
        ("s.json --checkpoint nowhere/c.film", ["there is no folder", "nowhere"]),
        ("s.json -o a.png --checkpoint a.png", ["a.png", "as picture and as --checkpoint"]),
        ("- -o b.png --checkpoint c.film", ["standard input", "put it into a file"]),
    ] {
        render(folder, arguments).says(&parts);
    }
}

/// A disk that is lost while the render goes on: the picture is written elsewhere all the same.
#[test]
fn a_film_file_that_cannot_be_written_costs_no_picture() {
    let folder = with_scene();
    let folder = folder.path();
    std::fs::create_dir(folder.join("disk")).unwrap();
    let arguments: Vec<_> = "render --device cpu s.json --time 3 -o a.png --checkpoint \
        disk/a.film --checkpoint-every 0.1"
        .split_whitespace()
        .collect();
    let mut command = program(folder, &arguments);
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    while !folder.join("disk/a.film").exists() {
        assert_eq!(child.try_wait().unwrap(), None, "it has ended");
        std::thread::sleep(Duration::from_millis(5));
    }
    // What is being written at this moment may come back.
    while std::fs::remove_dir_all(folder.join("disk")).is_err() {}
    Run::new(child.wait_with_output().unwrap()).failed(&[
        "warning: no checkpoint",
        "trying again in 0.1 s",
        "there is no folder",
        "a.png",
    ]);
    assert!(read_color(&folder.join("a.png")).is_ok());
}
