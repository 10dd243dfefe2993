//! Cameras, lights and extensions.

use super::assert_warns;
use glam::Vec3;
use raystream::scene::{Environment, FilmSize, Projection, PunctualLight};
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
    let Projection::Perspective { fov_y, lens: None } = scene.camera.projection else {
        panic!("{:?}", scene.camera.projection);
    };
    assert!((f64::from(fov_y) - 0.7_f64.to_degrees()).abs() < 1e-5);
}

#[test]
fn cameras_are_chosen_by_their_names() {
    let mut gltf = Gltf::triangle();
    gltf.node(json!({"camera": 0, "name": "side", "translation": [5, 0, 0]}));
    gltf.node(json!({"camera": 0, "name": "side", "translation": [6, 0, 0]}));
    gltf.add(
        "cameras",
        json!({"type": "orthographic",
        "orthographic": {"xmag": 2, "ymag": 1, "znear": 0, "zfar": 9}}),
    );
    gltf.node(json!({"camera": 1, "name": "plan"}));
    let mut scene = gltf.scene();
    let names: Vec<_> = scene.cameras.iter().map(|camera| camera.name.as_str()).collect();
    assert_eq!(names, ["front", "side", "side 2", "plan"]);
    assert_eq!(scene.camera.origin, Vec3::Z * 5.0);
    assert_warns(&scene, &["several cameras", "`side 2`", "`front` is used"]);
    scene.use_camera("side 2").unwrap();
    assert_eq!(scene.camera.origin, Vec3::X * 6.0);
    scene.use_camera("plan").unwrap();
    assert_eq!(scene.camera.projection, Projection::Orthographic { width: 4.0 });
    assert_eq!(scene.film, FilmSize { width: 800, height: 400 });
    let message = scene.use_camera("back").unwrap_err().to_string();
    assert!(message.contains("`back`") && message.contains("`front`, `side`"), "{message}");
}

#[test]
fn what_has_neither_camera_nor_light_gets_both() {
    let mut gltf = Gltf::triangle();
    let scene = gltf.scene();
    assert_eq!(scene.environment, Some(Environment::studio()));
    assert_warns(&scene, &["a.glb: it has no light that is shown; it is lit by a soft studio"]);
    gltf.json["nodes"][1].as_object_mut().unwrap().remove("camera");
    let mut scene = gltf.scene();
    assert_warns(&scene, &["it has no camera that is shown"]);
    assert_eq!(scene.film, FilmSize { width: 800, height: 600 });
    assert!(scene.camera.origin.z > 1.0 && scene.check().is_ok());
    // Another environment takes the place of the studio, and of its warning.
    scene.set_environment(Environment::new(1, 1, vec![Vec3::X]));
    assert_eq!(scene.warnings.len(), 1, "{:?}", scene.warnings);
}

#[test]
fn points_spots_and_suns_shine_where_their_nodes_are() {
    let mut gltf = Gltf::triangle();
    gltf.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [
        {"type": "point", "name": "bulb", "extras": {"x": 1}, "intensity": 4, "range": 3},
        {"type": "spot", "color": [1, 0.5, 0], "spot": {"outerConeAngle": 0.5}},
        {"type": "directional"},
    ]}});
    // A quarter turn about y: -z becomes -x.
    let half = std::f32::consts::FRAC_1_SQRT_2;
    for light in 0..3 {
        gltf.node(json!({
            "translation": [1, 2, 3], "rotation": [0, half, 0, half],
            "extensions": {"KHR_lights_punctual": {"light": light}},
        }));
    }
    let scene = gltf.scene();
    let place = Vec3::new(1.0, 2.0, 3.0);
    let [point, spot, sun] = scene.punctual_lights[..] else {
        panic!("{:?}", scene.punctual_lights);
    };
    assert_eq!(point, PunctualLight::point(place, Vec3::splat(4.0)));
    let PunctualLight::Spot { position, direction, intensity, inner_angle, outer_angle } = spot
    else {
        panic!("{spot:?}");
    };
    assert_eq!((position, intensity), (place, Vec3::new(1.0, 0.5, 0.0)));
    assert!((direction - Vec3::NEG_X).length() < 1e-6, "{direction}");
    assert_eq!((inner_angle, outer_angle), (0.0, 0.5_f32.to_degrees()));
    let PunctualLight::Directional { direction, irradiance, angle } = sun else {
        panic!("{sun:?}");
    };
    assert_eq!((irradiance, angle), (Vec3::ONE, 0.0));
    assert!((direction - Vec3::NEG_X).length() < 1e-6, "{direction}");
    assert_warns(&scene, &["without a range: that of 1 lights"]);
    assert_eq!(scene.environment, None, "it has light");
}

#[test]
fn lights_that_cannot_be_are_refused() {
    for (light, what) in [
        (json!({"type": "bulb"}), "of no type"),
        (json!({"type": "point", "color": [-1, 0, 0]}), "intensity"),
        (json!({"type": "spot", "spot": {"innerConeAngle": 2, "outerConeAngle": 1}}), "angle"),
    ] {
        let mut gltf = Gltf::triangle();
        gltf.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [light]}});
        gltf.node(json!({"extensions": {"KHR_lights_punctual": {"light": 0}}}));
        let message = gltf.load().unwrap_err().to_string();
        assert!(message.contains("lights[0]") && message.contains(what), "{message}");
    }
}

#[test]
fn extensions_that_are_not_read_are_said_or_refused() {
    let mut gltf = Gltf::triangle();
    gltf.json["extensionsUsed"] = json!(["VENDOR_x", "KHR_materials_ior"]);
    assert_warns(&gltf.scene(), &["these extensions are not read: `VENDOR_x`."]);
    gltf.json["extensionsRequired"] = json!(["KHR_texture_basisu", "KHR_materials_ior"]);
    let message = gltf.load().unwrap_err().to_string();
    assert!(message.contains("a.glb: requires `KHR_texture_basisu`,"), "{message}");
    assert!(message.ends_with("export it without"), "{message}");
}

#[test]
fn textures_that_require_ktx2_are_named_with_what_to_do() {
    let mut gltf = Gltf::triangle();
    gltf.add("images", json!({"uri": "wood.png"}));
    gltf.add("images", json!({"uri": "wood.ktx2", "mimeType": "image/ktx2"}));
    gltf.add("textures", json!({"source": 0}));
    gltf.add("textures", json!({"extensions": {"KHR_texture_basisu": {"source": 1}}}));
    gltf.json["extensionsUsed"] = json!(["KHR_texture_basisu"]);
    gltf.json["extensionsRequired"] = json!(["KHR_texture_basisu"]);
    let message = gltf.load().unwrap_err().to_string();
    for part in
        ["requires `KHR_texture_basisu`,", "of `textures[1]` are KTX2", "PNG", "ktxdecompress"]
    {
        assert!(message.contains(part), "{message}");
    }
    // That is not for what requires another one.
    gltf.json["extensionsRequired"] = json!(["VENDOR_x"]);
    assert!(gltf.load().unwrap_err().to_string().ends_with("export it without"));
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
