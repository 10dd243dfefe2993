//! Models in files of their own, and what `inspect` says of scenes.

use crate::program::{render, run};
use raystream_tests::gltf::Gltf;
use serde_json::{Value, json};
use std::path::Path;

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let mut gltf = Gltf::triangle();
    gltf.node(json!({"camera": 0, "name": "from the side", "translation": [0.5, 0.2, 4]}));
    gltf.json["materials"] = json!([{"name": "car",
        "extensions": {"KHR_materials_iridescence": {"iridescenceFactor": 1}}}]);
    gltf.json["meshes"][0]["primitives"][0]["material"] = json!(0);
    std::fs::write(folder.path().join("a.glb"), gltf.glb()).unwrap();
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
        property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
        0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    std::fs::write(folder.path().join("scan.ply"), ply).unwrap();
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    std::fs::write(folder.path().join("part.obj"), obj).unwrap();
    folder
}

/// Runs `inspect` with arguments that may hold spaces.
fn inspect(folder: &Path, arguments: &[&str]) -> crate::program::Run {
    let arguments: Vec<&str> = ["inspect"].into_iter().chain(arguments.iter().copied()).collect();
    let output = crate::program::program(folder, &arguments).output().unwrap();
    crate::program::Run::new(output)
}

#[test]
fn models_are_rendered() {
    let folder = folder();
    let folder = folder.path();
    render(folder, "a.glb --spp 1 --size 16x12 -o a.png").succeeded().says(&[
        "a: 1 triangles",
        "thin films are left out",
        "no light",
    ]);
    render(folder, "scan.ply --spp 1 --size 16x12 -o b.png")
        .succeeded()
        .says(&["scan: 1 triangles", "a PLY has no camera"]);
    render(folder, "part.obj --spp 1 --size 16x12 -o d.png").succeeded().says(&[
        "part: 1 triangles",
        "an OBJ has no camera",
        "soft studio",
    ]);
    render(folder, "a.glb --spp 1 --camera back -o c.png")
        .failed(&["no camera is called `back`", "`front`, `from the side`"]);
    render(folder, "cornell_ball --spp 1 --camera back -o c.png").failed(&["the scene has none"]);
    assert!(folder.join("a.png").exists() && folder.join("b.png").exists());
    assert!(!folder.join("c.png").exists());
}

#[test]
fn a_scene_is_inspected() {
    let folder = folder();
    let folder = folder.path();
    let text = inspect(folder, &["a.glb"]).succeeded();
    for part in ["triangles   1 in 1 meshes", "1 principled", "front", "thin films are left out"] {
        assert!(text.stdout.contains(part), "{} does not say {part}", text.stdout);
    }
    let chosen = inspect(folder, &["a.glb", "--json", "--camera", "from the side"]).succeeded();
    let value: Value = serde_json::from_str(&chosen.stdout).unwrap();
    assert_eq!(value["triangles"], 1);
    assert_eq!(value["materials"], json!({"principled": 1}));
    assert_eq!(value["camera"]["origin"][2], 4.0);
    assert_eq!(value["cameras"][1]["name"], "from the side");
    assert_eq!(value["lights"]["environment"], json!({"width": 128, "height": 64}));
    assert!(value["memory"]["geometry"].as_u64().unwrap() > 0);
    assert!(value["warnings"].to_string().contains("thin films are left out"));
    assert_eq!(chosen.stderr, "", "warnings are among what is printed");
    let around = run(folder, "inspect a.glb --json --panorama").succeeded();
    let value: Value = serde_json::from_str(&around.stdout).unwrap();
    assert_eq!(value["camera"]["projection"]["type"], "panorama");
    let shipped = run(folder, "inspect cornell_ball --json").succeeded();
    let value: Value = serde_json::from_str(&shipped.stdout).unwrap();
    assert_eq!(value["name"], "cornell_ball");
    let tea = run(folder, "inspect tea --json").succeeded();
    let tea: Value = serde_json::from_str(&tea.stdout).unwrap();
    assert_eq!(tea["camera_is_in_body"], false);
    assert_eq!(tea["materials"]["dielectric"], 5, "one for each mesh");
    inspect(folder, &["lost.glb"]).failed(&["lost.glb"]);
}
