//! What no scene is made of.

use crate::scene::errors::expect;
use raystream_tests::scene_folder::{MTL, OBJ, SceneFolder};
use serde_json::json;

#[test]
fn what_is_unusable_is_an_error_where_it_is_used() {
    let v = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    let smooth = SceneFolder::new()
        .with("a.obj", format!("{v}vn 0 nan 1\nf 1//1 2//1 3//1\n"))
        .json(|scene| scene["normals"] = json!("smooth"));
    expect(smooth, &["a.obj", "line 4", "`nan`"]);
    let textured = SceneFolder::new()
        .with("a.obj", format!("mtllib a.mtl\n{v}vt x 0\nusemtl plain\nf 1/1 2/1 3/1\n"))
        .with("a.mtl", "newmtl plain\nmap_Kd x.png\n");
    image::RgbImage::new(1, 1).save(textured.path("x.png")).unwrap();
    expect(textured, &["a.obj", "line 5", "`x` is not a number"]);
}

#[test]
fn text_of_two_bytes_a_character_is_named() {
    let wide = |text: &str| -> Vec<u8> {
        "\u{feff}".encode_utf16().chain(text.encode_utf16()).flat_map(u16::to_le_bytes).collect()
    };
    expect(SceneFolder::new().with("a.obj", wide(OBJ)), &["a.obj", "UTF-16", "save it as UTF-8"]);
    expect(SceneFolder::new().with("a.mtl", wide(MTL)), &["a.mtl", "UTF-16", "save it as UTF-8"]);
    let json = std::fs::read_to_string(SceneFolder::new().path("scene.json")).unwrap();
    expect(SceneFolder::new().with("scene.json", wide(&json)), &["scene.json", "UTF-16"]);
    expect(SceneFolder::new().with("a.obj", [0; 4096]), &["a.obj", "not a text file"]);
}

#[test]
fn files_of_other_kinds_are_named() {
    let given = |name: &str, content: &str| {
        let folder = SceneFolder::new().with(name, content);
        raystream::scene::load(&folder.path(name)).unwrap_err().to_string()
    };
    for (name, content, kind) in [
        ("ball.mtl", MTL, "is an MTL"),
        ("ball.fbx", "Kaydara FBX", "another format (fbx)"),
        ("ball.png", "\u{89}PNG", "is a picture"),
    ] {
        let message = given(name, content);
        assert!(message.contains(kind) && message.contains(name), "{message}");
        assert!(message.contains("an OBJ, or a JSON file that names some"), "{message}");
    }
    let folder = SceneFolder::new();
    let message = raystream::scene::load(&folder.path("")).unwrap_err().to_string();
    assert!(message.contains("it is a folder"), "{message}");
}

#[test]
fn what_takes_too_much_memory_is_refused() {
    use raystream::scene::LoadOptions;
    let options = |max_memory| LoadOptions { max_memory, ..LoadOptions::default() };
    let folder = SceneFolder::new().with("a.obj", format!("{OBJ}{}", "f 1 2 3\n".repeat(100_000)));
    let path = folder.path("scene.json");
    let message = options(32 << 20).load(&path).unwrap_err().to_string();
    assert!(message.contains("a.obj, line ") && message.contains("32 MiB"), "{message}");
    assert!(options(1 << 30).load(&path).is_ok());
    let message = options(1 << 20).load(&path).unwrap_err().to_string();
    assert!(message.contains("a.obj: has more than 256 KiB"), "{message}");
    let message = options(1024).load(&path).unwrap_err().to_string();
    assert!(message.contains("scene.json: has more than 8 bytes"), "{message}");
    let endless = options(1 << 20).read(&mut std::io::repeat(b' '), "<input>").unwrap_err();
    assert!(endless.to_string().contains("<input>: has more than 8 KiB"), "{endless}");
}
