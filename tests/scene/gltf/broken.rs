//! Broken files: an error that says where, or a scene, but never a panic.

use raystream::scene::LoadOptions;
use raystream_tests::gltf::{Gltf, U8, glb, load_bytes};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::Path;

/// A file with something of everything.
pub fn everything() -> Gltf {
    let mut gltf = Gltf::triangle();
    let normals = gltf.floats(&[[0.0, 0.0, 1.0]; 3]);
    let uvs = gltf.floats(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]);
    let scales = gltf.floats(&[[1.0, 2.0, 1.0]; 3]);
    let colours = gltf.floats(&[[1.0, 0.5, 0.5, 1.0]; 3]);
    let indices = gltf.indices(&[0, 1, 2]);
    let joints = gltf.accessor(&[0; 12], U8, "VEC4", 3);
    let weights = gltf.floats(&[[1.0, 0.0, 0.0, 0.0]; 3]);
    let bind = gltf.floats(&[[1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1.]]);
    let (places, values) = (gltf.view(&[1]), gltf.view(&[0; 12]));
    gltf.json["accessors"][normals]["sparse"] = json!({"count": 1,
        "indices": {"bufferView": places, "componentType": U8}, "values": {"bufferView": values}});
    let texture = gltf.texture(1, &[[9; 4]], json!({"wrapS": 33071, "magFilter": 9728}));
    let joint = gltf.node(json!({"translation": [0, 0, 1]}));
    gltf.add("skins", json!({"joints": [joint], "inverseBindMatrices": bind}));
    let info = json!({"index": texture, "texCoord": 0, "extensions": {"KHR_texture_transform":
        {"offset": [0, 1], "rotation": 1, "scale": [1, 2], "texCoord": 0}}});
    gltf.add("materials", json!({"alphaMode": "MASK", "pbrMetallicRoughness":
        {"baseColorTexture": info, "metallicRoughnessTexture": info},
        "normalTexture": {"index": texture, "scale": 1},
        "extensions": {"KHR_materials_ior": {"ior": 1.5}, "KHR_materials_transmission":
            {"transmissionFactor": 0.5, "transmissionTexture": {"index": texture}},
            "KHR_materials_volume": {"thicknessFactor": 1, "attenuationDistance": 2,
                "attenuationColor": [1, 0.5, 0.25]},
            "KHR_materials_clearcoat": {"clearcoatFactor": 0.5,
                "clearcoatRoughnessTexture": {"index": texture}},
            "KHR_materials_sheen": {"sheenColorFactor": [1, 1, 1],
                "sheenColorTexture": {"index": texture}},
            "KHR_materials_specular": {"specularFactor": 0.5, "specularTexture": {"index": texture}}}}));
    let mesh = gltf.mesh(json!({"mode": 4, "indices": indices, "material": 0, "attributes":
        {"POSITION": 0, "NORMAL": normals, "TEXCOORD_0": uvs, "COLOR_0": colours,
         "JOINTS_0": joints, "WEIGHTS_0": weights}, "targets": [{"POSITION": 0, "NORMAL": normals}]}));
    gltf.json["meshes"][mesh]["weights"] = json!([0.5]);
    let skinned = gltf.add("nodes", json!({"mesh": mesh, "skin": 0}));
    gltf.json["nodes"][joint]["children"] = json!([skinned]);
    gltf.node(json!({"mesh": 0, "extensions": {"EXT_mesh_gpu_instancing":
        {"attributes": {"TRANSLATION": 0, "SCALE": scales}}}}));
    gltf.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [{"type": "point"}]}});
    gltf.node(json!({"extensions": {"KHR_lights_punctual": {"light": 0}}}));
    gltf.json["extensionsUsed"] = json!(["KHR_materials_ior"]);
    gltf
}

/// Calls `visit` with the pointer of each value in a JSON.
fn each(value: &Value, pointer: &str, visit: &mut impl FnMut(&str)) {
    visit(pointer);
    match value {
        Value::Array(elements) => {
            for (index, element) in elements.iter().enumerate() {
                each(element, &format!("{pointer}/{index}"), visit);
            }
        }
        Value::Object(map) => {
            for (key, value) in map {
                each(value, &format!("{pointer}/{}", key.replace('/', "~1")), visit);
            }
        }
        _ => (),
    }
}

#[test]
fn any_value_may_be_wrong_without_a_panic() {
    let gltf = everything();
    let scene = gltf.scene();
    assert!(scene.triangle_count() >= 5, "{}", scene.triangle_count());
    let good = gltf.text();
    let mut pointers = Vec::new();
    each(&good, "", &mut |pointer| pointers.push(pointer.to_owned()));
    let others = [
        json!(7),
        json!(0),
        json!(1),
        json!(-1),
        json!(4_294_967_295_u32),
        json!(18_446_744_073_709_551_615_u64),
        json!(1e300),
        json!(0.5),
        json!("x"),
        json!([]),
        json!([0, 0, 0]),
        json!({}),
        Value::Null,
    ];
    let (mut scenes, mut errors) = (0, 0);
    for pointer in &pointers {
        for other in &others {
            let mut bad = good.clone();
            *bad.pointer_mut(pointer).unwrap() = other.clone();
            match load_bytes(&glb(bad.to_string().as_bytes(), &gltf.binary)) {
                Ok(scene) => {
                    assert_eq!(scene.check(), Ok(()), "{pointer} = {other}");
                    scenes += 1;
                }
                Err(error) => {
                    assert!(error.to_string().starts_with("a.glb"), "{pointer} = {other}: {error}");
                    errors += 1;
                }
            }
        }
    }
    assert!(pointers.len() > 200 && scenes > 100 && errors > 1000, "{scenes} and {errors}");
}

#[test]
fn any_file_may_be_cut_short() {
    let whole = everything().glb();
    for length in 0..whole.len() {
        let error = load_bytes(&whole[..length]).unwrap_err().to_string();
        assert!(error.starts_with("a.glb"), "{length}: {error}");
    }
    // Lengths in the header and of chunks.
    for at in [8, 12] {
        for length in [0_u32, 4, 11, 12, u32::MAX] {
            let mut bytes = whole.clone();
            bytes[at..at + 4].copy_from_slice(&length.to_le_bytes());
            assert!(load_bytes(&bytes).is_err(), "{at}: {length}");
        }
    }
}

/// What spoils a file, and what the error says.
type Case<'a> = (&'a dyn Fn(&mut Value), &'a [&'a str]);

#[test]
fn errors_say_where_a_file_is_wrong() {
    let message = |change: &dyn Fn(&mut Value)| {
        let mut gltf = everything();
        change(&mut gltf.json);
        gltf.load().unwrap_err().to_string()
    };
    let cases: [Case<'_>; 14] = [
        (&|j| j["asset"]["version"] = json!("1.0"), &["is glTF 1.0"]),
        (&|j| j["nodes"][0]["mesh"] = json!(9), &["nodes[0].mesh", "meshes[9]", "there are 2"]),
        (&|j| j["scene"] = json!(3), &["scene: names scenes[3]"]),
        (&|j| j["nodes"][0]["children"] = json!([2, 2]), &["nodes[2]", "is below"]),
        (&|j| j["nodes"][0]["children"] = json!([0]), &["nodes[0]", "below itself"]),
        (
            &|j| j["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = json!(99),
            &["meshes[0].primitives[0].attributes.POSITION", "accessors[99]"],
        ),
        (&|j| j["accessors"][0]["count"] = json!(4), &["accessors[0]", "beyond", "bufferViews[0]"]),
        (&|j| j["accessors"][0]["type"] = json!("VEC2"), &["accessors[0]", "2 components"]),
        (&|j| j["bufferViews"][0]["byteLength"] = json!(1 << 30), &["bufferViews[0]", "bytes"]),
        (&|j| j["buffers"][0]["byteLength"] = json!(1 << 30), &["buffers[0]", "byteLength says"]),
        (
            &|j| j["buffers"][0]["uri"] = json!("lost.bin"),
            &["buffers[0].uri", "no such file", "lost"],
        ),
        (&|j| j["meshes"][1]["primitives"][0]["attributes"]["NORMAL"] = json!(99), &["NORMAL"]),
        (&|j| j["cameras"][0]["perspective"]["yfov"] = json!(4), &["cameras[0]", "yfov"]),
        (
            &|j| j["materials"][0]["pbrMetallicRoughness"]["roughnessFactor"] = json!("x"),
            &["materials[0]", "roughnessFactor"],
        ),
    ];
    for (change, parts) in cases {
        let message = message(change);
        assert!(message.starts_with("a.glb"), "{message}");
        for part in parts {
            assert!(message.contains(part), "{message:?} does not say {part:?}");
        }
    }
}

#[test]
fn what_takes_too_much_memory_is_refused() {
    let load = |gltf: &Gltf, max_memory| {
        let files: BTreeMap<_, _> = [("a.glb".into(), gltf.glb())].into();
        LoadOptions { max_memory, ..LoadOptions::default() }.load_files(&files, Path::new("a.glb"))
    };
    let mut gltf = Gltf::triangle();
    // A thousand million copies, all in one place, of no bytes.
    let count = 1_000_000_000_u64;
    let none =
        gltf.add("accessors", json!({"componentType": 5126, "type": "VEC3", "count": count}));
    gltf.json["nodes"][0]["extensions"] =
        json!({"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": none}}});
    let message = load(&gltf, 1 << 30).unwrap_err().to_string();
    assert!(message.contains("accessors[1]") && message.contains("1 GiB"), "{message}");
    gltf.json["accessors"][none]["count"] = json!(10_000);
    assert_eq!(load(&gltf, 1 << 30).unwrap().triangle_count(), 10_000);
    let message = load(&gltf, 2 << 20).unwrap_err().to_string();
    assert!(message.contains("2 MiB of memory"), "{message}");
}
