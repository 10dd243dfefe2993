//! PLY files become meshes.

use glam::{Vec3, Vec4};
use raystream::scene::{LoadOptions, Material, Scene, SceneError};
use raystream_shaders::math::dot;
use raystream_tests::scene_folder::SceneFolder;
use serde_json::json;
use std::collections::BTreeMap;
use std::path::Path;

/// A square and a triangle with normals and texture coordinates, and an element that nobody reads.
const ASCII: &str = "ply\nformat ascii 1.0\ncomment a\nelement vertex 5\nproperty float x\n\
    property float y\nproperty double z\nproperty float nx\nproperty float ny\nproperty float nz\n\
    property float s\nproperty float t\nproperty uchar red\nelement edge 1\nproperty int vertex1\n\
    element face 2\nproperty uchar flags\nproperty list uchar int vertex_indices\nend_header\n\
    0 0 0 0 0 1 0 0 255\n1 0 0 0 0 1 1 0 255\n1 1 0 0 0 1 1 1 255\n0 1 0 0 0 2 0 1 255\n\
    2 0 0.5 0 0 1 0 0 255\n7\n1 4 0 1 2 3\n1 3 1 4 2\n";

fn load(bytes: &[u8]) -> Result<Scene, SceneError> {
    let files: BTreeMap<_, _> = [("a.ply".into(), bytes.to_vec())].into();
    LoadOptions { max_memory: 256 << 20, ..LoadOptions::default() }
        .load_files(&files, Path::new("a.ply"))
}

/// The same file in another encoding.
fn binary(is_big: bool) -> Vec<u8> {
    let (head, body) = ASCII.split_once("end_header\n").unwrap();
    let name = if is_big { "binary_big_endian" } else { "binary_little_endian" };
    let mut bytes = head.replace("ascii", name).into_bytes();
    bytes.extend(b"end_header\n");
    let order = |mut word: Vec<u8>| {
        if is_big {
            word.reverse();
        }
        word
    };
    for (line, text) in body.lines().enumerate() {
        let words: Vec<f64> = text.split(' ').map(|word| word.parse().unwrap()).collect();
        for (at, &word) in words.iter().enumerate() {
            let (is_vertex, is_face) = (line < 5, line > 5);
            bytes.extend(match at {
                2 if is_vertex => order(word.to_le_bytes().to_vec()),
                8 if is_vertex => vec![word as u8],
                0 | 1 if is_face => vec![word as u8],
                _ if is_vertex => order((word as f32).to_le_bytes().to_vec()),
                _ => order((word as i32).to_le_bytes().to_vec()),
            });
        }
    }
    bytes
}

#[test]
fn all_encodings_are_one() {
    let scene = load(ASCII.as_bytes()).unwrap();
    let [mesh] = &scene.meshes[..] else { panic!("{:?}", scene.meshes) };
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [1, 4, 2]]);
    assert_eq!(mesh.positions[4], Vec3::new(2.0, 0.0, 0.5));
    assert_eq!(mesh.normals.as_ref().unwrap()[1], [Vec3::Z; 3], "of unit length");
    assert_eq!(mesh.texture_coordinates.as_ref().unwrap()[0][2].to_array(), [1.0, 1.0]);
    assert_eq!(scene.materials, [Material::diffuse(Vec3::splat(0.5))]);
    for is_big in [false, true] {
        assert_eq!(load(&binary(is_big)).unwrap().meshes, scene.meshes);
    }
    let warnings = format!("{:?}", scene.warnings);
    for said in ["element edge", "no camera", "no light"] {
        assert!(warnings.contains(said), "{warnings}");
    }
    assert_eq!(scene.check(), Ok(()));
}

#[test]
fn concave_polygons_are_filled_once() {
    let arrow = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n\
        property float z\nelement face 1\nproperty list uchar uint vertex_index\nend_header\n\
        -1 -1 0\n0 -0.4 0\n1 -1 0\n0 1 0\n4 0 1 2 3\n";
    let mesh = &load(arrow.as_bytes()).unwrap().meshes[0];
    assert!(mesh.triangles.iter().all(|corners| corners.contains(&1) && corners.contains(&3)));
}

#[test]
fn errors_say_where_a_file_is_wrong() {
    let changed = |from: &str, to: &str| {
        assert!(ASCII.contains(from), "{from}");
        load(ASCII.replace(from, to).as_bytes()).unwrap_err().to_string()
    };
    for (from, to, parts) in [
        ("ply\n", "pl\n", vec!["does not begin with `ply`"]),
        ("format ascii 1.0", "format utf 1.0", vec!["the header", "Line 2"]),
        ("vertex 5", "vertex 500000", vec!["element vertex", "the file is shorter"]),
        ("2 0 0.5", "2 0 x", vec!["element vertex", "2 0 x"]),
        ("2 0 0.5", "2 0 1e30", vec!["element vertex, number 4", "no number"]),
        ("3 1 4 2", "3 1 5 2", vec!["element face, number 1", "vertex 5", "there are 5"]),
        ("3 1 4 2", "3 1 -4 2", vec!["element face, number 1", "not negative"]),
        ("vertex_indices", "corners", vec!["element face", "needs a list vertex_indices"]),
        ("face 2", "face 0", vec!["no faces", "cloud of points"]),
        ("\n7\n1 4 0 1 2 3\n1 3 1 4 2\n", "\n7\n", vec!["element face"]),
    ] {
        let message = changed(from, to);
        assert!(message.starts_with("a.ply"), "{message}");
        assert!(!message.contains('\n'), "{message}");
        for part in parts {
            assert!(message.contains(part), "{from} -> {to}: {message:?} does not say {part:?}");
        }
    }
    for length in 0..ASCII.len() - 12 {
        assert!(load(&ASCII.as_bytes()[..length]).is_err(), "{length}");
    }
    let bytes = binary(false);
    for length in 0..bytes.len() {
        assert!(load(&bytes[..length]).is_err(), "{length}");
    }
}

#[test]
fn colours_are_srgb_of_any_type() {
    let with = |kind: &str, rows: [&str; 3]| {
        let properties = ["red", "green", "blue"].map(|name| format!("property {kind} {name}\n"));
        let [a, b, c] = rows;
        let text = format!(
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
             property float z\n{}element face 1\nproperty list uchar int vertex_indices\n\
             end_header\n0 0 0 {a}\n1 0 0 {b}\n0 1 0 {c}\n3 0 1 2\n",
            properties.concat()
        );
        load(text.as_bytes()).unwrap()
    };
    let decoded = |code: f32| ((code + 0.055) / 1.055).powf(2.4);
    for (kind, rows) in [
        ("uchar", ["255 0 0", "0 51 255", "255 255 255"]),
        ("ushort", ["65535 0 0", "0 13107 65535", "65535 65535 65535"]),
        ("float", ["1 0 0", "0 0.2 1", "1 7 1"]),
    ] {
        let scene = with(kind, rows);
        let [a, b, c] = scene.meshes[0].colours.as_ref().unwrap()[0];
        assert_eq!((a, c), (Vec4::new(1.0, 0.0, 0.0, 1.0), Vec4::ONE), "{kind}");
        let off = b - Vec4::new(0.0, decoded(0.2), 1.0, 1.0);
        assert!(dot(off, off).sqrt() < 1e-6, "{kind}: {b}");
        assert_eq!(scene.materials, [Material::diffuse(Vec3::ONE)]);
        assert!(!format!("{:?}", scene.warnings).contains("alpha"));
    }
    let clear = ASCII.replace("uchar red", "uchar alpha");
    assert!(!format!("{:?}", load(clear.as_bytes()).unwrap().warnings).contains("alpha"));
    let clear = clear.replace("0 0 0 0 0 1 0 0 255", "0 0 0 0 0 1 0 0 25");
    assert!(
        format!("{:?}", load(clear.as_bytes()).unwrap().warnings).contains("alpha of vertices")
    );
}

#[test]
fn a_scene_file_may_name_a_ply() {
    let folder = SceneFolder::new().with("a.ply", ASCII).json(|scene| {
        scene["obj"] = json!("a.ply");
        scene["materials"] = json!({"(none)": {"type": "mirror", "reflectance": [1, 1, 1]}});
    });
    let scene = folder.load().unwrap();
    assert_eq!(scene.meshes[0].triangles.len(), 3);
    assert_eq!(scene.materials[0], Material::mirror(Vec3::ONE));
    assert_eq!(scene.film.width, 8);
}
