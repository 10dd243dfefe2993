//! An OBJ that is given as a scene, with its MTL and textures and nothing besides.

use super::{SQUARE, TEXTURED, assert_same, assert_warns, folder, loaded, picture};
use raystream::scene::{LoadOptions, Scene, load};
use raystream_tests::scene_folder::SceneFolder;
use std::io::Cursor;

fn alone(folder: &SceneFolder) -> Scene {
    load(&folder.path("a.obj")).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn it_is_what_a_scene_file_makes_of_it() {
    let folder = folder(SQUARE, TEXTURED);
    let scene = alone(&folder);
    assert_same(&scene, &loaded(&folder));
    assert_eq!((scene.name.as_str(), scene.triangle_count()), ("a", 2));
    assert_warns(&scene, &["a.obj", "no camera"]);
}

/// [`LoadOptions::load`] frames all formats by the same function, which its own test is of.
#[test]
fn all_of_it_is_seen() {
    let scene = alone(&folder(SQUARE, TEXTURED));
    let mut framed = scene.clone();
    framed.frame_all();
    assert_eq!((scene.camera, scene.film), (framed.camera, framed.film));
    assert!((scene.camera.target - glam::Vec3::new(1.0, 1.0, 0.0)).length() < 1e-6);
}

#[test]
fn it_is_lit_unless_it_glows() {
    let dark = alone(&folder(SQUARE, TEXTURED));
    assert!(dark.environment.is_some());
    assert_warns(&dark, &["a.obj", "none of it emits light", "soft studio"]);
    let bright = alone(&folder(SQUARE, "newmtl plain\nKe 1 1 1\n"));
    assert!(bright.environment.is_none() && bright.emits());
    assert!(!bright.warnings.iter().any(|warning| warning.contains("studio")));
}

#[test]
fn its_content_says_what_it_is_where_its_name_does_not() {
    let folder = SceneFolder::new().with("ball.txt", SQUARE).with("a.mtl", TEXTURED);
    picture(&folder.path("t.png"));
    assert_eq!(load(&folder.path("ball.txt")).unwrap().textures.len(), 1);
    let piped = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let scene = LoadOptions::default().read(&mut Cursor::new(piped), "<input>").unwrap();
    assert_eq!(scene.triangle_count(), 1);
}

#[test]
fn what_is_wrong_is_said_by_name() {
    let said = |obj: &str| {
        let folder = SceneFolder::new().with("a.obj", obj);
        load(&folder.path("a.obj")).unwrap_err().to_string()
    };
    for (obj, parts) in [
        ("", ["a.obj", "no faces"]),
        ("{\"format\": 1}", ["a.obj", "looks like a scene file"]),
        ("v 0 0 0\nf 1 2 3\n", ["a.obj", "line 2"]),
        ("v 0 0 0\nv 1 0 0\nv 0 nan 0\nf 1 2 3\n", ["a.obj", "line "]),
    ] {
        let message = said(obj);
        assert!(parts.iter().all(|part| message.contains(part)), "{message}");
    }
}
