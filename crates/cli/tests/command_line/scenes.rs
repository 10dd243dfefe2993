//! Scenes that do not load, and those that load with a warning; the library's tests know every
//! message, here is one of each kind.

use crate::program::{names, render, run};
use raystream_tests::scene_folder::{MTL, OBJ, SceneFolder};
use serde_json::{Value, json};

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
    refused(&SceneFolder::new().with("scene.json", "v 0 0 0"), &["scene.json", "is an OBJ"]);
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
    warned(&broken, &["a.mtl", "wall.png", "cannot be read", "Kd"]);
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

#[test]
fn without_light_the_picture_is_black() {
    let scene = SceneFolder::new().json(|scene| scene["quads"] = json!([]));
    warned(&scene, &["scene.json", "nothing emits light", "add `quads`"]);
    let picture = raystream::image::read_color(&scene.path("a.png")).unwrap();
    assert!(picture.pixels.iter().all(|pixel| *pixel == glam::Vec3::ZERO));
}
