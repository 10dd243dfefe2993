//! Textures of all kinds, and where each lies.

use super::assert_warns;
use glam::{Mat2, Vec2};
use raystream::scene::{
    Channel, CoordinateSet, Maps, Material, NormalMap, Placement, Principled, Scene, SceneError,
    TextureId,
};
use raystream_tests::gltf::Gltf;
use serde_json::{Value, json};
use std::sync::Arc;

const UVS: [[f32; 2]; 3] = [[0.0, 0.0], [1.0, 0.0], [0.0, 0.25]];

/// A triangle with these sets of texture coordinates and a texture for a material to show.
fn with_sets(sets: &[u32], material: impl Fn(usize) -> Value) -> Gltf {
    let mut gltf = Gltf::triangle();
    for set in sets {
        let uvs = UVS.map(|[u, v]| [u + *set as f32, v]);
        let accessor = gltf.floats(&uvs);
        let attributes = &mut gltf.json["meshes"][0]["primitives"][0]["attributes"];
        attributes[format!("TEXCOORD_{set}")] = json!(accessor);
    }
    gltf.json["meshes"][0]["primitives"][0]["material"] = json!(0);
    let texture = gltf.texture(1, &[[102, 51, 204, 153]], json!({}));
    gltf.add("materials", material(texture));
    gltf
}

fn principled(scene: &Scene) -> Principled {
    match scene.materials[..] {
        [Material::Principled(principled)] => principled,
        ref other => panic!("{other:?}"),
    }
}

/// A material with all textures that layers may have, in this set of texture coordinates.
fn layered(texture: usize, set: u32) -> Value {
    let it = json!({"index": texture, "texCoord": set});
    json!({
        "doubleSided": true,
        "extensions": {
            "KHR_materials_clearcoat": {
                "clearcoatFactor": 0.5, "clearcoatTexture": it,
                "clearcoatRoughnessFactor": 0.25, "clearcoatRoughnessTexture": it,
                "clearcoatNormalTexture": {"index": texture, "texCoord": set, "scale": 0.75},
            },
            "KHR_materials_sheen": {
                "sheenColorFactor": [1, 1, 1], "sheenColorTexture": it,
                "sheenRoughnessFactor": 0.5, "sheenRoughnessTexture": it,
            },
            "KHR_materials_specular":
                {"specularTexture": it, "specularColorTexture": it},
            "KHR_materials_transmission": {"transmissionFactor": 1, "transmissionTexture": it},
            "KHR_materials_anisotropy": {"anisotropyStrength": 0.5, "anisotropyTexture": it},
        },
    })
}

#[test]
fn textures_of_layers_arrive() {
    let scene = with_sets(&[0], |texture| layered(texture, 0)).scene();
    let texture = TextureId(0);
    let channel = |channel: u32| Some(Channel { texture, channel });
    let found = principled(&scene);
    let expected = Maps {
        coat: channel(0),
        coat_roughness: channel(1),
        coat_normal: Some(NormalMap { texture, scale: 0.75 }),
        sheen: Some(texture),
        sheen_roughness: channel(3),
        transmission: channel(0),
        specular: channel(3),
        specular_colour: Some(texture),
        anisotropy: Some(texture),
        ..Maps::default()
    };
    assert_eq!(found.maps, expected);
    assert_eq!((found.coat, found.coat_roughness, found.transmission), (0.5, 0.25, 1.0));
    assert_eq!(scene.textures.len(), 1);
    assert_eq!(scene.textures[0].placement, Placement::default());
    assert!(!format!("{:?}", scene.warnings).contains("exture"), "{:?}", scene.warnings);
}

/// Without coordinates it is as if the texture was its mean everywhere.
#[test]
fn without_coordinates_layers_have_means() {
    let scene = with_sets(&[0], |texture| layered(texture, 1)).scene();
    assert_warns(&scene, &["a.glb: ", "without usable texture coordinates"]);
    let found = principled(&scene);
    assert_eq!(found.maps, Maps::default());
    let close = |a: f32, b: f32| assert!((a - b).abs() < 1e-6, "{a} {b}");
    close(found.coat, 0.5 * 0.4);
    close(found.coat_roughness, 0.25 * 0.2);
    close(found.sheen_roughness, 0.5 * 0.6);
    close(found.transmission, 0.4);
    close(found.anisotropy.strength, 0.5 * 0.8);
    assert!((found.specular - found.sheen * 0.6).abs().max_element() < 1e-6, "{found:?}");
    assert!((found.sheen.x - 0.1329).abs() < 1e-4, "{}", found.sheen);
}

/// Colour in one set, numbers in another that is turned and scaled, normals in a third.
fn of_three_sets(texture: usize) -> Value {
    let transform = json!({
        "offset": [0.5, 0.25], "rotation": std::f64::consts::FRAC_PI_2, "scale": [2, 4],
    });
    json!({
        "doubleSided": true,
        "pbrMetallicRoughness": {
            "baseColorTexture": {"index": texture, "texCoord": 1},
            "metallicRoughnessTexture": {
                "index": texture, "extensions": {"KHR_texture_transform": transform},
            },
        },
        "normalTexture": {"index": texture, "texCoord": 2},
    })
}

#[test]
fn textures_of_a_material_lie_each_by_itself() {
    let scene = with_sets(&[0, 1, 2], of_three_sets).scene();
    let maps = principled(&scene).maps;
    let texture = |id: TextureId| &scene.textures[id.0 as usize];
    let colour = texture(maps.base_colour.expect("a colour"));
    assert_eq!(colour.placement, Placement::default());
    let numbers = texture(maps.roughness.expect("a roughness").texture);
    let Placement { set, matrix, offset } = numbers.placement;
    assert_eq!(set, CoordinateSet::Second);
    // In the file's axes (u, v) become (4 v + 0.5, -2 u + 0.25).
    let expected = Mat2::from_cols(Vec2::new(0.0, 2.0), Vec2::new(-4.0, 0.0));
    assert!(matrix.abs_diff_eq(expected, 1e-6), "{matrix}");
    assert!(offset.abs_diff_eq(Vec2::new(4.5, 0.75), 1e-6), "{offset}");
    assert!(Arc::ptr_eq(&numbers.texels, &colour.texels), "they share their texels");
    // The third set is not there: the first is taken, and that is said.
    assert_warns(&scene, &["a.glb: ", "two sets of texture coordinates", "`normalTexture`"]);
    let mesh = &scene.meshes[0];
    let uvs = |set: f32| UVS.map(|[u, v]| Vec2::new(u + set, 1.0 - v));
    assert_eq!(mesh.texture_coordinates, Some(vec![uvs(1.0)]));
    assert_eq!(mesh.second_coordinates, Some(vec![uvs(0.0)]));
}

#[test]
fn a_set_that_a_mesh_lacks_leaves_the_mean_of_its_textures_alone() {
    let scene = with_sets(&[0], of_three_sets).scene();
    assert_warns(&scene, &["a.glb: ", "without usable texture coordinates"]);
    let found = principled(&scene);
    assert_eq!((found.maps.base_colour, found.maps.normal), (None, None));
    assert!(found.maps.roughness.is_some() && found.maps.metallic.is_some());
    assert!((found.base_colour.x - 0.1329).abs() < 1e-4, "{}", found.base_colour);
    // All that is left lies alike: coordinates have moved.
    assert_eq!(scene.textures.len(), 1);
    assert!(scene.meshes[0].second_coordinates.is_none());
}

#[test]
fn textures_that_are_none_are_errors_that_name_them() {
    for (extension, value, expected) in [
        ("KHR_materials_anisotropy", json!({"anisotropyTexture": {}}), "index"),
        (
            "KHR_materials_clearcoat",
            json!({"clearcoatFactor": 1, "clearcoatTexture": {"index": 9}}),
            "clearcoatTexture",
        ),
        (
            "KHR_materials_sheen",
            json!({
                "sheenColorFactor": [1, 1, 1],
                "sheenColorTexture": {
                    "index": 0, "extensions": {"KHR_texture_transform": {"scale": [1]}},
                },
            }),
            "KHR_texture_transform",
        ),
        ("KHR_materials_anisotropy", json!({"anisotropyStrength": "x"}), "anisotropy"),
    ] {
        let gltf = with_sets(&[0], |_| json!({"extensions": {extension: value}}));
        let error: SceneError = gltf.load().unwrap_err();
        let error = error.to_string();
        assert!(error.contains("materials[0]") && error.contains(expected), "{error}");
    }
}

#[test]
fn a_placement_that_is_too_far_is_an_error() {
    let gltf = with_sets(&[0, 1], |texture| {
        let far = json!({"offset": [1e12, 0]});
        json!({"pbrMetallicRoughness": {
            "baseColorTexture": {"index": texture, "texCoord": 1},
            "metallicRoughnessTexture":
                {"index": texture, "extensions": {"KHR_texture_transform": far}},
        }})
    });
    let error = gltf.load().unwrap_err().to_string();
    assert!(error.contains("placement"), "{error}");
}
