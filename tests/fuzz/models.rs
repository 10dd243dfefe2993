//! Models in files of their own: glTF and PLY; and environments.

use super::{as_it_is, fuzz};
use image::codecs::hdr::HdrEncoder;
use raystream::render::{BvhQuality, PreparedScene};
use raystream::scene::LoadOptions;
use raystream_tests::gltf::{F32, Gltf, I8, I16, U8};
use raystream_tests::{draco, meshopt};
use serde_json::json;
use std::collections::BTreeMap;
use std::path::Path;

/// Loads a scene from one file, and makes it ready to be rendered if it can be.
fn load(name: &str, bytes: &[u8]) {
    let files: BTreeMap<_, _> = [(name.into(), bytes.to_vec())].into();
    match (LoadOptions { max_memory: 256 << 20, ..LoadOptions::default() })
        .load_files(&files, Path::new(name))
    {
        Ok(scene) if scene.triangle_count() <= 64 => {
            // Too deep a hierarchy is an error.
            let _ = PreparedScene::new(&scene, BvhQuality::Fast);
        }
        Ok(scene) => scene.check().unwrap(),
        Err(error) => {
            let message = error.to_string();
            let longest = 4000 + 8 * bytes.len();
            assert!(!message.is_empty() && message.len() < longest, "{} bytes", message.len());
        }
    }
}

/// A skinned, morphed, textured triangle, and copies of it.
fn bent() -> Gltf {
    let mut gltf = Gltf::triangle();
    let up = gltf.floats(&[[0.0, 0.0, 1.0]; 3]);
    let uvs = gltf.floats(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]);
    let joints = gltf.accessor(&[0; 12], U8, "VEC4", 3);
    let weights = gltf.floats(&[[1.0, 0.0, 0.0, 0.0]; 3]);
    let texture = gltf.texture(1, &[[9, 99, 199, 255]], json!({"wrapS": 33648}));
    gltf.add(
        "materials",
        json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": texture}}}),
    );
    gltf.add("skins", json!({"joints": [1]}));
    let mesh = gltf.mesh(json!({"material": 0, "attributes": {"POSITION": 0, "NORMAL": up,
        "TEXCOORD_0": uvs, "JOINTS_0": joints, "WEIGHTS_0": weights}, "targets": [{"POSITION": up}]}));
    gltf.node(json!({"mesh": mesh, "skin": 0, "weights": [0.5]}));
    gltf.node(json!({"mesh": 0, "extensions": {"EXT_mesh_gpu_instancing":
        {"attributes": {"TRANSLATION": up}}}}));
    gltf
}

/// Two triangles whose normals, tangents and texture coordinates are compressed by filters.
fn filtered() -> Gltf {
    let mut gltf = meshopt::compressed();
    for (name, filter, stride, component, kind) in [
        ("NORMAL", "OCTAHEDRAL", 4, I8, "VEC3"),
        ("TANGENT", "QUATERNION", 8, I16, "VEC4"),
        ("TEXCOORD_0", "EXPONENTIAL", 8, F32, "VEC2"),
    ] {
        let rows: Vec<u8> = (0..4 * stride as u8).map(|byte| 1 + byte % 3).collect();
        let more = json!({"mode": "ATTRIBUTES", "filter": filter});
        let stream = meshopt::attributes(&rows, stride);
        let view = meshopt::add(&mut gltf, &stream, [4, stride], more);
        let accessor = json!({"bufferView": view, "componentType": component, "type": kind,
            "count": 4, "normalized": component != F32});
        let accessor = gltf.add("accessors", accessor);
        gltf.json["meshes"][0]["primitives"][0]["attributes"][name] = json!(accessor);
    }
    gltf
}

#[test]
fn gltf_files_by_chance() {
    let words = &[
        "{",
        "}",
        "[",
        "]",
        ",",
        ":",
        "null",
        "\"mesh\":",
        "\"skin\":",
        "\"children\":[0]",
        "\"mode\":5",
        "\"count\":",
        "\"byteStride\":",
        "\"byteOffset\":",
        "\"bufferView\":",
        "\"componentType\":5126",
        "\"type\":\"VEC3\"",
        "\"sparse\":",
        "\"normalized\":true",
        "\"matrix\":",
        "\"scale\":[0,0,0]",
        "\"uri\":\"data:,%00%01\"",
        "\"indices\":",
        "\"extensions\":",
        "\"KHR_materials_ior\":",
        "\"KHR_texture_transform\":",
        "\"mode\":\"INDICES\"",
        "\"filter\":\"QUATERNION\"",
        "glTF",
        "JSON",
        "BIN\0",
        "1e38",
        "4294967295",
    ];
    let (plain, bent) = (Gltf::triangle(), bent());
    filtered().scene();
    let seeds = vec![plain.glb(), bent.glb(), meshopt::compressed().glb(), filtered().glb()];
    let draco = [0, 7, 10].map(|level| draco::compressed(level, Some(11)).glb());
    let seeds = [seeds, draco.to_vec()].concat();
    fuzz("gltf", seeds, words, as_it_is, |bytes| load("a.glb", bytes));
    let mut text = plain;
    let bytes: String = text.binary.iter().map(|byte| format!("%{byte:02x}")).collect();
    text.json["buffers"][0]["uri"] = json!(format!("data:application/octet-stream,{bytes}"));
    let seeds = vec![text.text().to_string().into_bytes()];
    fuzz("gltf", seeds, words, as_it_is, |bytes| load("a.gltf", bytes));
}

#[test]
fn ply_files_by_chance() {
    let head = |format: &str| {
        format!(
            "ply\nformat {format} 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
             property float z\nproperty double nx\nproperty float ny\nproperty float nz\n\
             property float u\nproperty float v\nelement face 1\n\
             property list uchar int vertex_indices\nend_header\n"
        )
    };
    let text = "0 0 0 0 0 1 0 0\n1 0 0 0 0 1 1 0\n0 1 0 0 0 1 0 1\n3 0 1 2\n";
    let ascii = format!("{}{text}", head("ascii")).into_bytes();
    let mut binary = head("binary_little_endian").into_bytes();
    for vertex in [[0.0_f32, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]] {
        vertex.iter().for_each(|c| binary.extend(c.to_le_bytes()));
        binary.extend(0.0_f64.to_le_bytes());
        [0.0_f32, 1.0, vertex[0], vertex[1]].iter().for_each(|c| binary.extend(c.to_le_bytes()));
    }
    binary.push(3);
    (0..3_i32).for_each(|at| binary.extend(at.to_le_bytes()));
    let words = &[
        "ply\n",
        "\nformat ascii 1.0",
        "\nformat binary_big_endian 1.0",
        "\nelement face ",
        "\nelement vertex ",
        "\nproperty list uint uint vertex_index",
        "\nproperty double x",
        "\nproperty char y",
        "\nend_header\n",
        "\ncomment ",
        "\r\n",
        "nan",
        "1e300",
        "4294967295",
        " ",
    ];
    fuzz("ply", vec![ascii, binary], words, as_it_is, |bytes| load("a.ply", bytes));
}

#[test]
fn hdr_files_by_chance() {
    let folder = tempfile::tempdir().unwrap();
    let encoded = |width: usize, height: usize| {
        let mut bytes = Vec::new();
        let pixels: Vec<_> =
            (0..width * height).map(|k| image::Rgb([k as f32, 0.5, 1e-3])).collect();
        HdrEncoder::new(&mut bytes).encode(&pixels, width, height).unwrap();
        bytes
    };
    let seeds = vec![encoded(4, 3), encoded(16, 8)];
    let words = &[
        "#?RADIANCE\n",
        "#?RGBE\n",
        "FORMAT=32-bit_rle_rgbe\n",
        "EXPOSURE=1e30\n",
        "GAMMA=0\n",
        "-Y ",
        "+X ",
        "\n\n",
        "65536",
        "16385",
        "4294967295",
        "nan",
    ];
    let options = LoadOptions { max_memory: 256 << 20, ..LoadOptions::default() };
    fuzz("hdr", seeds, words, as_it_is, |bytes| {
        let name = format!("{:?}.hdr", std::thread::current().id());
        let path = folder.path().join(name.replace(['(', ')'], ""));
        std::fs::write(&path, bytes).unwrap();
        if let Ok((environment, _)) = options.load_environment(&path) {
            let texels = environment.width as usize * environment.height as usize;
            assert_eq!(environment.texels.len(), texels);
        }
    });
}
