//! The picture of a glTF is that of the same scene made in code.

use glam::{Vec2, Vec3};
use raystream::scene::{
    Camera, Channel, Environment, FilmSize, Maps, Material, Mesh, NormalMap, Principled, Scene,
    Texture, TextureId, Wrap,
};
use raystream_tests::gltf::Gltf;
use raystream_tests::{prepare, render, settings};
use serde_json::json;

const CLAMP_TO_EDGE: u32 = 33_071;
const MIRRORED_REPEAT: u32 = 33_648;

/// Red, green, blue and grey.
const COLOURS: [[u8; 4]; 4] =
    [[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [99, 99, 99, 255]];
/// Slopes and shares.
const NUMBERS: [[u8; 4]; 2] = [[100, 140, 230, 255], [160, 120, 210, 255]];

/// A square whose left edge is nearer, mirrored by its node.
fn gltf() -> Gltf {
    let mut gltf = Gltf::new();
    let corners = [[-1.0, -1.0, 1.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 1.0]];
    let positions = gltf.floats(&corners);
    let normals =
        gltf.floats(&[[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0], [0.0, 0.0, 1.0]]);
    let uvs = gltf.floats(&[[-0.5, 1.5], [1.5, 1.5], [1.5, -0.5], [-0.5, -0.5]]);
    let indices = gltf.indices(&[0, 1, 2, 0, 2, 3]);
    let colours =
        gltf.texture(2, &COLOURS, json!({"wrapS": CLAMP_TO_EDGE, "wrapT": MIRRORED_REPEAT}));
    let numbers = gltf.texture(1, &NUMBERS, json!({}));
    gltf.add(
        "materials",
        json!({
            "name": "all", "doubleSided": true,
            "pbrMetallicRoughness": {
                "baseColorFactor": [0.8, 0.7, 0.6, 1],
                "baseColorTexture": {"index": colours},
                "metallicFactor": 0.75, "roughnessFactor": 0.5,
                "metallicRoughnessTexture": {"index": numbers},
            },
            "normalTexture": {"index": numbers, "scale": 0.5},
            "emissiveFactor": [0.1, 0.2, 0.3],
            "extensions": {
                "KHR_materials_emissive_strength": {"emissiveStrength": 2},
                "KHR_materials_ior": {"ior": 1.75},
                "KHR_materials_specular": {
                    "specularTexture": {"index": numbers},
                    "specularColorFactor": [1, 0.5, 0.25], "specularColorTexture": {"index": numbers},
                },
                "KHR_materials_volume": {"thicknessFactor": 1},
                "KHR_materials_transmission":
                    {"transmissionFactor": 0.25, "transmissionTexture": {"index": numbers}},
            },
        }),
    );
    let mesh = gltf.mesh(json!({
        "attributes": {"POSITION": positions, "NORMAL": normals, "TEXCOORD_0": uvs},
        "indices": indices, "material": 0,
    }));
    let turned = json!({"mesh": mesh, "translation": [0.5, 0, 0], "scale": [-1, 1, 1]});
    gltf.node(turned);
    gltf.with_camera()
}

/// The same, in code.
fn code() -> Scene {
    let camera = Camera::new(Vec3::new(0.0, 0.0, 5.0), Vec3::ZERO, 0.7_f64.to_degrees() as f32);
    let mut scene = Scene::new(camera, FilmSize { width: 800, height: 640 });
    let wrap = [Wrap::Clamp, Wrap::Mirror];
    let colours = Texture { wrap, ..Texture::new(2, 2, COLOURS.to_vec()) };
    let colours = scene.add_texture(colours);
    let numbers = scene.add_texture(Texture::new(1, 2, NUMBERS.to_vec()));
    let channel = |texture: TextureId, channel: u32| Some(Channel { texture, channel });
    let material = scene.add_material(Material::Principled(Principled {
        base_colour: Vec3::new(0.8, 0.7, 0.6),
        metallic: 0.75,
        roughness: 0.5,
        ior: 1.75,
        specular: Vec3::new(1.0, 0.5, 0.25),
        transmission: 0.25,
        emission: [0.1_f32, 0.2, 0.3].map(|c| (f64::from(c) * 2.0) as f32).into(),
        maps: Maps {
            base_colour: Some(colours),
            roughness: channel(numbers, 1),
            metallic: channel(numbers, 2),
            normal: Some(NormalMap { texture: numbers, scale: 0.5 }),
            specular: channel(numbers, 3),
            specular_colour: Some(numbers),
            transmission: channel(numbers, 0),
            ..Maps::default()
        },
        ..Principled::paint(Vec3::ONE, 0.5)
    }));
    let positions = [(1.5, -1.0, 1.0), (-0.5, -1.0, 0.0), (-0.5, 1.0, 0.0), (1.5, 1.0, 1.0)];
    let positions = positions.map(|(x, y, z)| Vec3::new(x, y, z)).to_vec();
    // What is mirrored runs the other way.
    let triangles = vec![[0, 2, 1], [0, 3, 2]];
    let of_corners = |triangles: &[[u32; 3]]| triangles.to_vec();
    let half = std::f64::consts::FRAC_1_SQRT_2 as f32;
    let normals = [Vec3::Z, Vec3::new(-half, 0.0, half), Vec3::new(0.0, half, half), Vec3::Z];
    let uvs = [(-0.5, -0.5), (1.5, -0.5), (1.5, 1.5), (-0.5, 1.5)].map(|(u, v)| Vec2::new(u, v));
    let mesh = Mesh {
        normals: Some(
            of_corners(&triangles).iter().map(|t| t.map(|at| normals[at as usize])).collect(),
        ),
        texture_coordinates: Some(
            of_corners(&triangles).iter().map(|t| t.map(|at| uvs[at as usize])).collect(),
        ),
        ..Mesh::new(material, positions, triangles)
    };
    scene.add_mesh(mesh);
    scene
}

#[test]
fn a_gltf_is_the_scene_that_code_makes() {
    let (mut loaded, mut made) = (gltf().scene(), code());
    assert_eq!(loaded.materials, made.materials);
    assert_eq!(loaded.textures, made.textures);
    assert_eq!(loaded.meshes, made.meshes);
    assert_eq!((loaded.camera, loaded.film), (made.camera, made.film));
    assert_eq!(loaded.environment, None, "the square emits");
    let picture = |scene: &mut Scene| {
        scene.film = FilmSize { width: 20, height: 16 };
        scene.set_environment(Environment::new(1, 2, vec![Vec3::ONE, Vec3::X]));
        let film = render(&prepare(scene), &settings(scene), 8);
        film.radiance
            .iter()
            .map(|pixel| pixel.sum().to_array().map(f32::to_bits))
            .collect::<Vec<_>>()
    };
    let (loaded, made) = (picture(&mut loaded), picture(&mut made));
    assert!(made.iter().any(|pixel| *pixel != made[0]), "there is something to see");
    assert_eq!(loaded, made);
}

#[test]
fn text_and_binary_are_one() {
    let binary = gltf().scene();
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).unwrap();
    let mut gltf = gltf();
    write("my buffer.bin", &gltf.binary);
    gltf.json["buffers"][0] = json!({"byteLength": gltf.binary.len(), "uri": "my%20buffer.bin"});
    write("a.gltf", gltf.text().to_string().as_bytes());
    let beside = raystream::scene::load(&folder.path().join("a.gltf")).unwrap();
    // By content, whatever the name.
    write("b.json", gltf.text().to_string().as_bytes());
    let by_content = raystream::scene::load(&folder.path().join("b.json")).unwrap();
    let hex: String = gltf.binary.iter().map(|byte| format!("%{byte:02x}")).collect();
    gltf.json["buffers"][0]["uri"] = json!(format!("data:application/octet-stream,{hex}"));
    write("c.gltf", gltf.text().to_string().as_bytes());
    let embedded = raystream::scene::load(&folder.path().join("c.gltf")).unwrap();
    for scene in [beside, by_content, embedded] {
        assert_eq!(scene.meshes, binary.meshes);
        assert_eq!(scene.textures, binary.textures);
        assert_eq!(scene.materials, binary.materials);
    }
}
