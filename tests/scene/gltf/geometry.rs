//! Triangles, and where they lie.

use super::{assert_warns, corners};
use glam::Vec3;
use raystream::scene::{Instancing, LoadOptions, Scene, SceneError};
use raystream_tests::gltf::{Gltf, I16, U8};
use serde_json::{Value, json};
use std::path::Path;

/// A mesh of these positions, changed, in a scene.
fn with(positions: &[[f32; 3]], change: impl FnOnce(&mut Gltf, &mut Value)) -> Gltf {
    let mut gltf = Gltf::new();
    let accessor = gltf.floats(positions);
    let mut primitive = json!({"attributes": {"POSITION": accessor}});
    change(&mut gltf, &mut primitive);
    let mesh = gltf.mesh(primitive);
    gltf.node(json!({"mesh": mesh}));
    gltf.with_camera()
}

const FIVE: [[f32; 3]; 5] =
    [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0], [0.0, 2.0, 0.0]];

fn of_five(triangles: &[[usize; 3]]) -> Vec<[Vec3; 3]> {
    triangles.iter().map(|t| t.map(|at| Vec3::from_array(FIVE[at]))).collect()
}

#[test]
fn strips_and_fans_are_triangles() {
    let mode = |mode: u32| with(&FIVE, |_, p| p["mode"] = json!(mode)).scene();
    assert_eq!(corners(&mode(4)), of_five(&[[0, 1, 2]]), "two corners are left over");
    assert_eq!(corners(&mode(5)), of_five(&[[0, 1, 2], [2, 1, 3], [2, 3, 4]]));
    let fan = with(&FIVE, |gltf, p| {
        p["mode"] = json!(6);
        p["indices"] = json!(gltf.indices(&[0, 1, 3, 2]));
    });
    assert_eq!(corners(&fan.scene()), of_five(&[[0, 1, 3], [0, 3, 2]]));
    let mut points = with(&FIVE, |_, p| p["mode"] = json!(0));
    assert!(points.load().unwrap_err().to_string().contains("no triangle"));
    points.json["meshes"][0]["primitives"].as_array_mut().unwrap().push(json!(
        {"attributes": {"POSITION": 0}}
    ));
    assert_warns(&points.scene(), &["points or lines are not shown: 1"]);
}

#[test]
fn indices_are_of_any_width() {
    for (component, bytes) in [
        (U8, vec![3, 2, 1]),
        (5123, vec![3, 0, 2, 0, 1, 0]),
        (5125, vec![3, 0, 0, 0, 2, 0, 0, 0, 1, 0, 0, 0]),
    ] {
        let gltf = with(&FIVE, |gltf, p| {
            p["indices"] = json!(gltf.accessor(&bytes, component, "SCALAR", 3));
        });
        assert_eq!(corners(&gltf.scene()), of_five(&[[3, 2, 1]]), "{component}");
    }
}

#[test]
fn sparse_elements_replace_others() {
    let sparse = |gltf: &mut Gltf| {
        let indices = gltf.view(&[1, 2]);
        let values = [[4.0_f32, 0.0, 0.0], [0.0, 5.0, 0.0]];
        let bytes: Vec<u8> = values.iter().flatten().flat_map(|c| c.to_le_bytes()).collect();
        let values = gltf.view(&bytes);
        json!({"count": 2, "indices": {"bufferView": indices, "componentType": U8},
            "values": {"bufferView": values}})
    };
    let expected = [[Vec3::ZERO, Vec3::X * 4.0, Vec3::Y * 5.0]];
    let over = with(&FIVE, |gltf, _| gltf.json["accessors"][0]["sparse"] = sparse(gltf));
    assert_eq!(corners(&over.scene()), expected);
    // Without a view all others are zero.
    let alone = with(&FIVE[..3], |gltf, _| {
        let sparse = sparse(gltf);
        let accessor = &mut gltf.json["accessors"][0];
        accessor["sparse"] = sparse;
        accessor.as_object_mut().unwrap().remove("bufferView");
    });
    assert_eq!(corners(&alone.scene()), expected);
}

#[test]
fn quantised_positions_are_those_of_floats() {
    // 16-bit shares, 8 bytes apart, enlarged by the node.
    let shorts: [[i16; 4]; 3] = [[-32767, 0, 0, 9], [32767, 0, 0, 9], [0, 32767, -32768, 9]];
    let bytes: Vec<u8> = shorts.iter().flatten().flat_map(|c| c.to_le_bytes()).collect();
    let mut gltf = Gltf::triangle();
    let view = gltf.view(&bytes);
    gltf.json["bufferViews"][view]["byteStride"] = json!(8);
    gltf.json["accessors"][0] = json!({"bufferView": view, "componentType": I16, "type": "VEC3",
        "count": 3, "normalized": true});
    gltf.json["nodes"][0]["scale"] = json!([2, 2, 2]);
    gltf.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    let expected = [[Vec3::X * -2.0, Vec3::X * 2.0, Vec3::new(0.0, 2.0, -2.0)]];
    assert_eq!(corners(&gltf.scene()), expected);
    gltf.json["accessors"][0]["normalized"] = json!(false);
    assert_eq!(corners(&gltf.scene())[0][1], Vec3::X * 65_534.0);
}

#[test]
fn nodes_place_what_is_below_them() {
    let mut gltf = Gltf::triangle();
    gltf.json["nodes"][0]["children"] = json!([2]);
    gltf.json["nodes"][0]["translation"] = json!([1, 2, 3]);
    // A quarter turn about z, then twice as large: by columns.
    let matrix = [0, 2, 0, 0, -2, 0, 0, 0, 0, 0, 2, 0, 10, 0, 0, 1];
    gltf.add("nodes", json!({"mesh": 0, "matrix": matrix}));
    let at = Vec3::new(1.0, 2.0, 3.0);
    let below = [Vec3::ZERO, Vec3::Y * 2.0, Vec3::X * -2.0].map(|p| p + at + Vec3::X * 10.0);
    assert_eq!(corners(&gltf.scene()), [[at, at + Vec3::X, at + Vec3::Y], below]);
    // What is in no scene is not shown, and what is in another one is not either.
    let mut gltf = Gltf::triangle();
    gltf.add("nodes", json!({"mesh": 0, "translation": [9, 9, 9]}));
    gltf.add("scenes", json!({"nodes": [2]}));
    assert_eq!(gltf.scene().triangle_count(), 1);
    gltf.json["scene"] = json!(1);
    let scene = gltf.scene();
    // Three corners are brought near the origin.
    assert_warns(&scene, &["count from (9, 9, 9)"]);
    assert_warns(&scene, &["2 scenes", "scenes[1] is shown"]);
}

#[test]
fn instances_are_nodes() {
    let places = [[1.0, 0.0, 0.0], [0.0, 3.0, 0.0]];
    let scales = [[1.0, 2.0, 3.0], [-1.0, 1.0, 1.0]];
    let mut instanced = Gltf::triangle();
    let translations = instanced.floats(&places);
    let scaling = instanced.floats(&scales);
    instanced.json["nodes"][0]["extensions"] = json!({"EXT_mesh_gpu_instancing":
        {"attributes": {"TRANSLATION": translations, "SCALE": scaling}}});
    let mut nodes = Gltf::triangle();
    nodes.json["nodes"][0] = json!({"mesh": 0, "translation": places[0], "scale": scales[0]});
    nodes.node(json!({"mesh": 0, "translation": places[1], "scale": scales[1]}));
    assert_eq!(instanced.scene().meshes, nodes.scene().meshes);
    let error = instanced.json["accessors"][scaling]["count"].take();
    assert_eq!(error, 2);
    instanced.json["accessors"][scaling]["count"] = json!(1);
    let message = instanced.load().unwrap_err().to_string();
    assert!(message.contains("EXT_mesh_gpu_instancing"), "{message}");
}

/// A mesh of sixteen triangles, which two nodes and the three copies of a third one share.
fn copied() -> Gltf {
    let indices: Vec<u16> = [0, 1, 2].repeat(16);
    let mut gltf = with(&FIVE, |gltf, p| p["indices"] = json!(gltf.indices(&indices)));
    gltf.node(json!({"mesh": 0, "translation": [5, 0, 0], "scale": [-2, 1, 1]}));
    let places = gltf.floats(&[[0.0, 7.0, 0.0], [0.0, 8.0, 0.0], [0.0, 9.0, 0.0]]);
    gltf.node(json!({"mesh": 0, "extensions":
        {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": places}}}}));
    gltf
}

fn loaded(gltf: &Gltf, instancing: Instancing, max_memory: u64) -> Result<Scene, SceneError> {
    let files = [("a.glb".into(), gltf.glb())].into();
    let options = LoadOptions { max_memory, instancing, ..LoadOptions::default() };
    options.load_files(&files, Path::new("a.glb"))
}

#[test]
fn copies_are_kept_once_where_that_is_wanted() {
    let of = |gltf: &Gltf, instancing| loaded(gltf, instancing, 256 << 20).unwrap();
    let kept = of(&copied(), Instancing::Always);
    let counts = (kept.meshes.len(), kept.shapes.len(), kept.instances.len());
    assert_eq!(counts, (0, 1, 5));
    for instancing in [Instancing::Auto, Instancing::Never] {
        let repeated = of(&copied(), instancing);
        assert_eq!((repeated.meshes.len(), repeated.instances.len()), (5, 0));
        assert_eq!(repeated.meshes, kept.without_instances().meshes);
        assert_eq!(repeated.triangle_count(), kept.triangle_count());
        // Without a camera of its own the same is seen.
        assert_eq!(repeated.bounds(), kept.bounds());
    }
    let mut lamps = copied();
    lamps.json["materials"] = json!([{"emissiveFactor": [1, 1, 1]}]);
    lamps.json["meshes"][0]["primitives"][0]["material"] = json!(0);
    assert_eq!(of(&lamps, Instancing::Always).instances.len(), 0);
    let mut flat = copied();
    flat.json["nodes"][2]["scale"] = json!([1, 1, 0]);
    let flat = of(&flat, Instancing::Always);
    assert_eq!((flat.meshes.len(), flat.instances.len()), (1, 4));
}

/// What is kept once takes the memory of one, and what is repeated of all.
#[test]
fn copies_that_take_too_much_memory_are_refused() {
    let mut gltf = copied();
    let places: Vec<[f32; 3]> = (0..2000).map(|k| [k as f32, 0.0, 0.0]).collect();
    let places = gltf.floats(&places);
    let instancing = &mut gltf.json["nodes"][3]["extensions"]["EXT_mesh_gpu_instancing"];
    instancing["attributes"]["TRANSLATION"] = json!(places);
    let memory = 6 << 20;
    assert!(loaded(&gltf, Instancing::Always, memory).is_ok());
    let refused = loaded(&gltf, Instancing::Never, memory).unwrap_err().to_string();
    assert!(refused.contains("memory"), "{refused}");
    let mut far = copied();
    far.json["nodes"][2]["translation"] = json!([3e9, 0, 0]);
    let message = loaded(&far, Instancing::Always, 256 << 20).unwrap_err().to_string();
    assert!(message.contains("an instance is more than"), "{message}");
}

#[test]
fn skins_and_targets_are_as_the_file_leaves_them() {
    let mut gltf = Gltf::triangle();
    // The second corner goes with a joint, the third half with it.
    let joints = gltf.accessor(&[0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0], U8, "VEC4", 3);
    let weights = [[1.0, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0], [0.5, 0.5, 0.0, 0.0]];
    let weights = gltf.floats(&weights);
    let identity = [1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1.];
    let mut moved = identity;
    moved[12] = -1.0;
    let bind = gltf.floats(&[identity, moved]);
    let still = gltf.node(json!({}));
    let joint = gltf.node(json!({"translation": [1, 0, 4]}));
    gltf.add("skins", json!({"joints": [still, joint], "inverseBindMatrices": bind}));
    let attributes = &mut gltf.json["meshes"][0]["primitives"][0]["attributes"];
    attributes["JOINTS_0"] = json!(joints);
    attributes["WEIGHTS_0"] = json!(weights);
    gltf.json["nodes"][0]["skin"] = json!(0);
    // A skin's place is that of its joints alone.
    gltf.json["nodes"][0]["translation"] = json!([100, 0, 0]);
    let expected = [[Vec3::ZERO, Vec3::new(1.0, 0.0, 4.0), Vec3::new(0.0, 1.0, 2.0)]];
    assert_eq!(corners(&gltf.scene()), expected);

    let mut gltf = Gltf::triangle();
    let up = gltf.floats(&[[0.0, 0.0, 1.0]; 3]);
    let aside = gltf.floats(&[[1.0, 0.0, 0.0]; 3]);
    gltf.json["meshes"][0]["primitives"][0]["targets"] =
        json!([{"POSITION": up}, {"POSITION": aside}]);
    assert_eq!(corners(&gltf.scene())[0][0], Vec3::ZERO);
    gltf.json["meshes"][0]["weights"] = json!([0.5, 0]);
    assert_warns(&gltf.scene(), &["count from (0, 0, 0.5)"]);
    gltf.json["nodes"][0]["weights"] = json!([0, 2]);
    assert_warns(&gltf.scene(), &["count from (2, 0, 0)"]);
}

#[test]
fn what_is_far_from_the_origin_is_brought_near() {
    let mut gltf = Gltf::triangle();
    gltf.json["nodes"][0]["translation"] = json!([4_000_000.0, 0, 0]);
    gltf.json["nodes"][1]["translation"] = json!([4_000_000.0, 0, 5]);
    let scene = gltf.scene();
    let [a, b, _] = corners(&scene)[0];
    assert!(a.length() < 4.0 && b - a == Vec3::X, "{a}");
    assert!(scene.camera.origin.length() < 10.0);
    assert_warns(&scene, &["far from the origin"]);
}
