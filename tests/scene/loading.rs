//! What good scenes become.

use glam::{Vec2, Vec3};
use raystream::scene::{
    FilmSize, Material, PathLimits, Principled, QuadLight, Scene, Texture, TextureId, embedded,
    load, load_named,
};
use raystream_tests::large_scenes;
use raystream_tests::scene_folder::{MTL, SceneFolder};
use serde_json::json;
use std::path::Path;

fn loaded(folder: &SceneFolder) -> Scene {
    folder.load().unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn the_cornell_box() {
    let scene = embedded().unwrap();
    assert_eq!(scene.warnings, [""; 0]);
    assert_eq!(scene.triangle_count(), 6262);
    assert_eq!(scene.film, FilmSize { width: 800, height: 600 });
    assert_eq!(scene.limits, PathLimits { max_depth: 8, roulette_depth: 5 });
    // white, green, red, light, ball: the order of the OBJ.
    let [white, green, red, light, ball] = scene.materials[..] else { panic!("not five") };
    assert_eq!(white, Material::diffuse(Vec3::new(0.725, 0.71, 0.68)));
    for material in [green, red] {
        assert!(matches!(material, Material::Diffuse { .. }), "{material:?}");
    }
    assert_eq!(light, Material::emissive(Vec3::new(17.0, 12.0, 4.0)));
    assert_eq!(ball, Material::mirror(Vec3::splat(0.95)));
    let of_light = scene.meshes.iter().filter(|mesh| mesh.material.0 == 3);
    assert_eq!(of_light.map(|mesh| mesh.triangles.len()).sum::<usize>(), 2);
    // Only the ball has vn; they point away from its middle, as its triangles do.
    let middle = Vec3::new(0.683_453_2, 0.215_827_3, 0.629_496_4);
    for mesh in &scene.meshes {
        assert_eq!(mesh.normals.is_some(), mesh.material.0 == 4);
        assert_eq!(mesh.texture_coordinates, None);
        for (triangle, [normal, ..]) in mesh.normals.iter().flatten().enumerate() {
            let [a, b, c] = mesh.corners(triangle);
            assert!((normal.length() - 1.0).abs() < 1e-6);
            assert!(normal.dot((a - middle).normalize()) > 0.99);
            assert!((b - a).cross(c - a).normalize().dot(*normal) > 0.9);
        }
    }
}

#[test]
fn the_glass_ball_differs_by_its_material_only() {
    let (mirror, glass) = (embedded().unwrap(), load_named("cornell_glass").unwrap());
    assert_eq!(glass.meshes, mirror.meshes);
    assert_eq!(glass.materials[..4], mirror.materials[..4]);
    assert_eq!(glass.materials[4], Material::glass(1.5));
}

#[test]
fn the_shipped_files_are_what_is_built_in() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes");
    for name in
        ["cornell_ball", "cornell_glass", "opening", "caustics", "tea", "metals", "daylight"]
    {
        let from_disk = load(&folder.join(name).join(name).with_extension("json")).unwrap();
        assert_eq!(from_disk, load_named(name).unwrap());
    }
}

/// Counts by the reference implementation of format 1.
#[test]
fn the_large_scenes() {
    let Some(folder) = large_scenes() else { return };
    for (name, triangles, textured) in
        [("cornell_ball", 6262, 0), ("sibenik", 75_132, 63_053), ("conference", 331_195, 0)]
    {
        let path = folder.join(name).join(name).with_extension("json");
        let scene = load(&path).unwrap();
        assert_eq!(scene.triangle_count(), triangles, "{name}");
        let with_texture = scene
            .meshes
            .iter()
            .filter(|mesh| scene.materials[mesh.material.0 as usize].textures().next().is_some());
        let with_texture: usize = with_texture.map(|mesh| mesh.triangles.len()).sum();
        assert_eq!(with_texture, textured, "{name}");
    }
}

#[test]
fn material_rules() {
    let folder = SceneFolder::new();
    let obj = "mtllib A.MTL\nv 0 0 0\nv 1 0 0\nv 0 1 0\n".to_owned()
        + &["light", "mirror", "glass", "grey", "absent", "replaced"]
            .map(|m| format!("usemtl {m}\nf 1 2 3\n"))
            .concat();
    let mtl = "newmtl light\nKd .1 .2 .3\nKe 0 5 0\nillum 3\nnewmtl mirror\nillum 5\nKs .9 .8 .7\n\
               newmtl glass\nillum 7\nNi 1.33\nnewmtl grey\nKd .25\nnewmtl replaced\nKe 1 1 1\n";
    let rule = json!({"type": "emissive", "radiance": [1, 2, 3]});
    let scene = loaded(
        &folder
            .with("a.obj", obj)
            .with("a.mtl", mtl)
            .json(|scene| scene["materials"] = json!({"replaced": rule})),
    );
    let light =
        Material::Emissive { radiance: Vec3::Y * 5.0, reflectance: Vec3::new(0.1, 0.2, 0.3) };
    let expected = [
        light,
        Material::mirror(Vec3::new(0.9, 0.8, 0.7)),
        Material::glass(1.33),
        Material::diffuse(Vec3::splat(0.25)),
        Material::diffuse(Vec3::splat(0.5)),
        Material::emissive(Vec3::new(1.0, 2.0, 3.0)),
    ];
    assert_eq!(scene.materials, expected);
    assert_eq!(scene.warnings.len(), 1);
    assert!(scene.warnings[0].contains("`absent`"), "{:?}", scene.warnings);
}

#[test]
fn overrides_match_without_any_mtl() {
    let rule = json!({
        "red wall": {"type": "mirror", "reflectance": [1, 0.5, 0]},
        "plain": {"type": "null"}
    });
    let folder = SceneFolder::new().without("a.mtl").json(|scene| scene["materials"] = rule);
    let scene = loaded(&folder);
    assert_eq!(scene.triangle_count(), 1 + 2);
    assert_eq!(scene.materials, [Material::mirror(Vec3::new(1.0, 0.5, 0.0))]);
    assert!(
        scene.warnings.iter().any(|w| w.contains("a.obj") && w.contains("`a.mtl`")),
        "{:?}",
        scene.warnings
    );
}

#[test]
fn principled_materials_of_a_scene_file() {
    let of = |rule: serde_json::Value| {
        let folder = SceneFolder::new().json(|scene| scene["materials"] = json!({"plain": rule}));
        image::RgbImage::new(1, 1).save(folder.path("t.png")).unwrap();
        loaded(&folder)
    };
    let whole = of(json!({
        "type": "principled", "reflectance": [1, 0.5, 0.25], "metallic": 0.25, "roughness": 0.125,
        "transmission": 0.75, "ior": 1.25, "radiance": [1, 2, 3]
    }));
    let expected = Principled {
        metallic: 0.25,
        transmission: 0.75,
        ior: 1.25,
        emission: Vec3::new(1.0, 2.0, 3.0),
        ..Principled::paint(Vec3::new(1.0, 0.5, 0.25), 0.125)
    };
    assert!(whole.materials.contains(&Material::Principled(expected)), "{:?}", whole.materials);
    let plain = of(json!({"type": "principled", "reflectance": {"texture": "t.png"}}));
    // Faces without texture coordinates show the mean of the texture, which is black.
    let expected = Principled::paint(Vec3::ZERO, 0.5);
    assert!(plain.materials.contains(&Material::Principled(expected)), "{:?}", plain.materials);
}

#[test]
fn textures_of_json_and_mtl() {
    let folder = SceneFolder::new()
        .with("a.mtl", format!("{MTL}map_Kd -s 1 1 1 My Wall.PNG\nmap_Kd my wall.png"));
    image::RgbImage::from_pixel(2, 1, image::Rgb([255, 0, 0]))
        .save(folder.path("My Wall.png"))
        .unwrap();
    let scene = loaded(&folder);
    assert_eq!(scene.warnings, [""; 0]);
    assert_eq!(scene.materials[1], Material::textured(TextureId(0)));
    let texels = vec![[255, 0, 0, 255]; 2];
    assert_eq!(scene.textures, [Texture::new(2, 1, texels)]);
    let expected = vec![[Vec2::ZERO, Vec2::X, Vec2::Y]];
    assert_eq!(scene.meshes[1].texture_coordinates, Some(expected));
    assert_eq!(scene.meshes[1].normals, None);

    let missing = SceneFolder::new().with("a.mtl", format!("{MTL}map_Kd gone.png"));
    let scene = loaded(&missing);
    assert_eq!(scene.materials[1], Material::diffuse(Vec3::X));
    assert!(
        scene.warnings[0].contains("a.mtl") && scene.warnings[0].contains("gone.png"),
        "{:?}",
        scene.warnings
    );
}

#[test]
fn a_missing_normal_makes_its_face_flat_and_no_other() {
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 5\nvn 0 0 0\n\
               usemtl plain\nf 1//1 2//2 3//1\nusemtl red wall\nf 1//1 2//1 3//1\nf 1//1 2 3//1\n";
    let folder =
        SceneFolder::new().with("a.obj", obj).json(|scene| scene["normals"] = json!("smooth"));
    let scene = loaded(&folder);
    assert_eq!(scene.meshes[0].normals, Some(vec![[Vec3::Z, Vec3::ZERO, Vec3::Z]]));
    assert_eq!(scene.meshes[1].normals, Some(vec![[Vec3::Z; 3]]));
    assert_eq!((scene.meshes[2].normals.as_ref(), scene.meshes[2].triangles.len()), (None, 1));
    assert_eq!(scene.meshes[1].material, scene.meshes[2].material);
    assert!(scene.warnings[1].contains("flat: 1, the first in line 10"), "{:?}", scene.warnings);
    assert!(loaded(&folder.json(|_| ())).meshes.iter().all(|mesh| mesh.normals.is_none()));
}

#[test]
fn triangles_that_are_dropped_are_counted() {
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nv -0 1 0\nusemtl plain\n\
               f 1 2 3\nf 1 2 4\nf 1 1 3\nf 2 5 1\n";
    let folder = SceneFolder::new().with("a.obj", obj);
    let scene = loaded(&folder);
    assert_eq!(scene.triangle_count(), 2 + 2);
    assert!(
        scene.warnings.iter().any(|w| w.contains("2 triangles without area")),
        "{:?}",
        scene.warnings
    );
    let scene = loaded(&folder.json(|scene| scene["dedupe"] = json!(true)));
    assert_eq!(scene.triangle_count(), 1 + 2);
    assert!(
        scene.warnings.iter().any(|w| w.contains("1 triangles with the corners")),
        "{:?}",
        scene.warnings
    );
}

#[test]
fn quads_face_the_side_of_the_cross_product() {
    let scene = loaded(&SceneFolder::new());
    let at = |x: f32, y: f32| Vec3::new(x, y, 3.0);
    let light = QuadLight::new(at(0.0, 0.0), Vec3::X, Vec3::Y, Vec3::new(1.0, 2.0, 3.0));
    assert_eq!(scene.quad_lights, [light]);
    assert_eq!(
        light.triangles(),
        [[at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0)], [at(0.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)]]
    );
    for [a, b, c] in light.triangles() {
        assert_eq!((b - a).cross(c - a), Vec3::Z);
    }
}

#[test]
fn a_scene_without_light_is_warned_of() {
    let scene = loaded(&SceneFolder::new().json(|scene| scene["quads"] = json!([])));
    assert!(
        scene.warnings.iter().any(|w| w.contains("nothing emits light")),
        "{:?}",
        scene.warnings
    );
}

#[test]
fn about_may_be_anything_and_variables_are_expanded() {
    let folder = SceneFolder::new();
    let scene = loaded(&folder.json(|scene| {
        scene["about"] = json!({"anything": [1, {"x": null}]});
        scene["obj"] = json!("${CARGO_MANIFEST_DIR}/../scenes/Cornell_Ball/CORNELL_BALL.obj");
    }));
    assert_eq!(scene.triangle_count(), 6262 + 2);
}
