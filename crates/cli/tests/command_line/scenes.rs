//! Scenes that do not load, and those that load with a warning; the library's tests know every
//! message, here is one of each kind.

use crate::program::{Run, names, program, render, run};
use raystream_tests::scene_folder::{MTL, OBJ, SceneFolder};
use serde_json::{Value, json};
use std::io::Write;
use std::process::Stdio;

/// Rendering the folder's scene fails with all of `parts` and leaves no new file.
#[track_caller]
fn refused(scene: &SceneFolder, parts: &[&str]) {
    let before = names(&scene.path(""));
    let run = render(&scene.path(""), "scene.json --spp 1 -o a.png").failed(parts);
    assert_eq!(run.stderr.lines().count(), 1, "{}", run.stderr);
    assert_eq!(names(&scene.path("")), before);
}

/// Rendering the folder's scene works, with a warning that says all of `parts`, also with
/// `--quiet`.
#[track_caller]
fn warned(scene: &SceneFolder, parts: &[&str]) {
    let run =
        render(&scene.path(""), "scene.json --spp 1 --quiet -o a.png").succeeded().says(parts);
    assert!(run.stderr.lines().all(|line| line.starts_with("warning: ")), "{}", run.stderr);
    assert!(scene.path("a.png").is_file());
}

#[test]
fn scene_files_that_are_wrong() {
    let cases: [(&str, Value, &[&str]); 8] = [
        ("/colour", json!(1), &["unknown field `colour`"]),
        ("/materials", json!({"plain": {"type": "glas"}}), &["glas", "dielectric"]),
        ("/camera/fov_y", json!("NaN"), &["camera.fov_y"]),
        ("/film", json!({"width": 0, "height": 6}), &["film.width", "from 1 to"]),
        ("/quads/0/u", json!([0, 0, 0]), &["quads[0]", "area"]),
        ("/camera/up", json!([0, 0, 1]), &["camera", "up"]),
        ("/materials", json!({"absent": {"type": "null"}}), &["absent", "plain"]),
        ("/obj", json!("b.obj"), &["key `obj`", "b.obj"]),
    ];
    for (at, value, parts) in cases {
        let scene = SceneFolder::new().json(|scene| {
            let (parent, key) = at.rsplit_once('/').unwrap();
            scene.pointer_mut(parent).unwrap()[key] = value;
        });
        refused(&scene, &[&["scene.json"], parts].concat());
    }
}

#[test]
fn scene_files_that_are_no_json() {
    refused(&SceneFolder::new().without("scene.json"), &["scene.json", "cannot be read"]);
    refused(&SceneFolder::new().with("scene.json", "v 0 0 0"), &["scene.json", "has no faces"]);
    refused(&SceneFolder::new().with("scene.json", ""), &["scene.json"]);
    let text = std::fs::read_to_string(SceneFolder::new().path("scene.json")).unwrap();
    for number in ["NaN", "Infinity", "1e999"] {
        let broken = text.replace("\"fov_y\": 40", &format!("\"fov_y\": {number}"));
        assert_ne!(broken, text);
        refused(&SceneFolder::new().with("scene.json", broken), &["scene.json", "line"]);
    }
}

#[test]
fn a_folder_is_no_scene() {
    let scene = SceneFolder::new();
    render(&scene.path(""), "./ -o a.png").failed(&["./", "cannot be read"]);
    render(&scene.path(""), ". -o a.png").failed(&["cannot be read"]);
    assert!(!scene.path("a.png").exists());
}

#[test]
fn an_unknown_name_lists_the_known_ones() {
    let folder = tempfile::tempdir().unwrap();
    render(folder.path(), "cornell_bowl").failed(&["cornell_bowl", "cornell_ball", "scene file"]);
    assert_eq!(names(folder.path()), [""; 0]);
}

#[test]
fn geometry_to_be_fetched_says_where_to_put_it() {
    let folder = tempfile::tempdir().unwrap();
    render(folder.path(), "sibenik").failed(&["SCENES_DIR", "export"]);
    run(folder.path(), "bench paths sibenik --device cpu").failed(&["SCENES_DIR"]);
    assert_eq!(names(folder.path()), [""; 0]);
}

#[test]
fn geometry_that_is_wrong() {
    refused(&SceneFolder::new().with("a.obj", "v 0 0 0\nv 1 0 0\n"), &["a.obj", "face"]);
    refused(
        &SceneFolder::new().with("a.obj", OBJ.replace("3//1", "9//1")),
        &["a.obj", "line 10", "vertex 9"],
    );
    refused(
        &SceneFolder::new().with("a.obj", OBJ.replace("v 0 1 0", "v 0 nan 0")),
        &["a.obj", "line"],
    );
}

#[test]
fn textures_that_are_wrong() {
    let textured = MTL.replace("Kd 1 0 0", "map_Kd wall.png");
    let broken =
        SceneFolder::new().with("a.mtl", &textured).with("wall.png", b"\x89PNG\r\n\x1a\nbroken");
    warned(&broken, &["a.mtl", "wall.png", "cannot be read", "plain colours"]);
    let override_ = |texture: &str| {
        SceneFolder::new().json(|scene| {
            scene["materials"] =
                json!({"red wall": {"type": "diffuse", "reflectance": {"texture": texture}}});
        })
    };
    refused(&override_("missing.png"), &["scene.json", "red wall", "missing.png"]);
    warned(&SceneFolder::new().with("a.mtl", textured), &["a.mtl", "wall.png"]);
}

#[test]
fn what_works_with_a_warning() {
    warned(&SceneFolder::new().without("a.mtl"), &["a.mtl"]);
    let degenerate = format!("{OBJ}f 1//1 1//1 2//1\n");
    warned(&SceneFolder::new().with("a.obj", degenerate), &["a.obj", "1 triangles without area"]);
}

/// The mean of a picture.
fn mean(path: &std::path::Path) -> f32 {
    let image = raystream::image::read_color(path).unwrap();
    image.pixels.iter().map(|pixel| pixel.element_sum() / 3.0).sum::<f32>()
        / image.pixels.len() as f32
}

/// A quad `count` times, each made by `corners` of its number.
fn quads(count: usize, corners: impl Fn(f64) -> [[f64; 3]; 4]) -> String {
    let quad = |k: usize| {
        let vertices = corners(k as f64).map(|[x, y, z]| format!("v {x} {y} {z}\n"));
        vertices.concat() + "f -4 -3 -2 -1\n"
    };
    (0..count).map(quad).collect()
}

#[test]
fn many_faces_in_one_place_render() {
    let square = |half: f64, z: f64| {
        [[-half, -half, z], [half, -half, z], [half, half, z], [-half, half, z]]
    };
    let count = 100_000;
    let cases = [
        ("one quad", quads(1, |_| square(3.0, 0.0)), ""),
        ("copies", quads(count, |_| square(3.0, 0.0)), "199998 triangles with the corners of"),
        ("decals", quads(count, |k| square(3.0, -1e-9 * k)), ""),
        ("shells", quads(count, |k| square(3.0 + 1e-6 * k, 0.0)), ""),
    ];
    for bvh in ["fast", "high"] {
        let mut means = Vec::new();
        for (what, obj, said) in &cases {
            let scene = SceneFolder::new().with("a.obj", obj).without("a.mtl").json(|scene| {
                scene["quads"][0]["u"] = json!([-1, 0, 0]);
            });
            let arguments = format!("scene.json --spp 64 --bvh {bvh} --size 8x6 -o a.exr");
            render(&scene.path(""), &arguments).succeeded().says(&[said]);
            means.push((what, mean(&scene.path("a.exr"))));
        }
        let (_, expected) = means[0];
        for (what, mean) in means {
            assert!((mean / expected - 1.0).abs() < 0.05, "{what}, {bvh}: {mean}, not {expected}");
        }
    }
}

#[test]
fn a_scene_may_come_from_standard_input_and_from_a_file_of_any_name() {
    let scene = SceneFolder::new();
    let text = std::fs::read(scene.path("scene.json")).unwrap();
    let arguments = ["render", "-", "--device", "cpu", "--spp", "1", "-o", "a.png"];
    for name in [
        "-",
        #[cfg(unix)]
        "/dev/stdin",
    ] {
        let mut arguments = arguments;
        arguments[1] = name;
        let mut run = program(&scene.path(""), &arguments)
            .stdin(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        run.stdin.take().unwrap().write_all(&text).unwrap();
        Run::new(run.wait_with_output().unwrap()).succeeded();
    }
    let scene = scene.with("noext", text);
    render(&scene.path(""), "noext --spp 1 -o b.png").succeeded();
    let empty = scene.with("noext", "{\"format\": 1}");
    render(&empty.path(""), "noext").failed(&["noext: missing field `name`"]);
}

#[test]
fn a_scene_without_end_is_refused_at_a_limit_that_an_option_sets() {
    let scene = SceneFolder::new();
    #[cfg(unix)]
    render(&scene.path(""), "/dev/zero").failed(&["/dev/zero", "64 MiB", "--max-memory"]);
    let many = scene.with("a.obj", format!("{OBJ}{}", "f 1 1 2\n".repeat(30_000)));
    render(&many.path(""), "scene.json --max-memory 0.01 -o a.png").failed(&[
        "a.obj, line ",
        "10.2 MiB",
        "--max-memory",
    ]);
    render(&many.path(""), "scene.json --max-memory 1 --spp 1 -o a.png").succeeded();
    render(&many.path(""), "scene.json --max-memory 0").failed(&["'0' is not an amount"]);
}

#[test]
fn what_is_left_out_is_summed_up_and_listed_when_asked_for() {
    let mtl = format!("{MTL}Ns 10\nKs 1 1 1\nmap_d leaf.png\n");
    let scene = SceneFolder::new().with("a.mtl", mtl).with("a.obj", format!("{OBJ}l 1 2\n"));
    warned(&scene, &["a.mtl", "`Ks` of `red wall`; `Ns`", "opaque: `map_d`", "`l` (1, the first"]);
    let run = render(&scene.path(""), "scene.json --spp 1 -v -o a.png").succeeded();
    run.says(&["a.mtl, line 7: material `red wall`: opacity is left out"]);
}

#[test]
fn a_lamp_that_shines_away_gives_a_hint() {
    let scene = SceneFolder::new().json(|scene| {
        scene["camera"]["fov_y"] = json!(5);
        scene["camera"]["target"] = json!([0.2, 0.2, 0]);
        scene["camera"]["origin"] = json!([0.2, 0.2, 2]);
    });
    warned(&scene, &["the picture is black", "cross(u, v)"]);
    let run = render(&SceneFolder::new().path(""), "scene.json --spp 1 -o a.png").succeeded();
    assert!(!run.stderr.contains("black"), "{}", run.stderr);
}

#[test]
fn without_light_the_picture_is_black() {
    let scene = SceneFolder::new().json(|scene| scene["quads"] = json!([]));
    warned(&scene, &["scene.json", "nothing emits light", "add `quads`"]);
    let picture = raystream::image::read_color(&scene.path("a.png")).unwrap();
    assert!(picture.pixels.iter().all(|pixel| *pixel == glam::Vec3::ZERO));
}
