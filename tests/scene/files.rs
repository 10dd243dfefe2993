//! Files as other programs write them become the scene that they mean.

use glam::{Vec2, Vec3};
use raystream::scene::{Material, Mesh, Scene};
use raystream_tests::scene_folder::{MTL, OBJ, SceneFolder};
use serde_json::json;
use std::path::Path;

/// A square of the material `plain`, with texture coordinates.
const SQUARE: &str = "mtllib a.mtl\nv 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\n\
    vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl plain\nf 1/1 2/2 3/3 4/4\n";
const TEXTURED: &str = "newmtl plain\nKd 0 1 0\nmap_Kd t.png\n";

fn loaded(folder: &SceneFolder) -> Scene {
    folder.load().unwrap_or_else(|error| panic!("{error}"))
}

/// The scene of an OBJ and an MTL, with a picture of red beside blue called `t.png`.
fn scene(obj: impl AsRef<[u8]>, mtl: impl AsRef<[u8]>) -> Scene {
    loaded(&folder(obj, mtl))
}

fn folder(obj: impl AsRef<[u8]>, mtl: impl AsRef<[u8]>) -> SceneFolder {
    let folder = SceneFolder::new().with("a.obj", obj).with("a.mtl", mtl);
    picture(&folder.path("t.png"));
    folder
}

/// Red beside blue.
fn picture(path: &Path) {
    image::RgbImage::from_raw(2, 1, vec![255, 0, 0, 0, 0, 255]).unwrap().save(path).unwrap();
}

/// The scenes show the same.
#[track_caller]
fn assert_same(scene: &Scene, right: &Scene) {
    assert_eq!(scene.meshes, right.meshes);
    assert_eq!(scene.materials, right.materials);
    assert_eq!(scene.textures, right.textures);
}

#[track_caller]
fn assert_warns(scene: &Scene, parts: &[&str]) {
    let found =
        scene.warnings.iter().any(|warning| parts.iter().all(|part| warning.contains(part)));
    assert!(found, "{:?} say not {parts:?}", scene.warnings);
}

#[test]
fn byte_order_marks_are_no_part_of_a_file() {
    let right = loaded(&SceneFolder::new());
    let marked = |text: &str| format!("\u{feff}{text}");
    let json = std::fs::read_to_string(SceneFolder::new().path("scene.json")).unwrap();
    assert_eq!(loaded(&SceneFolder::new().with("a.obj", marked(OBJ))), right);
    assert_eq!(loaded(&SceneFolder::new().with("a.mtl", marked(MTL))), right);
    assert_eq!(loaded(&SceneFolder::new().with("scene.json", marked(&json))), right);
    let first_vertex = OBJ.replace("mtllib a.mtl\n", "") + "mtllib a.mtl\n";
    assert_eq!(loaded(&SceneFolder::new().with("a.obj", marked(&first_vertex))), right);
}

#[test]
fn lines_end_and_go_on_in_any_way() {
    let right = loaded(&SceneFolder::new());
    for end in ["\r\n", "\r", "\r\r\n", " \t\n"] {
        let written = |text: &str| text.replace('\n', end);
        let scene = SceneFolder::new().with("a.obj", written(OBJ)).with("a.mtl", written(MTL));
        assert_eq!(loaded(&scene), right, "{end:?}");
    }
    for end in ["\n", "\r\n", "\r", " \t\n"] {
        // The name `red wall` is broken too, at the same place in both files.
        let going_on = |text: &str| text.replace(' ', &format!(" \\{end}"));
        let scene = SceneFolder::new().with("a.obj", going_on(OBJ)).with("a.mtl", going_on(MTL));
        assert_same(&loaded(&scene), &right);
    }
}

#[test]
fn names_of_any_encoding_stay_apart() {
    // Two names in GBK, two in Latin-1, one in Shift-JIS that ends in the byte of `\`.
    let names: [&[u8]; 5] =
        [b"\xba\xec\xc6\xa1", b"\xc0\xb6\xc6\xa1", b"T\xfcr", b"T\xf6r", b"\x95\\"];
    let obj: Vec<u8> = names
        .iter()
        .flat_map(|name| [b"usemtl ".as_slice(), name, b"\nf 1 2 3\n"].concat())
        .collect();
    let mtl: Vec<u8> = names
        .iter()
        .enumerate()
        .flat_map(|(at, name)| [b"newmtl ", *name, format!("\nKd 0 0 .{at}\n").as_bytes()].concat())
        .collect();
    let obj = [b"mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n".as_slice(), &obj].concat();
    let scene = scene(&obj, &mtl);
    let expected = [0.0, 0.1, 0.2, 0.3, 0.4].map(|blue| Material::diffuse(Vec3::Z * blue));
    assert_eq!(scene.materials, expected);
    assert_eq!(scene.warnings, [""; 0]);
    // A scene file calls such a name as messages do.
    let mirror = json!({"T\\xFCr": {"type": "mirror", "reflectance": [1, 1, 1]}});
    let overridden = loaded(&folder(obj, mtl).json(|scene| scene["materials"] = mirror));
    assert_eq!(overridden.materials[2], Material::mirror(Vec3::ONE));
    assert_eq!(overridden.materials[3], expected[3]);
}

#[test]
fn number_signs_may_be_in_names() {
    let obj = SQUARE.replace("plain", "Material #25");
    let mtl = "newmtl Material #26\nKd 1 0 0\nnewmtl Material #25\nKd 0 0 1\nmap_Kd a#b.png\n";
    let folder = folder(&obj, mtl);
    picture(&folder.path("a#b.png"));
    assert_same(&loaded(&folder), &scene(SQUARE, TEXTURED));
    let commented = TEXTURED.replace("t.png", "t.png # the wall").replace("plain", "plain # x");
    assert_same(&scene(SQUARE, commented), &scene(SQUARE, TEXTURED));
}

#[test]
fn mtllib_may_name_several_files_of_which_the_first_counts() {
    let right = loaded(&SceneFolder::new());
    let with = |statement: &str| {
        let other = "newmtl other\nKd 0 1 0\n";
        let later = MTL.replace("Kd", "Kd 0 0 0\nKd_old");
        let folder = SceneFolder::new()
            .with("a.obj", OBJ.replace("mtllib a.mtl", statement))
            .with("other.mtl", other)
            .with("later.mtl", later)
            .with("my a.mtl", MTL);
        loaded(&folder)
    };
    for statement in [
        "mtllib other.mtl a.mtl",
        "mtllib other.mtl\ta.mtl later.mtl",
        "mtllib a.mtl\nmtllib later.mtl",
        "mtllib \"a.mtl\"",
        "mtllib a.mtl # all of them",
        "mtllib my a.mtl",
        "mtllib \"my a.mtl\" other.mtl",
        "mtllib C:\\models\\a.mtl",
        "mtllib C:\\my models\\a.mtl",
    ] {
        assert_same(&with(statement), &right);
    }
    assert_warns(&with("mtllib a.mtl later.mtl"), &["later.mtl", "defined again", "`red wall`"]);
    assert_warns(&with("mtllib a.mtl gone.mtl"), &["a.obj", "`gone.mtl`", "not there"]);
    assert_warns(&with("mtllib C:\\models\\a.mtl"), &["a.obj", "leads nowhere", "a.mtl is used"]);
}

#[test]
fn paths_of_another_machine_lead_to_the_picture_beside() {
    let right = scene(SQUARE, TEXTURED);
    let with = |path: &str| scene(SQUARE, TEXTURED.replace("t.png", path));
    for path in
        ["C:\\scene\\maps\\t.png", "/srv/maps/t.png", "\\\\host\\share\\T.PNG", "../x/t.png"]
    {
        assert_same(&with(path), &right);
        assert_warns(&with(path), &["a.mtl", "lead nowhere", path, "`plain`"]);
    }
    assert_eq!(with("\"t.png\"").warnings, [""; 0]);
    assert_same(&with("\"t.png\""), &right);
    assert_same(&with("-s 1 1 1 \"C:\\my maps\\t.png\""), &right);
}

#[test]
fn options_of_a_texture_move_it() {
    let with = |options: &str| scene(SQUARE, TEXTURED.replace("t.png", options));
    let mapped = |change: fn(Vec2) -> Vec2| {
        let mut right = scene(SQUARE, TEXTURED);
        for corner in right.meshes[0].texture_coordinates.iter_mut().flatten().flatten() {
            *corner = change(*corner);
        }
        right
    };
    assert_same(&with("-s 4 2 1 t.png"), &mapped(|uv| uv * Vec2::new(4.0, 2.0)));
    assert_same(&with("-o 0.5 0.25 0 t.png"), &mapped(|uv| uv + Vec2::new(0.5, 0.25)));
    assert_same(&with("-o 0.5 -s 2 t.png"), &mapped(|uv| uv * Vec2::new(2.0, 1.0) + Vec2::X / 2.0));
    assert_eq!(with("-s 4 2 1 -clamp off t.png").warnings, [""; 0]);
    let clamped = with("-clamp on -mm 0.1 0.5 t.png");
    assert_warns(&clamped, &["a.mtl", "no effect", "`map_Kd -clamp`", "`map_Kd -mm`"]);
}

#[test]
fn pictures_that_cannot_be_read_are_as_those_that_are_not_there() {
    let gone = scene(SQUARE, TEXTURED.replace("t.png", "gone.png"));
    assert_eq!(gone.materials, [Material::diffuse(Vec3::Y)]);
    assert_warns(&gone, &["a.mtl", "not there", "`gone.png` of `plain`"]);
    let contents: [&[u8]; 4] =
        [b"GIF89a\x01\0\x01\0", b"RIFF\x04\0\0\0WEBPVP8 ", b"", b"\x89PNG\r\n\x1a\n"];
    for content in contents {
        let unreadable = loaded(&folder(SQUARE, TEXTURED).with("t.png", content));
        assert_same(&unreadable, &gone);
        assert_warns(&unreadable, &["a.mtl", "cannot be read", "t.png", "`plain`"]);
    }
}

#[test]
fn faces_without_texture_coordinates_show_the_mean_of_the_texture() {
    let mean = Material::diffuse(Vec3::new(0.5, 0.0, 0.5));
    let is_textured = |material: &Material| material.texture().is_some();
    let mixed = scene(SQUARE.to_owned() + "f 1 2 3\nf 1/1 2/2 3\nf 1/9 2/0 3/3\n", TEXTURED);
    assert!(is_textured(&mixed.materials[0]) && mixed.materials[1] == mean);
    let counts: Vec<_> = mixed.meshes.iter().map(|mesh| mesh.triangles.len()).collect();
    assert_eq!(counts, [2, 3]);
    assert_warns(&mixed, &["a.obj", "mean of their texture", "`3 faces` of `plain`"]);
    assert_warns(&mixed, &["a.obj", "not there: 1, the first in line 14"]);
    let without = SQUARE.replace("vt", "# vt");
    assert_eq!(scene(&without, TEXTURED).materials, [mean]);
    let rule = json!({"type": "diffuse", "reflectance": {"texture": "t.png"}});
    assert_eq!(loaded(&folder(&without, "").plain(rule)).materials, [mean]);
    // Nobody looks at them without a texture.
    let plain = "newmtl plain\nKd 0 1 0\n";
    assert_same(&scene(&without, plain), &scene(SQUARE, plain));
    assert_warns(&scene(&without, plain), &["a.obj", "texture coordinates", "line 11"]);
}

#[test]
fn a_texture_coordinate_may_be_one_number_and_far_from_zero() {
    let one = SQUARE.replace("vt 1 0\n", "vt 1\n").replace("vt 0 0\n", "vt 0\n");
    assert_same(&scene(one, TEXTURED), &scene(SQUARE, TEXTURED));
    let far = SQUARE
        .replace("vt 0 0", "vt 8388608 -1048576")
        .replace("vt 1 0", "vt 8388609 -1048576")
        .replace("vt 1 1", "vt 8388609 -1048575")
        .replace("vt 0 1", "vt 8388608 -1048575");
    assert_same(&scene(far, TEXTURED), &scene(SQUARE, TEXTURED));
}

#[test]
fn what_nothing_uses_may_be_anything() {
    let plain = "newmtl plain\nKd 0 1 0\nNs nan\n";
    let right = scene(SQUARE, plain);
    for unused in ["v nan inf -nan", "v 1 2", "v -1.#IND 0 0", "v x y z"] {
        let scene = scene(format!("{SQUARE}{unused}\n"), plain);
        assert_same(&scene, &right);
        assert_warns(&scene, &["a.obj", "nothing uses: 1, the first is line 12"]);
    }
    assert_same(&scene(SQUARE.replace("vt 1 1", "vt nan 1.#INF"), plain), &right);
    let flat = SQUARE.replace("vt 0 0\n", "vt 0 0\nvn nan 0 0\nvn 0 0\n");
    for corner in ["1/1/1", "1/1/0", "1/1/7", "1/1/-9"] {
        assert_same(&scene(flat.replace("1/1 ", &format!("{corner} ")), plain), &right);
    }
    let null = json!({"type": "null"});
    let hole = folder(format!("{SQUARE}v nan 0 0\nf 1 2 -1\nusemtl b\nf 1 2 3\n"), plain);
    assert_eq!(loaded(&hole.plain(null)).triangle_count(), 1 + 2);
}

#[test]
fn normals_that_are_not_there_make_a_face_flat() {
    let smooth = |faces: &str| {
        let obj = format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nusemtl plain\n{faces}");
        loaded(&folder(obj, "").json(|scene| scene["normals"] = json!("smooth")))
    };
    for index in ["0", "2", "-2"] {
        let scene = smooth(&format!("f 1//1 2//1 3//1\nf 1//{index} 2//1 3//1\n"));
        let normals: Vec<_> = scene.meshes.iter().map(|mesh| mesh.normals.clone()).collect();
        assert_eq!(normals, [Some(vec![[Vec3::Z; 3]]), None]);
        assert_warns(&scene, &["a.obj", "(vn)", "flat: 1, the first in line 7"]);
    }
    assert_warns(&smooth("f 1//4 2//4 3//4\n"), &["a.obj", "flat: 1, the first in line 6"]);
}

#[test]
fn values_that_are_rounded_or_empty_are_no_errors() {
    let with = |mtl: &str| scene(SQUARE, format!("newmtl plain\n{mtl}"));
    let right = with("Kd 1 0.1 0\n");
    assert_same(&with("Kd 1.000001 0.1 -1e-9\n"), &right);
    assert_same(&with("Kd 1 .1 0\nillum\nKe\nNi \nmap_Kd\nTr\nd\n"), &right);
    assert_same(&with("Kd 1 .1 0\nKe -1e-9 0 0\n"), &right);
    assert_same(&with("Kd\n"), &with(""));
    let lamp = with("Ke 2 1 -0.000001\nKd 1.0001 0 0\n");
    let (radiance, reflectance) = (Vec3::new(2.0, 1.0, 0.0), Vec3::X);
    assert_eq!(lamp.materials, [Material::Emissive { radiance, reflectance }]);
    assert_warns(&with("Kd spectral blue.rfl 1\n"), &["no effect", "`Kd` of `plain`"]);
}

#[test]
fn the_number_of_illum_alone_makes_no_glass_of_paint() {
    let of = |mtl: &str| scene(SQUARE, format!("newmtl plain\nKd .8 .1 .1\n{mtl}")).materials[0];
    let paint = Material::diffuse(Vec3::new(0.8, 0.1, 0.1));
    for illum in [4, 6, 7, 9] {
        for rest in [
            "",
            "Ni 1\n",
            "d 1\n",
            "Tr 0\nNi 1.0000\n",
            "Ni 1\nTf 1 1 1\nd 1\n",
            "Tr 1\n",
            "Ni 1.5\nTf 0 0 0\n",
        ] {
            assert_eq!(of(&format!("illum {illum}\n{rest}")), paint, "{illum} {rest}");
        }
        let painted = of(&format!("illum {illum}\nNi 1.5\nd 1\nmap_Kd t.png\n"));
        assert!(painted.texture().is_some(), "{painted:?}");
        assert_eq!(of(&format!("illum {illum}\nNi 1.33\n")), Material::glass(1.33));
        assert_eq!(of(&format!("illum {illum}\nd 0.2\n")), Material::glass(1.5));
        assert_eq!(of(&format!("illum {illum}\nTr 0.8\nNi 1\n")), Material::glass(1.0));
        assert_eq!(of(&format!("illum {illum}\nTf .1 .6 .1\nNi 1.5\n")), Material::glass(1.5));
    }
    for illum in [3, 5] {
        assert_eq!(of(&format!("illum {illum}\n")), paint);
        assert_eq!(of(&format!("illum {illum}\nKs 0 0 0\n")), paint);
        assert_eq!(of(&format!("illum {illum}\nKs .9\n")), Material::mirror(Vec3::splat(0.9)));
    }
}

#[test]
fn what_is_left_out_is_said() {
    let with = |mtl: &str| scene(SQUARE, format!("newmtl plain\nKd .8 .1 .1\n{mtl}"));
    for (mtl, parts) in [
        ("d 0\n", ["opaque", "`d` of `plain`"]),
        ("Tr 1\n", ["opaque", "`Tr` of `plain`"]),
        ("d 1\nTr 1\n", ["no effect", "`Tr` of `plain`"]),
        ("map_d mask.png\n", ["opaque", "`map_d` of `plain`"]),
        ("map_Ke glow.png\n", ["emission", "`map_Ke` of `plain`"]),
        ("illum 4\nNi 1.5\nTf .1 .6 .1\n", ["filter", "`Tf` of `plain`"]),
        ("Ks .9 .9 .9\nNs 200\n", ["no effect", "`Ks` of `plain`; `Ns` of `plain`"]),
        ("map_Bump b.png\nnorm n.png\n", ["no effect", "`map_Bump` of `plain`; `norm` of `plain`"]),
        ("Pr 0.3\nPm 1\n", ["no effect", "`Pm` of `plain`; `Pr` of `plain`"]),
        ("Ke 1 1 1\nmap_Kd t.png\n", ["no effect", "`map_Kd` of `plain`"]),
    ] {
        let scene = with(mtl);
        assert_warns(&scene, &[&["a.mtl"], parts.as_slice()].concat());
        assert!(scene.details.iter().any(|detail| detail.contains("a.mtl, line ")), "{scene:?}");
    }
    let nothing =
        "Ka 1 1 1\nKs 0 0 0\nNs 200\nd 1\nTr 0\nNi 1.5\nTf 1 1 1\nPm 0\nillum 2\nKe 0 0 0\n";
    assert_eq!(with(nothing).warnings, [""; 0]);
    let folder = folder(SQUARE, TEXTURED);
    image::RgbaImage::from_pixel(1, 1, image::Rgba([1, 1, 1, 0]))
        .save(folder.path("t.png"))
        .unwrap();
    assert_warns(&loaded(&folder), &["a.mtl", "opaque", "alpha of", "t.png", "`plain`"]);
    let obj =
        SQUARE.replace("v 2 0 0", "v 2 0 0 1 0 0") + "l 1 2\np 1\nfrob 1\ncurv 0 1 1 2\nfo 1 2 3\n";
    let scene = scene(obj, MTL);
    assert_warns(&scene, &["a.obj", "colours of vertices", "line 3"]);
    assert_warns(
        &scene,
        &["a.obj", "not read", "`curv`", "`frob` (1, the first is line 14)", "`l`", "`p`"],
    );
    assert_eq!(scene.triangle_count(), 3 + 2, "fo is an old name of f");
}

/// The area that a mesh covers, as a vector along z if all of it faces there.
fn area(mesh: &Mesh) -> f32 {
    let of = |triangle| {
        let [a, b, c] = mesh.corners(triangle);
        (b - a).cross(c - a).z / 2.0
    };
    (0..mesh.triangles.len()).map(of).inspect(|&area| assert!(area > 0.0)).sum()
}

#[test]
fn polygons_that_are_not_convex_are_filled_within_their_outline() {
    let corners = [(0, 0), (4, 0), (4, 4), (3, 4), (3, 1), (1, 1), (1, 4), (0, 4)];
    let vertices: String =
        corners.iter().map(|(x, y)| format!("v {x} {y} 0\nvt {x} {y}\n")).collect();
    for first in 0..corners.len() {
        let indices: Vec<_> =
            (0..corners.len()).map(|at| (first + at) % corners.len() + 1).collect();
        let face: String = indices.iter().map(|index| format!(" {index}/{index}")).collect();
        let obj = format!("mtllib a.mtl\n{vertices}usemtl plain\nf{face}\n");
        let scene = scene(obj, TEXTURED);
        let mesh = &scene.meshes[0];
        assert_eq!(area(mesh), 10.0, "from corner {first}");
        // Texture coordinates go with their corners, but for whole numbers.
        for (triangle, uvs) in mesh.texture_coordinates.iter().flatten().enumerate() {
            let offsets = mesh.corners(triangle).map(Vec3::truncate);
            assert_eq!(uvs[1] - uvs[0], offsets[1] - offsets[0]);
            assert_eq!(uvs[2] - uvs[0], offsets[2] - offsets[0]);
        }
    }
}

#[test]
fn a_scene_far_from_the_origin_is_that_near_it() {
    let at = |[x, y, z]: [f64; 3]| {
        let vertex = |dx: f64, dy: f64| format!("v {} {} {z}\n", x + dx, y + dy);
        let vertices =
            [vertex(0.125, 0.), vertex(2., 0.), vertex(2., 2.25), vertex(0., 2.)].concat();
        let place = |dx: f64, dy: f64, dz: f64| json!([x + dx, y + dy, z + dz]);
        let folder = folder(format!("{vertices}f 1 2 3 4\n"), "").json(|scene| {
            scene["camera"]["origin"] = place(0.5, 0.25, 5.0);
            scene["camera"]["target"] = place(0.5, 0.25, 0.0);
            scene["quads"][0]["corner"] = place(0.0, 0.0, 3.0);
        });
        loaded(&folder)
    };
    let home = at([0.0; 3]);
    assert!(!home.warnings.iter().any(|warning| warning.contains("far from the origin")));
    // Metres in UTM, the same in millimetres, and from the middle of the earth.
    for place in
        [[448_250., 95., 5_411_780.], [448_250_000., 95_000., 5_411_780_000.], [-4.2e6, 7e5, 4.7e6]]
    {
        let far = at(place);
        assert_warns(&far, &["scene.json", "far from the origin", "count from ("]);
        let shift = far.meshes[0].positions[0] - home.meshes[0].positions[0];
        for (a, b) in far.meshes[0].positions.iter().zip(&home.meshes[0].positions) {
            assert_eq!(*a - shift, *b);
        }
        assert_eq!(far.camera.origin - shift, home.camera.origin);
        assert_eq!(far.camera.target - shift, home.camera.target);
        assert_eq!(far.quad_lights[0].corner - shift.as_dvec3(), home.quad_lights[0].corner);
        assert!(shift.abs().max_element() < 100.0, "{shift}");
    }
}

#[test]
fn a_scene_may_be_read_from_a_stream() {
    let folder = SceneFolder::new();
    let text = std::fs::read_to_string(folder.path("scene.json")).unwrap();
    let absolute =
        text.replace("a.obj", &folder.path("a.obj").to_string_lossy().replace('\\', "/"));
    let read =
        |text: &str| raystream::scene::LoadOptions::default().read(&mut text.as_bytes(), "<input>");
    assert_eq!(read(&absolute).unwrap(), loaded(&folder));
    let error = read(&text.replace("a.obj", "gone.obj")).unwrap_err().to_string();
    assert!(error.contains("<input>: key `obj`: no such file: gone.obj"), "{error}");
}
