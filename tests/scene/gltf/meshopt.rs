//! Compressed views (`EXT_meshopt_compression`): what they stand for, and what broken ones get.

use raystream_tests::gltf::{Gltf, U16};
use serde_json::{Value, json};

/// Rows as a stream that stores each difference as a byte.
fn attributes(rows: &[u8], stride: usize) -> Vec<u8> {
    let count = rows.len() / stride;
    let groups = count.div_ceil(16);
    let mut stream = vec![0xa0];
    for column in 0..stride {
        stream.extend(vec![0xff; groups.div_ceil(4)]);
        let mut last = 0_u8;
        for row in 0..groups * 16 {
            let value = if row < count { rows[row * stride + column] } else { last };
            let step = value.wrapping_sub(last) as i8;
            stream.push((step << 1 ^ step >> 7) as u8);
            last = value;
        }
    }
    stream.extend(vec![0; stride.max(32)]);
    stream
}

/// Adds a compressed view; the one that it stands for lies in a buffer without bytes.
pub fn add(gltf: &mut Gltf, stream: &[u8], [count, stride]: [usize; 2], more: Value) -> usize {
    let stored = gltf.view(stream);
    let mut extension = gltf.json["bufferViews"][stored].clone();
    extension["byteStride"] = json!(stride);
    extension["count"] = json!(count);
    extension.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
    if gltf.json["buffers"].as_array().unwrap().len() < 2 {
        let fallback = json!({"EXT_meshopt_compression": {"fallback": true}});
        gltf.add("buffers", json!({"byteLength": 100_000, "extensions": fallback}));
    }
    gltf.json["extensionsUsed"] = json!(["EXT_meshopt_compression"]);
    gltf.json["extensionsRequired"] = json!(["EXT_meshopt_compression"]);
    let extensions = json!({"EXT_meshopt_compression": extension});
    let view = json!({"buffer": 1, "byteLength": count * stride, "extensions": extensions});
    gltf.add("bufferViews", view)
}

/// Two triangles whose positions and indices are compressed.
pub fn compressed() -> Gltf {
    let mut gltf = Gltf::new().with_camera();
    let corners = [[0.0_f32, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.5]];
    let bytes: Vec<u8> = corners.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
    let view = add(&mut gltf, &attributes(&bytes, 12), [4, 12], json!({"mode": "ATTRIBUTES"}));
    let positions = gltf.add(
        "accessors",
        json!({"bufferView": view, "componentType": 5126, "type": "VEC3", "count": 4}),
    );
    // Three new vertices, then one at the edge from 0 to 2.
    let triangles = [&[0xe1, 0xf0, 0x00][..], &[0; 16]].concat();
    let view = add(&mut gltf, &triangles, [6, 2], json!({"mode": "TRIANGLES"}));
    let indices = gltf.add(
        "accessors",
        json!({"bufferView": view, "componentType": U16, "type": "SCALAR", "count": 6}),
    );
    let mesh = gltf.mesh(json!({"attributes": {"POSITION": positions}, "indices": indices}));
    gltf.node(json!({"mesh": mesh}));
    gltf
}

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
