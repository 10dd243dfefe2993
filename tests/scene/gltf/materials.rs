//! What surfaces are made of.

use super::assert_warns;
use glam::{Vec2, Vec3, Vec4};
use raystream::scene::{
    Anisotropy, Attenuation, LoadOptions, Material, Opacity, Principled, Scene, SceneError, Texels,
    TextureFilter, TextureId,
};
use raystream_tests::gltf::{Gltf, png};
use serde_json::{Value, json};
use std::path::Path;

const WHITE: [u8; 4] = [255; 4];

/// A triangle with texture coordinates, of this material.
fn with_material(material: Value) -> Gltf {
    let mut gltf = Gltf::triangle();
    let uvs = gltf.floats(&[[0.0, 0.0], [1.0, 0.0], [0.0, 0.25]]);
    let primitive = &mut gltf.json["meshes"][0]["primitives"][0];
    primitive["attributes"]["TEXCOORD_0"] = json!(uvs);
    primitive["material"] = json!(0);
    gltf.add("materials", material);
    gltf
}

fn principled(scene: &Scene) -> Principled {
    match scene.materials[..] {
        [Material::Principled(principled)] => principled,
        ref other => panic!("{other:?}"),
    }
}

#[test]
fn without_a_word_a_surface_is_rough_white_metal() {
    let found = principled(&Gltf::triangle().scene());
    assert_eq!(found, Principled::metal(Vec3::ONE, 1.0));
}

#[test]
fn what_paint_and_metal_lack_is_said_once_for_each_kind() {
    let gltf = with_material(json!({
        "name": "car", "alphaMode": "BLEND", "doubleSided": true,
        "pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0, 0.5]},
        "emissiveFactor": [1, 1, 1],
        "extensions": {
            "KHR_materials_iridescence": {"iridescenceFactor": 0},
            "KHR_materials_transmission": {"transmissionFactor": 1},
            "KHR_materials_volume": {"thicknessFactor": 1, "thicknessTexture": {"index": 0}},
        },
    }));
    let scene = gltf.scene();
    for what in
        ["what emits is opaque: `alphaMode`", "lamps shine from the front alone: `doubleSided`"]
    {
        assert_warns(&scene, &["a.glb: ", what]);
    }
    assert!(!format!("{:?}", scene.warnings).contains("thin films"), "{:?}", scene.warnings);
    let details = scene.details.join("\n");
    assert!(
        details.contains("its mesh is thick, whatever this says: `thicknessTexture`"),
        "{details}"
    );
    assert_eq!(principled(&scene).transmission, 1.0);
}

#[test]
fn coats_sheen_and_volumes_arrive() {
    let scene = with_material(json!({
        "doubleSided": true,
        "extensions": {
            "KHR_materials_clearcoat":
                {"clearcoatFactor": 0.75, "clearcoatRoughnessFactor": 0.25},
            "KHR_materials_sheen": {"sheenColorFactor": [0, 0.5, 1], "sheenRoughnessFactor": 0.75},
            "KHR_materials_transmission": {"transmissionFactor": 1},
            "KHR_materials_volume": {
                "thicknessFactor": 1, "attenuationColor": [1, 0.5, 0.25], "attenuationDistance": 2,
            },
        },
    }))
    .scene();
    let found = principled(&scene);
    let colour = Vec3::new(1.0, 0.5, 0.25);
    let expected = Principled {
        coat: 0.75,
        coat_roughness: 0.25,
        sheen: Vec3::new(0.0, 0.5, 1.0),
        sheen_roughness: 0.75,
        transmission: 1.0,
        thin_walled: false,
        attenuation: Some(Attenuation { colour, distance: 2.0 }),
        ..Principled::metal(Vec3::ONE, 1.0)
    };
    assert_eq!(found, expected);
    assert!(!format!("{:?}", scene.warnings).contains("KHR_"), "{:?}", scene.warnings);
}

#[test]
fn glass_without_thickness_is_thin() {
    for extensions in [
        json!({"KHR_materials_transmission": {"transmissionFactor": 1}}),
        json!({
            "KHR_materials_transmission": {"transmissionFactor": 1},
            "KHR_materials_volume": {"attenuationDistance": 2},
        }),
    ] {
        let found = principled(&with_material(json!({"extensions": extensions})).scene());
        assert!(found.thin_walled, "{found:?}");
        assert_eq!(found.attenuation, None);
    }
}

#[test]
fn holes_are_where_alpha_leaves_some() {
    let mut gltf = with_material(json!({"alphaMode": "MASK", "name": "a"}));
    let opacity = |gltf: &Gltf| principled(&gltf.scene()).opacity;
    assert_eq!(opacity(&gltf), Opacity::Opaque, "alpha is 1 everywhere");
    let texture = gltf.texture(1, &[[255, 255, 255, 254]], json!({}));
    gltf.json["materials"][0]["pbrMetallicRoughness"] =
        json!({"baseColorTexture": {"index": texture}, "baseColorFactor": [1, 1, 1, 0.75]});
    assert_eq!(opacity(&gltf), Opacity::Mask { alpha: 0.75, cutoff: 0.5 });
    gltf.json["materials"][0]["alphaCutoff"] = json!(0.25);
    assert_eq!(opacity(&gltf), Opacity::Mask { alpha: 0.75, cutoff: 0.25 });
    gltf.json["materials"][0]["alphaMode"] = json!("BLEND");
    assert_eq!(opacity(&gltf), Opacity::Blend { alpha: 0.75 });
    gltf.json["materials"][0]["alphaMode"] = json!("OPAQUE");
    assert_eq!(opacity(&gltf), Opacity::Opaque);
}

#[test]
fn what_is_quite_transparent_is_not_there() {
    let mut gltf = with_material(json!({"alphaMode": "BLEND",
        "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0]}}));
    assert!(gltf.load().unwrap_err().to_string().contains("no triangle"));
    gltf.node(json!({"mesh": 1}));
    gltf.mesh(json!({"attributes": {"POSITION": 0}}));
    assert_eq!(gltf.scene().triangle_count(), 1);
}

#[test]
fn unlit_becomes_matt_paint() {
    let scene = with_material(json!({
        "pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.25, 1, 1], "roughnessFactor": 0},
        "extensions": {"KHR_materials_unlit": {}},
    }))
    .scene();
    let found = principled(&scene);
    let paint = Principled::paint(Vec3::new(0.5, 0.25, 1.0), 1.0);
    assert_eq!(found, Principled { specular: Vec3::ZERO, f90: 0.0, ..paint });
    assert_warns(&scene, &["KHR_materials_unlit", "paint"]);
}

#[test]
fn the_older_model_becomes_the_newer_one() {
    let scene = with_material(json!({"extensions": {"KHR_materials_pbrSpecularGlossiness": {
        "diffuseFactor": [0.5, 0.25, 0.125, 1], "specularFactor": [0.04, 0.08, 0.02],
        "glossinessFactor": 0.75,
    }}}))
    .scene();
    let found = principled(&scene);
    assert_eq!((found.base_colour, found.metallic), (Vec3::new(0.5, 0.25, 0.125), 0.0));
    assert_eq!(found.roughness, 0.25);
    assert!((found.specular - Vec3::new(1.0, 2.0, 0.5)).length() < 1e-5, "{}", found.specular);
}

#[test]
fn values_beyond_their_range_are_brought_into_it() {
    let scene = with_material(json!({
        "pbrMetallicRoughness": {"baseColorFactor": [2, -1, 0.5, 1], "roughnessFactor": 7},
        "emissiveFactor": [1, 0, 0],
        "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 1e30}},
    }))
    .scene();
    let found = principled(&scene);
    assert_eq!((found.base_colour, found.roughness), (Vec3::new(1.0, 0.0, 0.5), 1.0));
    assert_eq!(found.emission, Vec3::X * 1e12);
    assert_warns(&scene, &["brought into it", "base colour", "roughnessFactor"]);
}

#[test]
fn transforms_that_all_textures_share_are_baked() {
    let mut gltf = with_material(json!({"name": "a"}));
    let texture = gltf.texture(1, &[WHITE], json!({}));
    let set = gltf.floats(&[[0.5, 0.5]; 3]);
    gltf.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_1"] = json!(set);
    let moved = |offset: f64| {
        json!({"index": texture, "extensions": {"KHR_texture_transform":
            {"offset": [offset, 0.5], "scale": [2, 4]}}})
    };
    gltf.json["materials"][0]["pbrMetallicRoughness"] = json!({"baseColorTexture": moved(0.25)});
    gltf.json["materials"][0]["normalTexture"] = moved(0.25);
    let scene = gltf.scene();
    let found = scene.meshes[0].texture_coordinates.as_ref().unwrap()[0];
    // Down in the file, up here.
    assert_eq!(found, [Vec2::new(0.25, 0.5), Vec2::new(2.25, 0.5), Vec2::new(0.25, -0.5)]);
    assert!(!format!("{:?}", scene.warnings).contains("transform"), "{:?}", scene.warnings);

    // Where they lie differently, coordinates are the file's and each lies by itself.
    gltf.json["materials"][0]["normalTexture"] = moved(0.5);
    let scene = gltf.scene();
    let found = scene.meshes[0].texture_coordinates.as_ref().unwrap()[0];
    assert_eq!(found, [Vec2::new(0.0, 1.0), Vec2::new(1.0, 1.0), Vec2::new(0.0, 0.75)]);
    let maps = principled(&scene).maps;
    let placement = |texture: TextureId| scene.textures[texture.0 as usize].placement;
    assert_eq!(placement(maps.base_colour.unwrap()).of(found[0]), Vec2::new(0.25, 0.5));
    assert_eq!(placement(maps.normal.unwrap().texture).of(found[1]), Vec2::new(2.5, 0.5));
    assert!(!format!("{:?}", scene.warnings).contains("coordinates"), "{:?}", scene.warnings);
    // The extension may name another set.
    let mut other = moved(0.25);
    other["extensions"]["KHR_texture_transform"]["texCoord"] = json!(1);
    gltf.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = other;
    gltf.json["materials"][0].as_object_mut().unwrap().remove("normalTexture");
    let scene = gltf.scene();
    assert_eq!(
        scene.meshes[0].texture_coordinates.as_ref().unwrap()[0],
        [Vec2::new(1.25, -1.5); 3]
    );
}

#[test]
fn textures_without_coordinates_show_their_mean() {
    let mut gltf = with_material(json!({"name": "a"}));
    let colours = gltf.texture(2, &[WHITE, [0, 0, 0, 255]], json!({}));
    let numbers = gltf.texture(2, &[[0, 255, 51, 255], [0, 0, 51, 255]], json!({}));
    gltf.json["materials"][0]["pbrMetallicRoughness"] = json!({
        "baseColorTexture": {"index": colours}, "metallicRoughnessTexture": {"index": numbers},
        "roughnessFactor": 0.5,
    });
    let attributes = &mut gltf.json["meshes"][0]["primitives"][0]["attributes"];
    attributes.as_object_mut().unwrap().remove("TEXCOORD_0");
    let scene = gltf.scene();
    let found = principled(&scene);
    assert!((found.base_colour - 0.5).abs().max_element() < 1e-6, "{}", found.base_colour);
    assert!((found.roughness - 0.25).abs() < 1e-6 && (found.metallic - 0.2).abs() < 1e-6);
    assert_eq!(found.maps, raystream::scene::Maps::default());
    assert_warns(&scene, &["mean of their texture", "meshes[0].primitives[0]"]);
}

#[test]
fn pictures_that_cannot_be_read_leave_plain_colours() {
    let mut gltf = with_material(json!({
        "name": "a", "pbrMetallicRoughness": {
            "baseColorTexture": {"index": 0}, "metallicRoughnessTexture": {"index": 1},
            "metallicFactor": 0.5,
        },
        "normalTexture": {"index": 2},
    }));
    gltf.add("textures", json!({"source": 0}));
    gltf.add("textures", json!({"source": 1}));
    gltf.add("textures", json!({"extensions": {"KHR_texture_basisu": {"source": 0}}}));
    gltf.image(b"no picture");
    gltf.add("images", json!({"uri": "lost.png"}));
    gltf.json["extensionsUsed"] = json!(["KHR_texture_basisu"]);
    let scene = gltf.scene();
    let found = principled(&scene);
    assert_eq!((found.base_colour, found.metallic), (Vec3::ONE, 0.5));
    assert_eq!(found.maps, raystream::scene::Maps::default());
    assert_warns(&scene, &["cannot be read", "images[0]"]);
    assert_warns(&scene, &["are not there", "lost.png", "textures[2] (KTX2"]);
    assert_warns(&scene, &["extensions are not read: `KHR_texture_basisu`"]);
}

#[test]
fn textures_are_shown_in_whole_texels_where_that_is_asked_for() {
    for (filter, expected) in [(9728, TextureFilter::Nearest), (9729, TextureFilter::Linear)] {
        let mut gltf =
            with_material(json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}));
        gltf.texture(1, &[WHITE], json!({"magFilter": filter, "minFilter": 9728}));
        let scene = gltf.scene();
        assert_eq!(scene.textures[0].filter, expected);
    }
}

#[test]
fn webp_is_read_in_place_of_the_other_picture() {
    let mut gltf =
        with_material(json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}));
    let mut webp = std::io::Cursor::new(Vec::new());
    let texel = image::RgbaImage::from_pixel(1, 1, image::Rgba([1, 2, 3, 255]));
    texel.write_to(&mut webp, image::ImageFormat::WebP).unwrap();
    let other = gltf.image(&png(1, &[WHITE]));
    let image = gltf.image(&webp.into_inner());
    gltf.add(
        "textures",
        json!({"source": other, "extensions": {"EXT_texture_webp": {"source": image}}}),
    );
    let scene = gltf.scene();
    assert_eq!(*scene.textures[0].texels, Texels::Bytes(vec![[1, 2, 3, 255]]));
    assert_eq!(principled(&scene).maps.base_colour, Some(TextureId(0)));
}

#[test]
fn colours_of_vertices_are_the_materials_where_they_are_one() {
    let mut gltf =
        with_material(json!({"pbrMetallicRoughness": {"baseColorFactor": [0.5, 1, 1, 1]}}));
    let one = gltf.floats(&[[0.5, 0.25, 1.0]; 3]);
    let several = gltf.floats(&[[0.5, 0.25, 1.0], [0.5, 0.25, 1.0], [0.5, 1.0, 1.0]]);
    let attribute = |gltf: &mut Gltf, accessor: usize| {
        gltf.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = json!(accessor);
        gltf.scene()
    };
    let scene = attribute(&mut gltf, one);
    assert_eq!(principled(&scene).base_colour, Vec3::new(0.25, 0.25, 1.0));
    assert!(!format!("{:?}", scene.warnings).contains("colour"), "{:?}", scene.warnings);
    let scene = attribute(&mut gltf, several);
    assert_eq!(principled(&scene).base_colour, Vec3::new(0.5, 1.0, 1.0));
    let colours = scene.meshes[0].colours.as_ref().unwrap()[0];
    let expected = [
        Vec4::new(0.5, 0.25, 1.0, 1.0),
        Vec4::new(0.5, 0.25, 1.0, 1.0),
        Vec4::new(0.5, 1.0, 1.0, 1.0),
    ];
    assert_eq!(colours, expected);
    assert!(!format!("{:?}", scene.warnings).contains("colour"), "{:?}", scene.warnings);
}

#[test]
fn the_alpha_of_vertices_makes_holes_where_alpha_does() {
    let with = |material: Value| {
        let mut gltf = with_material(material);
        let alphas = gltf.floats(&[[1.0, 1.0, 1.0, 0.5]; 3]);
        gltf.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = json!(alphas);
        gltf.scene()
    };
    let blend = with(json!({"alphaMode": "BLEND"}));
    assert_eq!(principled(&blend).opacity, Opacity::Blend { alpha: 1.0 });
    assert_eq!(blend.meshes[0].colours.as_ref().unwrap()[0], [Vec4::new(1.0, 1.0, 1.0, 0.5); 3]);
    let mask = with(json!({"alphaMode": "MASK", "alphaCutoff": 0.25}));
    assert_eq!(principled(&mask).opacity, Opacity::Mask { alpha: 1.0, cutoff: 0.25 });
    let opaque = with(json!({}));
    assert_eq!(principled(&opaque).opacity, Opacity::Opaque);
    let body = with(json!({"alphaMode": "BLEND", "extensions": {
        "KHR_materials_transmission": {"transmissionFactor": 1},
        "KHR_materials_volume": {"thicknessFactor": 1},
    }}));
    assert_eq!(principled(&body).opacity, Opacity::Opaque);
    assert_warns(&body, &["bodies have no holes", "COLOR_0"]);
}

#[test]
fn a_grain_is_read_and_takes_texture_coordinates() {
    let brushed = json!({"extensions": {"KHR_materials_anisotropy": {
        "anisotropyStrength": 0.6, "anisotropyRotation": std::f64::consts::FRAC_PI_2,
    }}});
    let mut gltf = with_material(brushed);
    let coordinates = gltf.floats(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]);
    let scene = gltf.scene();
    let has_coordinates = scene.meshes[0].texture_coordinates.is_some();
    assert!(has_coordinates == scene.warnings.iter().all(|w| !w.contains("along what")));
    gltf.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = json!(coordinates);
    let scene = gltf.scene();
    let Anisotropy { strength, rotation } = principled(&scene).anisotropy;
    assert!((strength - 0.6).abs() < 1e-6 && (rotation - 90.0).abs() < 1e-4, "{rotation}");
    assert!(scene.meshes[0].texture_coordinates.is_some());
    assert!(!format!("{:?}", scene.warnings).contains("alike in all directions"));
}

/// A triangle that is red, but green and blue in variants.
fn with_variants() -> Gltf {
    let colour = |rgb: [f32; 3]| {
        let [r, g, b] = rgb;
        json!({"pbrMetallicRoughness": {"baseColorFactor": [r, g, b, 1]}})
    };
    let mut gltf = with_material(colour([1.0, 0.0, 0.0]));
    let green = gltf.add("materials", colour([0.0, 1.0, 0.0]));
    let blue = gltf.add("materials", colour([0.0, 0.0, 1.0]));
    let named = ["leaf", "sky", "plain"].map(|name| json!({"name": name}));
    gltf.json["extensions"] = json!({"KHR_materials_variants": {"variants": named}});
    gltf.json["extensionsUsed"] = json!(["KHR_materials_variants"]);
    gltf.json["extensionsRequired"] = json!(["KHR_materials_variants"]);
    gltf.json["meshes"][0]["primitives"][0]["extensions"] = json!({"KHR_materials_variants": {
        "mappings": [{"material": green, "variants": [0]}, {"material": blue, "variants": [1]}],
    }});
    gltf
}

fn in_variant(gltf: &Gltf, variant: Option<&str>) -> Result<Scene, SceneError> {
    let files = [("a.glb".into(), gltf.glb())].into();
    let variant = variant.map(str::to_owned);
    LoadOptions { variant, ..LoadOptions::default() }.load_files(&files, Path::new("a.glb"))
}

#[test]
fn a_variant_has_its_own_materials() {
    let gltf = with_variants();
    for (variant, expected) in
        [(None, Vec3::X), (Some("leaf"), Vec3::Y), (Some("sky"), Vec3::Z), (Some("plain"), Vec3::X)]
    {
        let scene = in_variant(&gltf, variant).unwrap();
        assert_eq!(principled(&scene).base_colour, expected, "{variant:?}");
        assert_eq!(scene.variants, ["leaf", "sky", "plain"]);
        assert!(!format!("{:?}", scene.warnings).contains("not read"), "{:?}", scene.warnings);
    }
}

#[test]
fn unknown_variants_and_broken_ones_are_errors() {
    let gltf = with_variants();
    let error = in_variant(&gltf, Some("Leaf")).unwrap_err().to_string();
    for part in ["a.glb", "`Leaf`", "`leaf`, `sky`, `plain`"] {
        assert!(error.contains(part), "{error}");
    }
    let ply = b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
        property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
        0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    let files = [("a.ply".into(), ply.to_vec())].into();
    let options = LoadOptions { variant: Some("leaf".to_owned()), ..LoadOptions::default() };
    let error = options.load_files(&files, Path::new("a.ply")).unwrap_err().to_string();
    assert!(error.contains("`leaf`") && error.contains("none"), "{error}");

    let mappings = "/meshes/0/primitives/0/extensions/KHR_materials_variants/mappings";
    for (at, value, parts) in [
        ("/extensions/KHR_materials_variants", json!({}), ["extensions.KHR", "variants"]),
        ("/extensions/KHR_materials_variants/variants/1", json!({}), ["extensions.KHR", "name"]),
        (mappings, json!(7), ["primitives[0].extensions", "KHR_materials_variants"]),
        (&format!("{mappings}/1/variants"), json!([3]), ["mappings[1]", "variants"]),
        (&format!("{mappings}/1/variants"), json!([-1]), ["primitives[0].extensions", "-1"]),
        (&format!("{mappings}/0/material"), json!(9), ["mappings[0]", "materials"]),
    ] {
        let mut broken = with_variants();
        *broken.json.pointer_mut(at).unwrap() = value;
        let error = in_variant(&broken, Some("leaf")).unwrap_err().to_string();
        for part in parts {
            assert!(error.contains(part), "{at}: {error}");
        }
    }
}
