//! What good scenes become.

use glam::Vec3;
use raystream::scene::{FilmSize, PathLimits, Scene, embedded, load, load_named};
use raystream_shaders::scene::bsdf::MaterialKind;
use raystream_shaders::scene::texture::NO_TEXTURE;
use raystream_shaders::scene::triangle::NO_ATTRIBUTES;
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
    assert_eq!(scene.triangles.len(), 6262);
    assert_eq!(scene.film, FilmSize { width: 800, height: 600 });
    assert_eq!(scene.limits, PathLimits { max_depth: 8, roulette_depth: 5 });
    // white, green, red, light, ball: the order of the OBJ.
    assert_eq!(
        scene.materials.iter().map(|m| m.kind).collect::<Vec<_>>(),
        [
            MaterialKind::DIFFUSE,
            MaterialKind::DIFFUSE,
            MaterialKind::DIFFUSE,
            MaterialKind::DIFFUSE,
            MaterialKind::MIRROR
        ]
    );
    assert_eq!(scene.materials[0].reflectance, Vec3::new(0.725, 0.71, 0.68));
    assert_eq!(scene.materials[3].emission, Vec3::new(17.0, 12.0, 4.0));
    assert_eq!(scene.materials[3].reflectance, Vec3::ZERO);
    assert_eq!(scene.materials[4].reflectance, Vec3::splat(0.95));
    assert_eq!(scene.triangles.iter().filter(|t| t.material == 3).count(), 2);
    // Only the ball has vn; they point away from its middle, as its triangles do.
    let middle = Vec3::new(0.683_453_2, 0.215_827_3, 0.629_496_4);
    for triangle in &scene.triangles {
        assert_eq!(triangle.attributes != NO_ATTRIBUTES, triangle.material == 4);
        if triangle.material == 4 {
            let normal = scene.attributes[triangle.attributes as usize].normal0;
            assert!((normal.length() - 1.0).abs() < 1e-6);
            assert!(normal.dot((triangle.corner - middle).normalize()) > 0.99);
            assert!(triangle.normal().dot(normal) > 0.9);
        }
    }
}

#[test]
fn the_glass_ball_differs_by_its_material_only() {
    let (mirror, glass) = (embedded().unwrap(), load_named("cornell_glass").unwrap());
    assert_eq!(glass.triangles, mirror.triangles);
    assert_eq!(glass.materials[..4], mirror.materials[..4]);
    let ball = glass.materials[4];
    assert_eq!((ball.kind, ball.ior), (MaterialKind::DIELECTRIC, 1.5));
    assert_eq!((ball.reflectance, ball.transmittance), (Vec3::ONE, Vec3::ONE));
}

#[test]
fn the_shipped_files_are_what_is_built_in() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes");
    for name in ["cornell_ball", "cornell_glass", "opening", "caustics"] {
        let from_disk = load(&folder.join(name).join(name).with_extension("json")).unwrap();
        assert_eq!(from_disk.triangles, load_named(name).unwrap().triangles);
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
        assert_eq!(scene.triangles.len(), triangles, "{name}");
        let with_texture = |material: u32| scene.materials[material as usize].texture != NO_TEXTURE;
        assert_eq!(
            scene.triangles.iter().filter(|t| with_texture(t.material)).count(),
            textured,
            "{name}"
        );
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
    let m = &scene.materials;
    assert_eq!(
        (m[0].kind, m[0].emission, m[0].reflectance),
        (MaterialKind::DIFFUSE, Vec3::Y * 5.0, Vec3::new(0.1, 0.2, 0.3))
    );
    assert_eq!((m[1].kind, m[1].reflectance), (MaterialKind::MIRROR, Vec3::new(0.9, 0.8, 0.7)));
    assert_eq!(
        (m[2].kind, m[2].ior, m[2].transmittance),
        (MaterialKind::DIELECTRIC, 1.33, Vec3::ONE)
    );
    assert_eq!((m[3].kind, m[3].reflectance), (MaterialKind::DIFFUSE, Vec3::splat(0.25)));
    assert_eq!((m[4].kind, m[4].reflectance), (MaterialKind::DIFFUSE, Vec3::splat(0.5)));
    assert_eq!((m[5].emission, m[5].reflectance), (Vec3::new(1.0, 2.0, 3.0), Vec3::ZERO));
    assert_eq!(scene.warnings.len(), 1);
    assert!(scene.warnings[0].contains("`absent`"), "{:?}", scene.warnings);
}

#[test]
fn overrides_match_without_any_mtl() {
    let rule = json!({"red wall": {"type": "mirror", "reflectance": [1, 0.5, 0]}, "plain": {"type": "null"}});
    let folder = SceneFolder::new().without("a.mtl").json(|scene| scene["materials"] = rule);
    let scene = loaded(&folder);
    assert_eq!(scene.triangles.len(), 1 + 2);
    assert_eq!(
        (scene.materials[0].kind, scene.materials[0].reflectance),
        (MaterialKind::MIRROR, Vec3::new(1.0, 0.5, 0.0))
    );
    assert!(
        scene.warnings.iter().any(|w| w.contains("a.obj") && w.contains("`a.mtl`")),
        "{:?}",
        scene.warnings
    );
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
    let texture = scene.materials[1].texture as usize;
    assert_eq!(scene.texels[texture..], [2, 1, 0xff00_00ff, 0xff00_00ff]);
    let a = scene.attributes[scene.triangles[1].attributes as usize];
    assert_eq!([a.u0, a.v0, a.u1, a.v1, a.u2, a.v2], [0.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
    assert_eq!(a.normal0, Vec3::ZERO);

    let missing = SceneFolder::new().with("a.mtl", format!("{MTL}map_Kd gone.png"));
    let scene = loaded(&missing);
    assert_eq!((scene.materials[1].texture, scene.materials[1].reflectance), (NO_TEXTURE, Vec3::X));
    assert!(
        scene.warnings[0].contains("a.mtl") && scene.warnings[0].contains("gone.png"),
        "{:?}",
        scene.warnings
    );
}

#[test]
fn smooth_normals_need_one_at_every_corner_of_the_material() {
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 5\nvn 0 0 0\n\
               usemtl plain\nf 1//1 2//2 3//1\nusemtl red wall\nf 1//1 2//1 3//1\nf 1//1 2 3//1\n";
    let folder =
        SceneFolder::new().with("a.obj", obj).json(|scene| scene["normals"] = json!("smooth"));
    let scene = loaded(&folder);
    assert_eq!(scene.attributes.len(), 1);
    assert_eq!(scene.triangles[0].attributes, 0);
    assert_eq!([scene.attributes[0].normal0, scene.attributes[0].normal1], [Vec3::Z, Vec3::ZERO]);
    assert_eq!(loaded(&folder.json(|_| ())).attributes.len(), 0);
}

#[test]
fn triangles_that_are_dropped_are_counted() {
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nv -0 1 0\nusemtl plain\nf 1 2 3\nf 1 2 4\nf 1 1 3\nf 2 5 1\n";
    let folder = SceneFolder::new().with("a.obj", obj);
    let scene = loaded(&folder);
    assert_eq!(scene.triangles.len(), 2 + 2);
    assert!(
        scene.warnings.iter().any(|w| w.contains("2 triangles without area")),
        "{:?}",
        scene.warnings
    );
    let scene = loaded(&folder.json(|scene| scene["dedupe"] = json!(true)));
    assert_eq!(scene.triangles.len(), 1 + 2);
    assert!(
        scene.warnings.iter().any(|w| w.contains("1 triangles with the corners")),
        "{:?}",
        scene.warnings
    );
}

#[test]
fn quads_face_the_side_of_the_cross_product() {
    let scene = loaded(&SceneFolder::new());
    let quad = &scene.triangles[2..];
    assert_eq!(quad.iter().map(|t| t.normal()).collect::<Vec<_>>(), [Vec3::Z, Vec3::Z]);
    assert_eq!(
        [quad[0].corner + quad[0].edge1, quad[0].corner + quad[0].edge2],
        [Vec3::new(1.0, 0.0, 3.0), Vec3::new(1.0, 1.0, 3.0)]
    );
    assert_eq!(
        [quad[1].corner + quad[1].edge1, quad[1].corner + quad[1].edge2],
        [Vec3::new(1.0, 1.0, 3.0), Vec3::new(0.0, 1.0, 3.0)]
    );
    let material = scene.materials[quad[0].material as usize];
    assert_eq!((material.emission, material.reflectance), (Vec3::new(1.0, 2.0, 3.0), Vec3::ZERO));
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
    assert_eq!(scene.triangles.len(), 6262 + 2);
}
