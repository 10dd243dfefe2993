//! Faces, and what their corners have.

use super::{SQUARE, TEXTURED, assert_same, assert_warns, folder, loaded, scene};
use glam::{Vec3, Vec4};
use raystream::scene::{Material, Mesh};
use serde_json::json;

#[test]
fn colours_of_vertices_are_srgb_and_go_with_their_corners() {
    let obj = SQUARE.replace("v 2 0 0", "v 2 0 0 1 0 0.5").replace("usemtl plain\n", "");
    let scene = scene(&obj, "");
    let colours = scene.meshes[0].colours.as_ref().unwrap();
    let half = ((0.5_f32 + 0.055) / 1.055).powf(2.4);
    for (corners, triangle) in colours.iter().zip(0..) {
        for (colour, position) in corners.iter().zip(scene.meshes[0].corners(triangle)) {
            let is_red = position == Vec3::X * 2.0;
            let expected = if is_red { Vec4::new(1.0, 0.0, half, 1.0) } else { Vec4::ONE };
            assert!((*colour - expected).abs().max_element() < 1e-6, "{position} {colour}");
        }
    }
    assert_eq!(scene.materials, [Material::diffuse(Vec3::ONE)], "what no MTL describes is white");
    assert!(!format!("{:?}", scene.warnings).contains("olours"), "{:?}", scene.warnings);
    // A mirror has no colour that they could multiply.
    let obj = SQUARE.replace("v 2 0 0", "v 2 0 0 1 0 0.5");
    let mirror = super::scene(&obj, "newmtl plain\nillum 3\nKs 1 1 1\n");
    assert_eq!(mirror.meshes[0].colours, None);
    assert_warns(&mirror, &["a.obj", "no effect", "`colours of vertices` of `plain`"]);
}

#[test]
fn faces_without_texture_coordinates_show_the_mean_of_the_texture() {
    let mean = Material::diffuse(Vec3::new(0.5, 0.0, 0.5));
    let is_textured = |material: &Material| material.textures().next().is_some();
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
