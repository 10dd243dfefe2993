//! Marks, lines, names and libraries.

use super::{SQUARE, TEXTURED, assert_same, assert_warns, folder, loaded, picture, scene};
use glam::Vec3;
use raystream::scene::Material;
use raystream_tests::scene_folder::{MTL, OBJ, SceneFolder};
use serde_json::json;

#[test]
fn byte_order_marks_are_no_part_of_a_file() {
    let right = loaded(&SceneFolder::new());
    let marked = |text: &str| format!("\u{feff}{text}");
    let json = std::fs::read_to_string(SceneFolder::new().path("scene.json")).unwrap();
    assert_eq!(loaded(&SceneFolder::new().with("a.obj", marked(OBJ))), right);
    assert_eq!(loaded(&SceneFolder::new().with("a.mtl", marked(MTL))), right);
    assert_eq!(loaded(&SceneFolder::new().with("scene.json", marked(&json))), right);
    let first_vertex = OBJ.replace("mtllib a.mtl\n", "") + "mtllib a.mtl\n";
    assert_eq!(loaded(&SceneFolder::new().with("a.obj", marked(&first_vertex))), right);
}

#[test]
fn lines_end_and_go_on_in_any_way() {
    let right = loaded(&SceneFolder::new());
    for end in ["\r\n", "\r", "\r\r\n", " \t\n"] {
        let written = |text: &str| text.replace('\n', end);
        let scene = SceneFolder::new().with("a.obj", written(OBJ)).with("a.mtl", written(MTL));
        assert_eq!(loaded(&scene), right, "{end:?}");
    }
    for end in ["\n", "\r\n", "\r", " \t\n"] {
        // The name `red wall` is broken too, at the same place in both files.
        let going_on = |text: &str| text.replace(' ', &format!(" \\{end}"));
        let scene = SceneFolder::new().with("a.obj", going_on(OBJ)).with("a.mtl", going_on(MTL));
        assert_same(&loaded(&scene), &right);
    }
}

#[test]
fn names_of_any_encoding_stay_apart() {
    // Two names in GBK, two in Latin-1, one in Shift-JIS that ends in the byte of `\`.
    let names: [&[u8]; 5] =
        [b"\xba\xec\xc6\xa1", b"\xc0\xb6\xc6\xa1", b"T\xfcr", b"T\xf6r", b"\x95\\"];
    let obj: Vec<u8> = names
        .iter()
        .flat_map(|name| [b"usemtl ".as_slice(), name, b"\nf 1 2 3\n"].concat())
        .collect();
    let mtl: Vec<u8> = names
        .iter()
        .enumerate()
        .flat_map(|(at, name)| [b"newmtl ", *name, format!("\nKd 0 0 .{at}\n").as_bytes()].concat())
        .collect();
    let obj = [b"mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n".as_slice(), &obj].concat();
    let scene = scene(&obj, &mtl);
    let expected = [0.0, 0.1, 0.2, 0.3, 0.4].map(|blue| Material::diffuse(Vec3::Z * blue));
    assert_eq!(scene.materials, expected);
    assert_eq!(scene.warnings, [""; 0]);
    // A scene file calls such a name as messages do.
    let mirror = json!({"T\\xFCr": {"type": "mirror", "reflectance": [1, 1, 1]}});
    let overridden = loaded(&folder(obj, mtl).json(|scene| scene["materials"] = mirror));
    assert_eq!(overridden.materials[2], Material::mirror(Vec3::ONE));
    assert_eq!(overridden.materials[3], expected[3]);
}

#[test]
fn number_signs_may_be_in_names() {
    let obj = SQUARE.replace("plain", "Material #25");
    let mtl = "newmtl Material #26\nKd 1 0 0\nnewmtl Material #25\nKd 0 0 1\nmap_Kd a#b.png\n";
    let folder = folder(&obj, mtl);
    picture(&folder.path("a#b.png"));
    assert_same(&loaded(&folder), &scene(SQUARE, TEXTURED));
    let commented = TEXTURED.replace("t.png", "t.png # the wall").replace("plain", "plain # x");
    assert_same(&scene(SQUARE, commented), &scene(SQUARE, TEXTURED));
}

#[test]
fn mtllib_may_name_several_files_of_which_the_first_counts() {
    let right = loaded(&SceneFolder::new());
    let with = |statement: &str| {
        let other = "newmtl other\nKd 0 1 0\n";
        let later = MTL.replace("Kd", "Kd 0 0 0\nKd_old");
        let folder = SceneFolder::new()
            .with("a.obj", OBJ.replace("mtllib a.mtl", statement))
            .with("other.mtl", other)
            .with("later.mtl", later)
            .with("my a.mtl", MTL);
        loaded(&folder)
    };
    for statement in [
        "mtllib other.mtl a.mtl",
        "mtllib other.mtl\ta.mtl later.mtl",
        "mtllib a.mtl\nmtllib later.mtl",
        "mtllib \"a.mtl\"",
        "mtllib a.mtl # all of them",
        "mtllib my a.mtl",
        "mtllib \"my a.mtl\" other.mtl",
        "mtllib C:\\models\\a.mtl",
        "mtllib C:\\my models\\a.mtl",
    ] {
        assert_same(&with(statement), &right);
    }
    assert_warns(&with("mtllib a.mtl later.mtl"), &["later.mtl", "defined again", "`red wall`"]);
    assert_warns(&with("mtllib a.mtl gone.mtl"), &["a.obj", "`gone.mtl`", "not there"]);
    assert_warns(&with("mtllib C:\\models\\a.mtl"), &["a.obj", "leads nowhere", "a.mtl is used"]);
}

#[test]
fn a_scene_may_be_read_from_a_stream() {
    let folder = SceneFolder::new();
    let text = std::fs::read_to_string(folder.path("scene.json")).unwrap();
    let absolute =
        text.replace("a.obj", &folder.path("a.obj").to_string_lossy().replace('\\', "/"));
    let read =
        |text: &str| raystream::scene::LoadOptions::default().read(&mut text.as_bytes(), "<input>");
    assert_eq!(read(&absolute).unwrap(), loaded(&folder));
    let error = read(&text.replace("a.obj", "gone.obj")).unwrap_err().to_string();
    assert!(error.contains("<input>: key `obj`: no such file: gone.obj"), "{error}");
}
