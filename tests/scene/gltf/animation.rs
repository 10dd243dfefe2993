//! Animations of glTFs.

use super::{assert_warns, corners};
use glam::Vec3;
use raystream::scene::{LoadOptions, Scene, SceneError};
use raystream_tests::gltf::{F32, Gltf};
use serde_json::json;
use std::path::Path;
use std::time::Duration;

/// A triangle that an animation moves: from 1 s to 3 s.
fn moving(path: &str, keys: &[[f32; 4]], components: usize, interpolation: &str) -> Gltf {
    let mut gltf = Gltf::triangle();
    // Large, so that the scene is about the origin.
    gltf.node(json!({"mesh": 0, "scale": [9, 9, 9]}));
    let times = gltf.floats(&[[1.0_f32], [3.0]]);
    let numbers: Vec<u8> =
        keys.iter().flat_map(|key| &key[..components]).flat_map(|c| c.to_le_bytes()).collect();
    let kind = ["SCALAR", "VEC2", "VEC3", "VEC4"][components - 1];
    let output = gltf.accessor(&numbers, F32, kind, keys.len());
    gltf.json["animations"] = json!([{
        "samplers": [{"input": times, "output": output, "interpolation": interpolation}],
        "channels": [{"sampler": 0, "target": {"node": 0, "path": path}},
            {"sampler": 0, "target": {"path": "pointer"}}]}]);
    gltf
}

fn posed(gltf: &Gltf, seconds: f32) -> Result<Scene, SceneError> {
    let files = [("a.glb".into(), gltf.glb())].into();
    let at = Some(Duration::from_secs_f32(seconds));
    LoadOptions { at, ..LoadOptions::default() }.load_files(&files, Path::new("a.glb"))
}

#[test]
fn animations_are_shown_at_a_time() {
    let moves = |interpolation: &str, seconds: f32| {
        let keys = [[0.0, 1.0, 0.0, 0.0], [0.4, 0.0, 0.0, 0.0]];
        let gltf = moving("translation", &keys, 3, interpolation);
        corners(&posed(&gltf, seconds).unwrap())[0][0]
    };
    for (seconds, expected) in [
        (0.0, [0.0, 1.0, 0.0]),
        (1.0, [0.0, 1.0, 0.0]),
        (1.5, [0.1, 0.75, 0.0]),
        (3.0, [0.4, 0.0, 0.0]),
        (9.0, [0.4, 0.0, 0.0]),
    ] {
        let found = moves("LINEAR", seconds);
        assert!((found - Vec3::from_array(expected)).length() < 1e-6, "{seconds}: {found}");
    }
    assert_eq!(moves("STEP", 2.9), Vec3::Y);
    // A quarter turn about z, half way.
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let turn = moving("rotation", &[[0.0, 0.0, 0.0, 1.0], [0.0, 0.0, half, half]], 4, "LINEAR");
    let found = corners(&posed(&turn, 2.0).unwrap())[0][1];
    assert!((found - Vec3::new(half, half, 0.0)).length() < 1e-6, "{found}");
    // From 0, which it leaves by 0.5 a second, to 1, where it arrives at rest.
    let keys = [[0.0; 4], [0.0; 4], [0.5, 0.0, 0.0, 0.0], [0.0; 4], [1.0, 0.0, 0.0, 0.0], [0.0; 4]];
    let cubic = moving("translation", &keys, 3, "CUBICSPLINE");
    let found = corners(&posed(&cubic, 2.0).unwrap())[0][0];
    assert!((found - Vec3::X * (0.5 + 0.125 * 0.5 * 2.0)).length() < 1e-6, "{found}");
    assert_eq!(corners(&cubic.scene())[0][0], Vec3::ZERO, "without a time it stands still");
    assert_warns(&cubic.scene(), &["animations are not played"]);
    assert!(posed(&cubic, 2.0).unwrap().warnings.iter().all(|w| !w.contains("animation")));
    assert_warns(&posed(&Gltf::triangle(), 2.0).unwrap(), &["no animation"]);
}

#[test]
fn weights_are_animated_and_broken_animations_are_errors() {
    let mut gltf = moving("weights", &[[0.0; 4], [0.5, 0.0, 0.0, 0.0]], 1, "LINEAR");
    let up = gltf.floats(&[[0.0, 0.0, 1.0], [0.0; 3], [0.0; 3]]);
    gltf.json["meshes"][0]["primitives"][0]["targets"] = json!([{"POSITION": up}]);
    let found = corners(&posed(&gltf, 2.0).unwrap())[0][0];
    assert!((found - Vec3::Z * 0.25).length() < 1e-6, "{found}");
    for (spoil, expected) in [
        ("/animations/0/channels/0/sampler", "samplers[7]"),
        ("/animations/0/channels/0/target/node", "nodes[7]"),
        ("/animations/0/samplers/0/input", "accessors[7]"),
        ("/animations/0/samplers/0/output", "accessors[7]"),
    ] {
        let mut broken = moving("scale", &[[1.0; 4], [2.0; 4]], 3, "LINEAR");
        *broken.json.pointer_mut(spoil).unwrap() = json!(7);
        let message = posed(&broken, 2.0).unwrap_err().to_string();
        assert!(message.contains(expected), "{spoil}: {message}");
    }
    for (keys, expected) in [(3, "9 numbers for 2 keys"), (4, "12 numbers for 2 keys")] {
        let uneven = moving("scale", &vec![[1.0; 4]; keys], 3, "LINEAR");
        let message = posed(&uneven, 2.0).unwrap_err().to_string();
        assert!(message.contains(expected), "{message}");
    }
}
