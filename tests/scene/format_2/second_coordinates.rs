//! Textures that lie by the second texture coordinates of a PLY.

use super::{SQUARE, folder, material, whole};
use glam::Vec2;
use raystream::scene::{CoordinateSet, Material, Placement, Principled, TextureId};
use raystream_tests::{prepare, render, settings};
use serde_json::{Value, json};

/// A square with two sets of texture coordinates: the second is the first, turned.
const TWO_SETS: &str = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\n\
    property float y\nproperty float z\nproperty float s\nproperty float t\nproperty float s1\n\
    property float t1\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
    0 0 0 0 0 0 1\n1 0 0 1 0 0 0\n1 1 0 1 1 1 0\n0 1 0 0 1 1 1\n4 0 1 2 3\n";

#[test]
fn textures_take_the_second_coordinates_where_that_is_asked_for() {
    let mut file = whole();
    file["meshes"][1] = json!({"file": "two.ply", "material": "glow",
        "transform": {"scale": [-1, 1, 1]}});
    file["materials"]["glow"]["textures"] = json!({
        "roughness": {"file": "t.png", "channel": "green", "set": "second",
            "transform": {"translate": [0.5, 0]}},
        "metallic": {"file": "t.png", "channel": "blue", "set": "first"}});
    let load = |file: &Value| folder(file).with("two.ply", TWO_SETS).load().unwrap();
    let scene = load(&file);
    assert!(scene.check().is_ok());
    let mesh = &scene.meshes[2];
    let (first, second) = (&mesh.texture_coordinates, &mesh.second_coordinates);
    let (first, second) = (first.as_ref().unwrap(), second.as_ref().unwrap());
    for (first, second) in first.as_flattened().iter().zip(second.as_flattened()) {
        assert_eq!(*second, Vec2::new(first.y, 1.0 - first.x));
    }
    let Material::Principled(Principled { maps, .. }) = material(&scene, 2) else { panic!() };
    let placement = |texture: TextureId| scene.textures[texture.0 as usize].placement;
    let (set, offset) = (CoordinateSet::Second, Vec2::new(0.5, 0.0));
    let expected = Placement { set, offset, ..Placement::default() };
    assert_eq!(placement(maps.roughness.unwrap().texture), expected);
    assert_eq!(placement(maps.metallic.unwrap().texture), Placement::default());
    assert_eq!(placement(maps.base_colour.unwrap()), Placement::default());
    // What nothing takes is not kept.
    file["materials"]["glow"]["textures"]["roughness"]["set"] = json!("first");
    assert_eq!(load(&file).meshes[2].second_coordinates, None);
    file["materials"]["glow"]["textures"] = json!({});
    file["materials"]["glow"]["reflectance"]["set"] = json!("second");
    let scene = load(&file);
    let Material::Principled(Principled { maps, .. }) = material(&scene, 2) else { panic!() };
    let texture = maps.base_colour.unwrap();
    assert_eq!(scene.textures[texture.0 as usize].placement.set, set);
}

/// A picture in the second coordinates is that of a mesh whose first ones are these.
#[test]
fn second_coordinates_say_where_a_picture_lies() {
    let film = |ply: &str, set: &str| {
        let mut file = whole();
        file["meshes"] = json!([{"file": "two.ply", "material": "paint"}]);
        file["materials"] = json!({"paint": {"type": "diffuse",
            "reflectance": {"texture": "four.png", "set": set}}});
        let folder = folder(&file).with("two.ply", ply);
        let texel = |x: u32, y: u32| image::Rgb([(200 * x) as u8, (200 * y) as u8, 100]);
        image::RgbImage::from_fn(2, 2, texel).save(folder.path("four.png")).unwrap();
        let scene = folder.load().unwrap();
        render(&prepare(&scene), &settings(&scene), 4).radiance
    };
    let only_second = TWO_SETS
        .replace("float s\n", "float a\n")
        .replace("float t\n", "float b\n")
        .replace("float s1", "float s")
        .replace("float t1", "float t");
    let by_second = film(TWO_SETS, "second");
    assert!(by_second == film(&only_second, "first"));
    assert!(by_second != film(TWO_SETS, "first"));
}

#[test]
fn second_coordinates_that_are_not_there_are_missed() {
    let mut scene = whole();
    scene["materials"]["glow"]["textures"]["roughness"]["set"] = json!("second");
    let with = |name: &str, text: &str| {
        let mut scene = scene.clone();
        scene["meshes"][1] = json!({"file": name, "material": "glow"});
        folder(&scene).with(name, text)
    };
    for (name, text) in
        [("square.obj", SQUARE), ("a.ply", &TWO_SETS.replace("float t1", "float t2"))]
    {
        let message = with(name, text).error();
        for part in ["key `meshes[1].file`", "no second texture coordinates", "s1 and t1"] {
            assert!(message.contains(part), "{message}");
        }
    }
    // What has no first ones has none: the mean of the texture is shown.
    let warnings = with("a.ply", &TWO_SETS.replace("float s\n", "float a\n")).load().unwrap();
    let warnings = format!("{:?}", warnings.warnings);
    assert!(warnings.contains("mean of their texture"), "{warnings}");
    // What has no digits left counts as 0.
    let strange = TWO_SETS.replace("0 0 0 0 0 0 1\n", "0 0 0 0 0 1e30 -1e30\n");
    let scene = with("a.ply", &strange).load().unwrap();
    let second = scene.meshes[2].second_coordinates.as_ref().unwrap();
    assert_eq!(second[0][0], Vec2::ZERO);
}
