//! Compressed views (`EXT_meshopt_compression`): what they stand for, and what broken ones get.

use raystream_tests::meshopt::compressed;
use serde_json::{Value, json};

#[test]
fn compressed_views_are_what_they_stand_for() {
    let scene = compressed().scene();
    let corners = |triangle: usize| scene.meshes[0].corners(triangle).map(|p| p.to_array());
    assert_eq!(scene.triangle_count(), 2);
    assert_eq!(corners(0), [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]]);
    assert_eq!(corners(1), [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.5]]);
}

#[test]
fn any_byte_may_be_wrong_without_a_panic() {
    let good = compressed();
    let mut errors = 0;
    for at in 0..good.binary.len() {
        for wrong in [0, 1, 0x0f, 0x7f, 0x80, 0xe1, 0xf0, 0xfe, 0xff] {
            let mut gltf = good.clone();
            gltf.binary[at] = wrong;
            errors += u32::from(gltf.load().is_err());
        }
    }
    assert!(errors > 20, "{errors}");
}

#[test]
fn what_is_wrong_is_said() {
    let wrong = |change: &dyn Fn(&mut Value)| {
        let mut gltf = compressed();
        let view = gltf.json["bufferViews"].as_array().unwrap().len() - 1;
        change(&mut gltf.json["bufferViews"][view]["extensions"]["EXT_meshopt_compression"]);
        gltf.load().expect_err("it is wrong").to_string()
    };
    for (change, expected) in [
        (json!({"byteLength": 18}), "is cut short"),
        (json!({"byteLength": 1}), "is cut short"),
        (json!({"byteOffset": 1_000_000}), "of a buffer of"),
        (json!({"buffer": 7}), "names buffers[7]"),
        (json!({"buffer": 1}), "has no bytes"),
        (json!({"count": 7}), "has 7 elements of 2 bytes"),
        (json!({"count": u64::MAX}), "elements of 2 bytes"),
        (json!({"byteStride": 3, "count": 4}), "which its mode does not have"),
        (json!({"byteStride": 4, "count": 3}), "bytes more than it needs"),
        (json!({"filter": "OCTAHEDRAL"}), "has a filter"),
        (json!({"mode": "ATTRIBUTES"}), "which its mode does not have"),
        (json!({"mode": "INDICES"}), "begins with 0xe1"),
        (json!({"mode": "NEW"}), "unknown variant"),
    ] {
        let message = wrong(&|extension| {
            extension.as_object_mut().unwrap().extend(change.as_object().unwrap().clone());
        });
        assert!(message.contains(expected), "{change}: {message}");
        assert!(message.contains("bufferViews") || message.contains("buffers"), "{message}");
    }
}
