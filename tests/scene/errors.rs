//! What bad scenes get: a message that names the file and the place in it.

use raystream_tests::scene_folder::{MTL, OBJ, SceneFolder};
use serde_json::{Value, json};

/// Loading gives an error that says all of `parts`.
#[track_caller]
pub(super) fn expect(folder: SceneFolder, parts: &[&str]) {
    let message = folder.error();
    for part in parts {
        assert!(message.contains(part), "{message:?} does not say {part:?}");
    }
    assert!(!message.contains('\n'), "{message:?} has several lines");
}

/// The scene file with `value` at the JSON pointer `at` gives an error that says all of `parts`.
#[track_caller]
fn expect_value(at: &str, value: Value, parts: &[&str]) {
    let folder = SceneFolder::new().json(|scene| {
        let (parent, key) = at.rsplit_once('/').unwrap();
        scene.pointer_mut(parent).unwrap()[key] = value;
    });
    expect(folder, &[&["scene.json"], parts].concat());
}

/// The OBJ `text` gives an error that says all of `parts`.
#[track_caller]
fn expect_obj(text: &str, parts: &[&str]) {
    expect(SceneFolder::new().with("a.obj", text), &[&["a.obj"], parts].concat());
}

#[test]
fn the_unchanged_scene_loads() {
    let scene = SceneFolder::new().load().unwrap();
    assert_eq!(scene.triangle_count(), 4);
    assert_eq!(scene.warnings, [""; 0]);
}

#[test]
fn files_that_are_not_there() {
    expect(SceneFolder::new().without("scene.json"), &["scene.json", "cannot be read"]);
    expect(
        SceneFolder::new().without("a.obj"),
        &["scene.json", "key `obj`", "no such file", "a.obj"],
    );
    expect_value("/obj", json!("b.obj"), &["key `obj`", "b.obj"]);
    expect_value("/obj", json!("."), &["key `obj`", "is a folder", "name a file in it"]);
    expect_value("/obj", json!(""), &["key `obj`", "no such file"]);
    let in_a_file = SceneFolder::new().path("scene.json").join("x.json");
    assert!(raystream::scene::load(&in_a_file).unwrap_err().to_string().contains("x.json"));
}

#[test]
fn variables_that_are_not_set() {
    let name = "RAYSTREAM_TEST_NEVER_SET";
    expect_value(
        "/obj",
        json!(format!("${name}/a.obj")),
        &["key `obj`", name, "is not set", "export"],
    );
}

#[test]
fn text_that_is_not_json() {
    let expect_text =
        |text: &str, parts: &[&str]| expect(SceneFolder::new().with("scene.json", text), parts);
    expect_text("{\n \"format\": 1,\n oops}", &["scene.json", "line 3 column 2"]);
    expect_text("", &["scene.json", "is empty", "JSON"]);
    expect_text("{\"format\": 1,}", &["scene.json: trailing comma", "line 1"]);
    expect_text("{\"format\": 1, \"film\": {\"width\": 8,}}", &["trailing comma", "line 1"]);
    expect_text("[1]", &["scene.json", "line 1"]);
    let whole = std::fs::read_to_string(SceneFolder::new().path("scene.json")).unwrap();
    expect_text(&format!("{whole} x"), &["trailing characters"]);
    expect_text(
        &whole.replace("\"fov_y\": 40", "\"fov_y\": 1e999"),
        &["number out of range", "line"],
    );
    expect_text(&whole.replace("\"fov_y\": 40", "\"fov_y\": NaN"), &["expected", "line"]);
    expect_text(
        &whole.replace("\"fov_y\": 40", "\"fov_y\": 40, \"fov_y\": 41"),
        &["duplicate field `fov_y`"],
    );
}

#[test]
fn formats() {
    expect_value("/format", json!(3), &["key `format`", "not 3"]);
    expect_value("/format", json!("1"), &["key `format`", "invalid type", "line"]);
    expect(
        SceneFolder::new().json(|scene| drop(scene.as_object_mut().unwrap().remove("format"))),
        &["missing field `format`"],
    );
}

#[test]
fn keys_that_are_unknown_or_missing() {
    expect_value("/colour", json!(1), &["colour", "unknown field", "line"]);
    expect_value("/film/depth", json!(1), &["film.depth", "unknown field"]);
    expect_value("/camera/fov", json!(1), &["camera.fov", "unknown field"]);
    expect_value("/quads/0/w", json!(1), &["quads[0].w", "unknown field"]);
    expect_value("/integrator", json!({"depth": 1}), &["integrator.depth", "unknown field"]);
    for key in ["name", "obj", "film", "camera"] {
        let folder =
            SceneFolder::new().json(|scene| drop(scene.as_object_mut().unwrap().remove(key)));
        expect(folder, &["scene.json", &format!("missing field `{key}`")]);
    }
}

#[test]
fn values_of_the_wrong_type() {
    expect_value("/name", json!(5), &["key `name`", "invalid type"]);
    expect_value("/obj", Value::Null, &["key `obj`", "invalid type"]);
    expect_value("/film", json!([8, 6]), &["key `film`", "expected an object"]);
    expect_value(
        "/quads",
        json!([[[0, 0, 3], [1, 0, 0], [0, 1, 0], [1, 2, 3]]]),
        &["quads[0]", "expected an object"],
    );
    expect_value(
        "/materials",
        json!({"plain": ["null"]}),
        &["materials.plain", "expected an object"],
    );
    let width = ["film.width", "invalid type", "an integer from 1 to 16384"];
    expect_value("/film/width", json!(8.5), &width);
    expect_value("/film/width", json!(u64::MAX), &["film.width", "an integer from 1 to 16384"]);
    expect_value("/camera/fov_y", json!("40"), &["camera.fov_y", "expected a number"]);
    expect_value("/format", json!(-1), &["key `format`", "the number of a format"]);
    expect_value("/camera/origin", json!([0, 0]), &["camera.origin", "three numbers", "has 2"]);
    expect_value(
        "/camera/origin",
        json!([0, 0, 0, 0]),
        &["camera.origin", "three numbers", "has 4"],
    );
    expect_value("/camera/up", json!([0, "NaN", 0]), &["camera.up[1]", "invalid type"]);
    expect_value("/normals", json!("round"), &["normals", "`flat`", "`smooth`"]);
    expect_value("/dedupe", json!(1), &["dedupe", "invalid type"]);
    expect_value("/materials", json!([]), &["materials", "invalid type"]);
    expect_value("/quads", json!({}), &["quads", "invalid type"]);
}

#[test]
fn film_sizes() {
    for size in [json!(0), json!(-5), json!(16_385), json!(i64::MAX)] {
        expect_value(
            "/film/width",
            size.clone(),
            &["film.width", "from 1 to 16384 pixels", "line"],
        );
        expect_value("/film/height", size, &["film.height", "from 1 to 16384 pixels"]);
    }
    expect_value("/film/height", json!(u64::MAX), &["film.height"]);
}

#[test]
fn cameras() {
    for angle in
        [json!(0), json!(180), json!(-10), json!(400), json!(179.999_999_999), json!(1e-50)]
    {
        expect_value("/camera/fov_y", angle, &["camera.fov_y", "below 180"]);
    }
    expect_value(
        "/camera/target",
        json!([0, 0, 5]),
        &["key `camera`", "origin and target are the same"],
    );
    expect_value(
        "/camera/target",
        json!([0, 0, 5.000_000_000_1]),
        &["key `camera`", "origin and target are the same"],
    );
    expect_value(
        "/camera/up",
        json!([0, 0, -3]),
        &["key `camera`", "up is zero or along the view"],
    );
    expect_value("/camera/up", json!([0, 0, 0]), &["key `camera`", "up is zero or along the view"]);
    expect_value("/camera/origin", json!([1e10, 0, 0]), &["key `camera`", "origin", "1000000000"]);
    expect_value("/camera/origin", json!([0, 1e13, 0]), &["camera.origin", "1000000000000"]);
    expect_value("/quads/0/corner", json!([0, 1e10, 0]), &["quads[0].corner", "1000000000"]);
}

#[test]
fn path_limits() {
    expect_value("/integrator", json!({"max_depth": 0}), &["integrator.max_depth", "from 1"]);
    expect_value("/integrator", json!({"rr_depth": -1}), &["integrator.rr_depth", "from 1"]);
}

#[test]
fn quads() {
    expect_value("/quads/0/v", json!([-2, 0, 0]), &["quads[0]", "no area"]);
    expect_value("/quads/0/u", json!([0, 0, 0]), &["quads[0]", "no area"]);
    expect_value("/quads/0/u", json!([1e-60, 0, 0]), &["quads[0]", "no area"]);
    expect_value("/quads/0/radiance", json!([1, -1, 0]), &["quads[0].radiance", "has -1"]);
    expect_value("/quads/0/radiance", json!([1, 1e30, 0]), &["quads[0].radiance"]);
}

/// What is said of a rule for a material.
fn expect_rule(rule: Value, parts: &[&str]) {
    expect(SceneFolder::new().plain(rule), &[&["scene.json", "materials.plain"], parts].concat());
}

#[test]
fn bodies() {
    let glass = |key: &str, value: Value| json!({"type": "dielectric", "ior": 1.5, key: value});
    expect_rule(glass("priority", json!(1001)), &["must be from -1000 to 1000, is 1001"]);
    expect_rule(glass("priority", json!(0.5)), &["priority"]);
    expect_rule(glass("attenuation", json!([1, 1, 1])), &["need each other"]);
    expect_rule(glass("coat", json!(1)), &["a dielectric material has no key `coat`"]);
    let grey = json!([0.5, 0.5, 0.5]);
    let matt = json!({"type": "diffuse", "reflectance": grey, "priority": 1});
    expect_rule(matt, &["a diffuse material has no key `priority`"]);
    for (key, value) in
        [("transmission", json!(0)), ("thin_walled", json!(true)), ("alpha", json!(0.5))]
    {
        let mut rule = json!({
            "type": "principled", "reflectance": grey, "transmission": 1, "priority": 1,
        });
        rule[key] = value;
        expect_rule(rule, &["`priority` is that of a body", "`transmission`"]);
    }
}

#[test]
fn conductors() {
    let rule = |keys: Value| {
        let mut rule = json!({"type": "conductor"});
        rule.as_object_mut().unwrap().extend(keys.as_object().unwrap().clone());
        rule
    };
    expect_rule(rule(json!({})), &["needs the key `metal`, or `eta` and `k`"]);
    expect_rule(rule(json!({"eta": [1, 1, 1]})), &["needs the key `metal`, or `eta` and `k`"]);
    expect_rule(rule(json!({"metal": "gold", "k": [1, 1, 1]})), &["needs the key `metal`"]);
    expect_rule(rule(json!({"metal": "tin"})), &["no 'tin'", "silver, gold, copper"]);
    let numbers = |eta: f64, k: f64| json!({"eta": [1, eta, 1], "k": [1, k, 1]});
    expect_rule(rule(numbers(0.0, 1.0)), &["must be from 0.001", "has 0"]);
    expect_rule(rule(numbers(1.0, -1.0)), &["must be from 0 to 100, has -1"]);
    expect_rule(rule(json!({"metal": "gold", "coat": 1})), &["a conductor", "no key `coat`"]);
    let paint = json!({"type": "principled", "reflectance": [1, 1, 1], "metal": "gold"});
    expect_rule(paint, &["a principled material has no key `metal`"]);
}

#[test]
fn principled_materials() {
    expect_rule(json!({"type": "principled"}), &["needs the key `reflectance`"]);
    let grey = json!([0.5, 0.5, 0.5]);
    let principled =
        |key: &str, value: Value| json!({"type": "principled", "reflectance": grey, key: value});
    expect_rule(principled("roughness", json!(1.5)), &["must be from 0 to 1, is 1.5"]);
    expect_rule(principled("metallic", json!(-1)), &["must be from 0 to 1, is -1"]);
    expect_rule(principled("ior", json!(0)), &["must be from 0.01 to 100, is 0"]);
    expect_rule(principled("transmittance", json!([1, 1, 1])), &["has no key `transmittance`"]);
    let rough_mirror = json!({"type": "mirror", "reflectance": [1, 1, 1], "roughness": 0.1});
    expect_rule(rough_mirror, &["a mirror material has no key `roughness`"]);
}

#[test]
fn materials() {
    expect_rule(json!({"type": "metal"}), &["unknown variant `metal`", "`mirror`"]);
    expect_rule(json!({"reflectance": [0, 0, 0]}), &["missing field `type`"]);
    expect_rule(json!({"type": "diffuse"}), &["needs the key `reflectance`"]);
    expect_rule(
        json!({"type": "diffuse", "reflectance": null}),
        &["reflectance", "invalid type: null"],
    );
    expect_rule(
        json!({"type": "diffuse", "reflectance": 0.5}),
        &["reflectance", "[red, green, blue]"],
    );
    expect_rule(
        json!({"type": "diffuse", "reflectance": [0, 0, 1.1]}),
        &[".reflectance", "from 0 to 1, has 1.1"],
    );
    expect_rule(
        json!({"type": "diffuse", "reflectance": [0, -0.1, 1]}),
        &[".reflectance", "has -0.1"],
    );
    expect_rule(
        json!({"type": "diffuse", "reflectance": {"file": "x"}}),
        &["reflectance", "unknown field `file`"],
    );
    expect_rule(json!({"type": "diffuse", "reflectance": [0, 0, 0], "ior": 1}), &["no key `ior`"]);
    expect_rule(
        json!({"type": "diffuse", "reflectance": [0, 0, 0], "shine": 1}),
        &["unknown field `shine`"],
    );
    expect_rule(json!({"type": "mirror"}), &["needs the key `reflectance`"]);
    expect_rule(
        json!({"type": "mirror", "reflectance": {"texture": "x.png"}}),
        &["only diffuse and principled", "texture"],
    );
    expect_rule(json!({"type": "dielectric"}), &["needs the key `ior`"]);
    for ior in [0.0, -1.5, 1e9] {
        expect_rule(json!({"type": "dielectric", "ior": ior}), &[".ior", "from 0.01 to 100"]);
    }
    expect_rule(
        json!({"type": "dielectric", "ior": 1.5, "transmittance": [2, 0, 0]}),
        &[".transmittance", "has 2"],
    );
    expect_rule(json!({"type": "emissive"}), &["needs the key `radiance`"]);
    expect_rule(json!({"type": "emissive", "radiance": [-1, 0, 0]}), &[".radiance", "has -1"]);
    expect_rule(
        json!({"type": "emissive", "radiance": [1, 1, 1], "reflectance": {"texture": "x"}}),
        &["texture"],
    );
    expect_rule(json!({"type": "null", "reflectance": [0, 0, 0]}), &["no key `reflectance`"]);
}

#[test]
fn materials_that_the_obj_lacks() {
    let folder =
        SceneFolder::new().json(|scene| scene["materials"] = json!({"glass": {"type": "null"}}));
    expect(folder, &["scene.json", "key `materials`", "`glass`", "it uses `plain`, `red wall`"]);
}

#[test]
fn textures() {
    let textured = |name: &str| {
        SceneFolder::new().json(|scene| {
            scene["materials"] =
                json!({"red wall": {"type": "diffuse", "reflectance": {"texture": name}}});
        })
    };
    expect(
        textured("x.png"),
        &["scene.json", "materials.red wall.reflectance.texture", "no such file", "x.png"],
    );
    expect(
        textured("$RAYSTREAM_TEST_NEVER_SET/x"),
        &["materials.red wall.reflectance.texture", "is not set"],
    );
    expect(textured("x.png").with("x.png", "not a picture"), &["x.png", "not a usable texture"]);
    expect(textured("x.dat").with("x.dat", "not a picture"), &["x.dat", "not a usable texture"]);
    expect(textured("a.obj"), &["a.obj", "not a usable texture"]);
    let mut cut = Vec::new();
    let picture = image::RgbImage::new(64, 64);
    picture.write_to(&mut std::io::Cursor::new(&mut cut), image::ImageFormat::Png).unwrap();
    cut.truncate(60);
    expect(textured("x.png").with("x.png", cut), &["x.png", "not a usable texture"]);
    let broken = textured("x.hdr").with("x.hdr", "#?RADIANCE\nno picture");
    expect(broken, &["x.hdr", "not a usable texture"]);
    let magic = [0x76, 0x2f, 0x31, 0x01];
    expect(textured("x.exr").with("x.exr", magic), &["x.exr"]);
}

#[test]
fn objs_without_faces() {
    expect_obj("", &["has no faces"]);
    expect_obj("v 0 0 0\nv 1 0 0\nf 1 2\nl 1 2 1\n", &["has no faces"]);
}

#[test]
fn objs_with_bad_lines() {
    let v = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    let used = |line: &str| format!("{line}\n{v}f 1 2 3\n");
    expect_obj(&used("v 0 0"), &["line 1", "3 numbers"]);
    expect_obj(&used("v nan 0 0"), &["line 1", "`nan`"]);
    expect_obj(&used("v 0 0 1e39"), &["line 1", "`1e39`"]);
    expect_obj(&used("v 0 -1.#IND 0"), &["line 1", "`-1.#IND`"]);
    expect_obj(&used("v 0 1e11 0").replace("f 1 2 3", "f 1 2 3\nf 2 3 4"), &["line 1", "middle"]);
    expect_obj(&format!("{v}f 1 2 4\n"), &["line 4", "vertex 4 does not exist", "the file has 3"]);
    expect_obj(&format!("{v}f 1 2 0\n"), &["line 4", "vertex 0 does not exist"]);
    expect_obj(&format!("{v}f -1 -2 -4\n"), &["line 4", "vertex -4 does not exist"]);
    expect_obj(&format!("{v}f 1 2 {}\n", u128::MAX), &["line 4", "is not the index of a vertex"]);
    expect_obj(&format!("{v}f 1 2 three\n"), &["line 4", "`three`"]);
    expect_obj(&format!("{v}f 1 2 //\n"), &["line 4", "not a corner"]);
}

#[test]
fn mtls_with_bad_values() {
    let expect_mtl = |lines: &str, parts: &[&str]| {
        let folder = SceneFolder::new().with("a.mtl", format!("newmtl plain\n{lines}\n"));
        expect(folder, &[&["a.mtl", "`plain`"], parts].concat());
    };
    expect_mtl("Kd 1 2 3", &["line 2", "Kd", "from 0 to 1, has 2"]);
    expect_mtl("Kd 255 0 0", &["line 2", "Kd", "has 255"]);
    expect_mtl("Kd red", &["line 2", "Kd", "`red` is not a finite number"]);
    expect_mtl("Kd 0.5 0.5", &["line 2", "Kd", "has 2"]);
    expect_mtl("Kd nan 0 0", &["line 2", "Kd", "`nan`"]);
    expect_mtl("Ke 1 -1 0", &["line 2", "Ke", "has -1"]);
    expect_mtl("Ks 2\nillum 3", &["line 2", "Ks", "has 2"]);
    expect_mtl("Ni 0\nd .5\nillum 7", &["line 2", "Ni", "0.01"]);
    expect_mtl("illum x", &["line 2", "illum"]);
}

#[test]
fn an_mtl_with_bad_values_matters_only_where_it_is_used() {
    let mtl = format!("{MTL}newmtl unused\nKd 5 5 5\n");
    assert!(SceneFolder::new().with("a.mtl", mtl).load().is_ok());
    let bad = SceneFolder::new().with("a.mtl", "newmtl plain\nKd 5 5 5\n");
    assert!(bad.plain(json!({"type": "null"})).load().is_ok());
    assert!(OBJ.contains("usemtl plain"));
}

#[test]
fn names_of_scenes() {
    let message = raystream::scene::load_named("cornel").unwrap_err().to_string();
    assert!(message.contains("`cornel`") && message.contains("`cornell_ball`"), "{message}");
}
