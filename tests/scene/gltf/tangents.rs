//! `TANGENT`: where maps of normals and grains point.

use glam::{DAffine3, DQuat, DVec3, Vec3, Vec4};
use raystream::film::Film;
use raystream::scene::{Environment, FilmSize, Scene};
use raystream_tests::gltf::Gltf;
use raystream_tests::{prepare, render, settings};
use serde_json::{Value, json};

/// Texture coordinates of the corners of a square.
type Coordinates = [[f32; 2]; 4];

/// As they lie in the plane of the square, with `v` downwards as files have it.
const UPRIGHT: Coordinates = [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]];
/// With `u` growing upwards.
const TURNED: Coordinates = [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]];
/// With `u` growing to the right and `v` the other way.
const MIRRORED: Coordinates = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];

/// A square of brushed metal with a map of normals that all lean the same way, with such texture
/// coordinates, and with tangents if wanted.
fn square(coordinates: &Coordinates, tangent: Option<[f32; 4]>) -> Gltf {
    let mut gltf = Gltf::new().with_camera();
    let corners = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];
    let positions = gltf.floats(&corners);
    let normals = gltf.floats(&[[0.0, 0.0, 1.0]; 4]);
    let uvs = gltf.floats(coordinates);
    let indices = gltf.indices(&[0, 1, 2, 0, 2, 3]);
    let texture = gltf.texture(1, &[[190, 150, 220, 255]], json!({}));
    gltf.add(
        "materials",
        json!({"normalTexture": {"index": texture}, "pbrMetallicRoughness": {"roughnessFactor": 0.4},
            "extensions": {"KHR_materials_anisotropy": {"anisotropyStrength": 0.6}}}),
    );
    let mut attributes = json!({"POSITION": positions, "NORMAL": normals, "TEXCOORD_0": uvs});
    if let Some(tangent) = tangent {
        attributes["TANGENT"] = json!(gltf.floats(&[tangent; 4]));
    }
    let primitive = json!({"material": 0, "attributes": attributes, "indices": indices});
    let mesh = gltf.mesh(primitive);
    gltf.node(json!({"mesh": mesh}));
    gltf
}

/// A picture of it, under light that is coloured by where it comes from.
fn film(mut scene: Scene) -> Film {
    scene.film = FilmSize { width: 8, height: 6 };
    let texels = (0..32).map(|k| Vec3::new((k % 8) as f32, (k / 8) as f32, (k % 3) as f32));
    scene.set_environment(Environment::new(8, 4, texels.collect()));
    render(&prepare(&scene), &settings(&scene), 16)
}

/// The largest difference of two pictures, in means of the first.
fn difference(a: Scene, b: Scene) -> f32 {
    let (a, b) = (film(a), film(b));
    let mean = |film: &Film| -> Vec<Vec3> {
        film.radiance.iter().map(|pixel| pixel.sum() / 16.0).collect()
    };
    let (a, b) = (mean(&a), mean(&b));
    let whole = a.iter().map(|c| c.element_sum()).sum::<f32>() / (3 * a.len()) as f32;
    let off = a.iter().zip(&b).map(|(a, b)| (*a - *b).abs().max_element());
    off.fold(0.0, f32::max) / whole
}

/// Packed directions are good to 1.5e-4; a path may go another way at an edge.
const SAME: f32 = 0.01;
const OTHER: f32 = 0.1;

#[test]
fn tangents_say_where_maps_and_grains_point() {
    for (coordinates, tangent) in [
        (UPRIGHT, [1.0, 0.0, 0.0, 1.0]),
        (TURNED, [0.0, 1.0, 0.0, 1.0]),
        (MIRRORED, [1.0, 0.0, 0.0, -1.0]),
    ] {
        let by_coordinates = || square(&coordinates, None).scene();
        for other in [UPRIGHT, TURNED, MIRRORED] {
            let by_tangents = square(&other, Some(tangent)).scene();
            assert!(by_tangents.meshes[0].tangents.is_some());
            let off = difference(by_coordinates(), by_tangents);
            assert!(off < SAME, "{tangent:?}: {off}");
            if other != coordinates {
                let off = difference(by_coordinates(), square(&other, None).scene());
                assert!(off > OTHER, "the map or the grain is seen: {off}");
            }
        }
    }
}

#[test]
fn tangents_go_with_their_surface() {
    // Stretched, turned and mirrored.
    for matrix in [
        json!([0.7, 0.7, 0, 0, -0.7, 0.7, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]),
        json!([-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]),
        json!([1, 0, 0, 0, 0, 0.6, 0.5, 0, 0, 0, 1, 0, 0, 0, 0, 1]),
    ] {
        let placed = |mut gltf: Gltf| {
            gltf.json["nodes"][1]["matrix"] = matrix.clone();
            gltf.scene()
        };
        let by_coordinates = placed(square(&TURNED, None));
        let by_tangents = placed(square(&UPRIGHT, Some([0.0, 1.0, 0.0, 1.0])));
        let off = difference(by_coordinates, by_tangents);
        assert!(off < SAME, "{matrix}: {off}");
    }
}

#[test]
fn instances_have_the_tangents_of_their_shape() {
    for scale in [DVec3::new(0.8, 0.5, 1.0), DVec3::new(-0.9, 0.6, 1.0)] {
        let angle = DQuat::from_rotation_z(0.6);
        let place = DAffine3::from_scale_rotation_translation(scale, angle, DVec3::ZERO);
        let mut by_coordinates = square(&TURNED, None).scene();
        let mesh = by_coordinates.meshes.pop().unwrap();
        by_coordinates.add_mesh(mesh.moved(&place));
        let mut kept = square(&UPRIGHT, Some([0.0, 1.0, 0.0, 1.0])).scene();
        let mesh = kept.meshes.pop().unwrap();
        let shape = kept.add_shape(mesh);
        kept.add_instance(shape, place);
        let off = difference(by_coordinates, kept);
        assert!(off < SAME, "{scale}: {off}");
    }
}

#[test]
fn a_grain_needs_no_texture_coordinates_where_there_are_tangents() {
    let with = |change: &dyn Fn(&mut Value)| {
        let mut gltf = square(&UPRIGHT, Some([0.0, 1.0, 0.0, 1.0]));
        gltf.json["materials"][0].as_object_mut().unwrap().remove("normalTexture");
        change(&mut gltf.json["meshes"][0]["primitives"][0]["attributes"]);
        gltf.scene()
    };
    let remove = |name: &'static str| {
        move |attributes: &mut Value| {
            attributes.as_object_mut().unwrap().remove(name);
        }
    };
    let without = with(&remove("TEXCOORD_0"));
    assert!(!format!("{:?}", without.warnings).contains("along what"), "{:?}", without.warnings);
    assert!(difference(with(&|_| ()), without) < 1e-6);
    // Tangents count where there are normals, says glTF.
    assert_eq!(with(&remove("NORMAL")).meshes[0].tangents, None);
}

#[test]
fn tangents_that_are_none_leave_it_to_the_coordinates() {
    for (tangent, expected) in [
        ([f32::NAN, 0.0, 0.0, 1.0], [Vec4::ZERO; 3]),
        ([0.0, 0.0, 0.0, 1.0], [Vec4::ZERO; 3]),
        ([0.0, 5.0, 0.0, -0.5], [Vec4::new(0.0, 1.0, 0.0, -1.0); 3]),
    ] {
        let scene = square(&UPRIGHT, Some(tangent)).scene();
        assert_eq!(scene.meshes[0].tangents, Some(vec![expected; 2]), "{tangent:?}");
        let is_said = format!("{:?}", scene.warnings).contains("no numbers");
        assert_eq!(is_said, tangent[0].is_nan());
    }
    let mut short = square(&UPRIGHT, Some([1.0, 0.0, 0.0, 1.0]));
    let accessor = short.json["meshes"][0]["primitives"][0]["attributes"]["TANGENT"].as_u64();
    short.json["accessors"][accessor.unwrap() as usize]["count"] = json!(3);
    assert!(short.load().unwrap_err().to_string().contains("TANGENT"));
}

#[test]
fn a_mesh_with_broken_tangents_is_refused() {
    let mut scene = square(&UPRIGHT, Some([1.0, 0.0, 0.0, 1.0])).scene();
    for wrong in [Vec4::new(2.0, 0.0, 0.0, 1.0), Vec4::new(1.0, 0.0, 0.0, 0.5), Vec4::NAN] {
        scene.meshes[0].tangents.as_mut().unwrap()[1] = [wrong; 3];
        let message = scene.check().unwrap_err().to_string();
        assert!(message.contains("tangents[1]"), "{message}");
    }
}
