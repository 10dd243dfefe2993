//! Cameras, lights and extensions.

use super::assert_warns;
use glam::Vec3;
use raystream::scene::{Environment, FilmSize};
use raystream_tests::gltf::Gltf;
use serde_json::json;

#[test]
fn a_camera_looks_where_its_node_does() {
    let mut gltf = Gltf::triangle();
    // A quarter turn about y: -z becomes -x. How large it is does not matter.
    let half = std::f32::consts::FRAC_1_SQRT_2;
    gltf.json["nodes"][1]["rotation"] = json!([0, half, 0, half]);
    gltf.json["nodes"][1]["scale"] = json!([3, 3, 3]);
    let scene = gltf.scene();
    let view = (scene.camera.target - scene.camera.origin).normalize();
    assert!((view - Vec3::NEG_X).length() < 1e-6, "{view}");
    assert!((scene.camera.up - Vec3::Y).length() < 1e-6);
    assert_eq!(scene.film, FilmSize { width: 800, height: 640 });
    assert!((f64::from(scene.camera.fov_y) - 0.7_f64.to_degrees()).abs() < 1e-5);
}

#[test]
fn cameras_are_chosen_by_their_names() {
    let mut gltf = Gltf::triangle();
    gltf.node(json!({"camera": 0, "name": "side", "translation": [5, 0, 0]}));
    gltf.node(json!({"camera": 0, "name": "side", "translation": [6, 0, 0]}));
    gltf.add(
        "cameras",
        json!({"type": "orthographic",
        "orthographic": {"xmag": 1, "ymag": 1, "znear": 0, "zfar": 9}}),
    );
    gltf.node(json!({"camera": 1, "name": "plan"}));
    let mut scene = gltf.scene();
    let names: Vec<_> = scene.cameras.iter().map(|camera| camera.name.as_str()).collect();
    assert_eq!(names, ["front", "side", "side 2"]);
    assert_eq!(scene.camera.origin, Vec3::Z * 5.0);
    assert_warns(&scene, &["several cameras", "`side 2`", "`front` is used"]);
    assert_warns(&scene, &["orthographic", "`plan`"]);
    scene.use_camera("side 2").unwrap();
    assert_eq!(scene.camera.origin, Vec3::X * 6.0);
    let message = scene.use_camera("plan").unwrap_err().to_string();
    assert!(message.contains("`plan`") && message.contains("`front`, `side`"), "{message}");
}

#[test]
fn what_has_neither_camera_nor_light_gets_both() {
    let mut gltf = Gltf::triangle();
    let scene = gltf.scene();
    assert_eq!(scene.environment, Some(Environment::white()));
    assert_warns(&scene, &["a.glb: it has no light that is shown"]);
    gltf.json["nodes"][1].as_object_mut().unwrap().remove("camera");
    let mut scene = gltf.scene();
    assert_warns(&scene, &["it has no camera that is shown"]);
    assert_eq!(scene.film, FilmSize { width: 800, height: 600 });
    assert!(scene.camera.origin.z > 1.0 && scene.check().is_ok());
    // Another environment takes the place of the white one, and of its warning.
    scene.set_environment(Environment::new(1, 1, vec![Vec3::X]));
    assert_eq!(scene.warnings.len(), 1, "{:?}", scene.warnings);
}

#[test]
fn lights_that_do_not_shine_are_said() {
    let mut gltf = Gltf::triangle();
    gltf.json["extensions"] = json!({"KHR_lights_punctual": {"lights":
        [{"type": "point", "name": "bulb", "extras": {"x": 1}}]}});
    gltf.node(json!({"extensions": {"KHR_lights_punctual": {"light": 0}}}));
    let scene = gltf.scene();
    assert_warns(&scene, &["suns do not shine here: 1."]);
    assert!(format!("{:?}", scene.details).contains("`bulb`"), "{:?}", scene.details);
}

#[test]
fn extensions_that_are_not_read_are_said_or_refused() {
    let mut gltf = Gltf::triangle();
    gltf.json["extensionsUsed"] = json!(["VENDOR_x", "KHR_materials_ior"]);
    assert_warns(&gltf.scene(), &["these extensions are not read: `VENDOR_x`."]);
    gltf.json["extensionsRequired"] = json!(["KHR_draco_mesh_compression", "KHR_materials_ior"]);
    let message = gltf.load().unwrap_err().to_string();
    assert!(message.contains("a.glb: requires `KHR_draco_mesh_compression`,"), "{message}");
}

#[test]
fn extras_may_be_anything() {
    let mut gltf = Gltf::triangle();
    for extras in [json!(3), json!("x"), json!([1, {}]), json!({"a": null})] {
        gltf.json["extras"] = extras.clone();
        gltf.json["meshes"][0]["extras"] = extras.clone();
        gltf.json["asset"]["extras"] = extras;
        assert_eq!(gltf.scene().triangle_count(), 1);
    }
}
