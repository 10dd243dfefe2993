//! What is wrong in files of format 2, and how it is named.

use super::{folder, whole};
use serde_json::{Value, json};

/// Puts each value at its place in a scene, and asserts that the error says all its parts.
fn assert_named(cases: &[(&str, Value, &[&str])]) {
    for (at, value, parts) in cases {
        let mut scene = whole();
        let (parent, key) = at.rsplit_once('/').unwrap();
        scene.pointer_mut(parent).unwrap()[key] = value.clone();
        let message = folder(&scene).error();
        for part in *parts {
            assert!(message.contains(part), "{at}: {message:?} does not say {part:?}");
        }
    }
}

#[test]
fn what_is_wrong_with_meshes_and_materials_is_named() {
    assert_named(&[
        ("/format", json!(3), &["formats 1 and 2, not 3"]),
        ("/obj", json!("a.obj"), &["unknown field `obj`"]),
        ("/meshes/0/file", json!("b.obj"), &["key `meshes[0].file`", "no such file", "b.obj"]),
        (
            "/meshes/0/material",
            json!("wal"),
            &["key `meshes[0].material`", "`wal`", "`glow`, `wall`"],
        ),
        (
            "/meshes/1/materials/middle",
            json!("wall"),
            &["meshes[1].materials", "`middle`", "`left`"],
        ),
        ("/meshes/0/transform", json!([1]), &["meshes[0].transform", "an object {...}"]),
        ("/meshes/0/transform/scale", json!(0), &["meshes[0].transform", "determinant"]),
        ("/meshes/0/transform/translate", json!([1e13, 0, 0]), &["meshes[0].transform.translate"]),
        ("/materials/wall/textures", json!({}), &["a diffuse material has no key `textures`"]),
        ("/materials/wall/f90", json!(0.5), &["a diffuse material has no key `f90`"]),
        ("/materials/glow/f90", json!(1.5), &["materials.glow", "f90", "from 0 to 1"]),
    ]);
}

#[test]
fn what_is_wrong_with_textures_is_named() {
    assert_named(&[
        (
            "/materials/glow/textures/normal/file",
            json!("n.png"),
            &["materials.glow.textures.normal.file", "no such file"],
        ),
        (
            "/materials/glow/textures/metallic/channel",
            json!("grey"),
            &["unknown variant `grey`", "`red`"],
        ),
        (
            "/materials/glow/textures/emission/filter",
            json!("cubic"),
            &["unknown variant `cubic`", "`nearest`"],
        ),
        (
            "/materials/glow/textures/emission/set",
            json!("third"),
            &["unknown variant `third`", "`first`", "`second`"],
        ),
        (
            "/materials/glow/textures/sheen",
            json!({"file": "t.png", "transform": {"scale": [1]}}),
            &["two numbers"],
        ),
        (
            "/materials/glow/textures/coat",
            json!({"file": "t.png"}),
            &["materials.glow", "missing field `channel`"],
        ),
        (
            "/materials/glow/textures/anisotropy",
            json!({"file": "u.png"}),
            &["materials.glow.textures.anisotropy.file", "no such file"],
        ),
        (
            "/materials/glow/textures/coat_normal",
            json!({"file": "t.png", "scale": 1e5}),
            &["must be from -10000"],
        ),
        (
            "/materials/glow/textures/bump",
            json!({"file": "t.png"}),
            &["materials.glow", "missing field `height`"],
        ),
        (
            "/materials/glow/textures/bump",
            json!({"file": "t.png", "height": 1e5}),
            &["height", "must be from -10000"],
        ),
        (
            "/materials/glow/textures/bump",
            json!({"file": "t.png", "height": 1}),
            &["materials.glow", "`normal` or `bump`, not both"],
        ),
    ]);
}

#[test]
fn what_is_wrong_with_lights_and_cameras_is_named() {
    assert_named(&[
        ("/lights/0/angle", json!(1), &["lights[0]", "a point light has no key `angle`"]),
        (
            "/lights/1/inner_angle",
            json!(40),
            &["lights[1]", "inner_angle", "from 0 to outer_angle"],
        ),
        ("/lights/2/direction", json!([0, 0, 0]), &["lights[2]", "direction is zero"]),
        ("/lights/2/irradiance", json!([0, -1, 0]), &["lights[2].irradiance", "from 0 to"]),
        ("/environment", json!({}), &["environment", "needs the key `file`"]),
        ("/environment/file", json!("x.hdr"), &["key `environment.file`", "no such file"]),
        ("/environment/file", json!("t.png"), &["t.png", "neither a Radiance HDR nor an EXR"]),
        ("/background", json!([1, 1]), &["key `background`", "three numbers"]),
        ("/camera/aperture", json!(-1), &["camera.aperture", "from 0 to"]),
        ("/camera/blades", json!(2), &["camera.blades", "from 3 to 64"]),
        ("/camera/focus", json!(0), &["camera.focus", "above 0"]),
        ("/camera/width", json!(3), &["a perspective camera has no key `width`"]),
        ("/camera/type", json!("fisheye"), &["camera.type", "unknown variant", "`panorama`"]),
        ("/camera/type", json!("orthographic"), &["an orthographic camera has no key `fov_y`"]),
    ]);
    let mut pinhole = whole();
    pinhole["camera"].as_object_mut().unwrap().remove("aperture");
    assert!(folder(&pinhole).error().contains("`focus` needs a lens"));
    let mut without_angle = whole();
    without_angle["camera"] = json!({"origin": [0, 0, 5], "target": [0, 0, 0], "up": [0, 1, 0]});
    assert!(folder(&without_angle).error().contains("needs the key `fov_y`"));
}
