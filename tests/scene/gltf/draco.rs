//! Compressed primitives (`KHR_draco_mesh_compression`): what they stand for, and what broken ones
//! get.

use raystream::scene::Scene;
use raystream_tests::draco::{compressed, plain};
use serde_json::{Value, json};

/// What each corner of each triangle has, in an order that does not depend on that of the file.
fn corners(scene: &Scene) -> Vec<Vec<f32>> {
    let mesh = &scene.meshes[0];
    let mut triangles: Vec<Vec<f32>> = (0..mesh.triangles.len())
        .map(|index| {
            let positions = mesh.corners(index);
            let [normals, uvs, colours] = [
                mesh.normals.as_ref().unwrap()[index].map(|n| n.to_array().to_vec()),
                mesh.texture_coordinates.as_ref().unwrap()[index].map(|uv| uv.to_array().to_vec()),
                mesh.colours.as_ref().unwrap()[index].map(|c| c.to_array().to_vec()),
            ];
            let mut all: Vec<Vec<f32>> = (0..3)
                .map(|k| {
                    let position = positions[k].to_array();
                    [&position[..], &normals[k][..], &uvs[k][..], &colours[k][..]].concat()
                })
                .collect();
            // The first corner is the one with the least texture coordinates: those are exact.
            let key = |corner: &Vec<f32>| (1000.0 * corner[6] + 10.0 * corner[7]).round() as i32;
            let first = (0..3).min_by_key(|&k| key(&all[k])).unwrap();
            all.rotate_left(first);
            all.concat()
        })
        .collect();
    triangles.sort_by(|a, b| {
        let key = |t: &[f32]| [6, 7, 18, 19, 30, 31].map(|k| (100.0 * t[k]).round() as i32);
        key(a).cmp(&key(b))
    });
    triangles
}

fn worst(a: &Scene, b: &Scene) -> f32 {
    let (a, b) = (corners(a).concat(), corners(b).concat());
    assert_eq!(a.len(), b.len());
    a.iter().zip(&b).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

#[test]
fn compressed_primitives_are_what_they_stand_for() {
    let expected = plain().scene();
    assert_eq!(expected.triangle_count(), 50);
    // From sequential to the densest.
    for level in [0, 3, 7, 10] {
        let found = compressed(level, None).scene();
        let difference = worst(&found, &expected);
        assert!(difference <= 1e-6, "level {level}: {difference}");
        let found = compressed(level, Some(8)).scene();
        let difference = worst(&found, &expected);
        assert!((1e-4..3e-3).contains(&difference), "level {level}: {difference}");
    }
}

#[test]
fn any_byte_may_be_wrong_without_a_panic() {
    for level in [0, 7, 10] {
        let good = compressed(level, Some(11));
        let mut errors = 0;
        for at in 0..good.binary.len() {
            for wrong in [0, 1, 0x0f, 0x7f, 0x80, 0xf0, 0xff] {
                let mut gltf = good.clone();
                gltf.binary[at] = wrong;
                errors += u32::from(gltf.load().is_err());
            }
        }
        assert!(errors > 20, "level {level}: {errors}");
    }
}

#[test]
fn what_is_wrong_is_said() {
    for (change, expected) in [
        (json!({"bufferView": 99}), "names bufferViews[99]"),
        (json!({"bufferView": "a"}), "cannot be read"),
        (json!({"attributes": {"POSITION": 9}}), "names attribute 9"),
        (json!({"attributes": {"POSITION": 2}}), "has 2 components, but accessors[0] 3"),
    ] {
        let mut gltf = compressed(7, None);
        let primitive = &mut gltf.json["meshes"][0]["primitives"][0];
        let extension = &mut primitive["extensions"]["KHR_draco_mesh_compression"];
        let more: &serde_json::Map<String, Value> = change.as_object().unwrap();
        extension.as_object_mut().unwrap().extend(more.clone());
        let message = gltf.load().expect_err("it is wrong").to_string();
        assert!(message.contains(expected), "{change}: {message}");
        assert!(message.contains("meshes[0].primitives[0]"), "{message}");
    }
    let mut short = compressed(7, None);
    let view = short.json["bufferViews"].as_array().unwrap().len() - 1;
    short.json["bufferViews"][view]["byteLength"] = json!(20);
    let message = short.load().expect_err("it is cut short").to_string();
    assert!(message.contains("cannot be decoded"), "{message}");
}
