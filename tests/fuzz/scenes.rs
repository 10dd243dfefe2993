//! Scenes: OBJ, MTL, scene files, textures.

use super::{as_it_is, correct_checksums, fuzz};
use raystream::render::{BvhQuality, PreparedScene};
use raystream::scene::{LoadOptions, SceneError};
use raystream_tests::scene_folder::{MTL, OBJ};
use std::collections::BTreeMap;
use std::io::Cursor;
use std::path::{Path, PathBuf};

const SCENE: &str = r#"{"format": 1, "name": "x", "obj": "a.obj", "normals": "smooth",
"film": {"width": 8, "height": 6}, "max_depth": 8, "rr_depth": 5,
"camera": {"origin": [0, 0, 5], "target": [0, 0, 0], "up": [0, 1, 0], "fov_y": 40},
"materials": {"plain": {"type": "dielectric", "ior": 1.5, "transmittance": [1, 0.5, 0.25]},
"red wall": {"type": "diffuse", "reflectance": {"texture": "t.png"}}},
"quads": [{"corner": [0, 0, 3], "u": [1, 0, 0], "v": [0, 1, 0], "radiance": [1, 2, 3]}]}
"#;

/// A scene file that leaves all to the OBJ and the MTL.
const PLAIN_SCENE: &str = r#"{"format": 1, "name": "x", "obj": "a.obj", "normals": "smooth",
"film": {"width": 8, "height": 6},
"camera": {"origin": [0, 0, 5], "target": [0, 0, 0], "up": [0, 1, 0], "fov_y": 40}}
"#;

/// A scene file of format 2.
const SCENE_2: &str = r#"{"format": 2, "name": "x", "film": {"width": 8, "height": 6},
"camera": {"type": "perspective", "origin": [0, 0, 5], "target": [0, 0, 0], "up": [0, 1, 0],
"fov_y": 40, "aperture": 0.1, "focus": 4, "blades": 5},
"meshes": [{"file": "a.obj", "material": "m", "normals": "smooth", "dedupe": true,
"transform": {"scale": [1, 2, -3], "rotate": [10, 20, 30], "translate": [1, 0, 0]}},
{"file": "a.obj", "materials": {"plain": {"type": "null"}, "red wall": "m"},
"transform": {"matrix": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 7]]}}],
"materials": {"m": {"type": "principled", "reflectance": {"texture": "t.png"}, "radiance": [1, 2, 3],
"specular": [1, 1, 1], "textures": {"roughness": {"file": "t.png", "channel": "green"},
"normal": {"file": "t.png", "scale": 2}, "emission": {"file": "t.png"}}}},
"lights": [{"type": "point", "position": [0, 1, 0], "intensity": [1, 1, 1]},
{"type": "spot", "position": [0, 1, 0], "direction": [0, -1, 0], "intensity": [1, 1, 1],
"inner_angle": 10, "outer_angle": 20},
{"type": "directional", "direction": [0, -1, 0], "irradiance": [1, 1, 1], "angle": 1}],
"environment": {"colour": [1, 1, 1], "strength": 2}, "background": [0, 0, 1]}
"#;

const LARGER_OBJ: &str = "\u{feff}# a\r\nmtllib a.mtl b.mtl\r\no x\nv -1 -1 0 1 0.5 0\nv 1 -1 0\n\
    v 1 1 0\nv -1 1 0\nv 0 0.2 0\nv 448250.5 95.25 5411780.75\nvt 0 0\nvt 1 0 0\nvt .5\nvn 0 0 1\n\
    vn 1e-30 2 3\ns 1\nusemtl textured\nf 1/1/1 2/2/1 3/3/1 4/1/1 5/2/1\nf -5/1 -4/2 -3/3\ng y\n\
    usemtl red wall\nf 1//1 2//2 \\\n3//1\nl 1 2\nf 1 2 3 4\np 1\ncurv 0 1 1 2\n";

const LARGER_MTL: &str = "newmtl textured\nillum 2\nKa 0 0 0\nKd .8 .8 .8\nKs 0.5 0.5 0.5\n\
    Ns 96.078\nNi 1.45\nd 0.9\nTr 0.1\nTf 1 1 1\nmap_Kd -s 2 2 1 -o 0.5 0 0 -clamp on t.png\n\
    map_Ke t.png\nmap_d \"C:\\x\\t.png\"\nbump -bm 0.3 t.png\nnewmtl plain\nillum 7\nKe 3 2 1\n\
    newmtl red wall\nKd spectral x.rfl 1\nKs xyz 1 1 1\nillum 4\nd -halo 0.5\n";

const WORDS: &[&str] = &[
    "\n",
    "\r",
    "\\\n",
    " ",
    "\t",
    "#",
    "\"",
    "'",
    "/",
    "//",
    "\\",
    "\u{feff}",
    "v ",
    "\nvt ",
    "\nvn ",
    "\nf ",
    "\nl 1 2",
    "\nusemtl ",
    "\nmtllib ",
    "a.mtl",
    "t.png",
    "\ng ",
    "\ns off",
    "nan",
    "1.#IND",
    "-1",
    "1//1",
    "1/1/1",
    "textured",
    "plain",
    "red wall",
    "\nnewmtl ",
    "\nKd ",
    "\nKe ",
    "\nKs ",
    "\nNi ",
    "\nd ",
    "\nTr ",
    "\nTf ",
    "\nillum ",
    "\nmap_Kd ",
    "-s ",
    "-o ",
    "-t ",
    "-clamp on ",
    "-bm 1 ",
    "-mm 0 1 ",
    "-imfchan r ",
    "spectral ",
    "xyz ",
    "\nmap_Ke ",
    "\nmap_d ",
    "\nbump ",
    "..",
    "/tmp/",
];

const JSON_WORDS: &[&str] = &[
    "{",
    "}",
    "[",
    "]",
    ",",
    ":",
    "\"",
    "null",
    "true",
    "\"format\": ",
    "\"obj\": ",
    "\"name\": ",
    "\"film\": ",
    "\"camera\": ",
    "\"background\": [1, 1, 1]",
    "\"normals\": \"flat\"",
    "\"materials\": ",
    "\"quads\": ",
    "\"type\": ",
    "\"mirror\"",
    "\"diffuse\"",
    "\"dielectric\"",
    "\"emissive\"",
    "\"null\"",
    "\"reflectance\": ",
    "\"radiance\": ",
    "\"transmittance\": ",
    "\"ior\": ",
    "\"texture\": ",
    "\"t.png\"",
    "\"$HOME\"",
    "\"${X}\"",
    "\"dedupe\": true",
    "\\u0000",
    "[[[[[[[[",
    "1e400",
    "-0.0",
    "\"meshes\": ",
    "\"file\": ",
    "\"a.obj\"",
    "\"transform\": ",
    "\"lights\": ",
    "\"environment\": ",
    "\"width\": ",
    "\"priority\": ",
    "\"conductor\"",
    "\"metal\": ",
    "\"sky\": ",
    "\"elevation\": ",
    "\"orthographic\"",
    "\"max_depth\": ",
    "\"rr_depth\": ",
];

/// A picture of two texels, in a format that textures may have.
fn picture(format: image::ImageFormat) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let texels = vec![255, 0, 0, 9, 80, 128];
    image::RgbImage::from_raw(2, 1, texels).unwrap().write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

fn files(scene: &str, obj: &[u8], mtl: &[u8], picture: &[u8]) -> BTreeMap<PathBuf, Vec<u8>> {
    let files = [("s.json", scene.as_bytes()), ("a.obj", obj), ("a.mtl", mtl), ("t.png", picture)];
    files.map(|(path, bytes)| (path.into(), bytes.to_vec())).into()
}

/// Loads a scene, and makes it ready to be rendered if it can be.
fn load(files: &BTreeMap<PathBuf, Vec<u8>>) {
    let options = LoadOptions { max_memory: 256 << 20, ..LoadOptions::default() };
    let longest = files.values().map(Vec::len).max().unwrap_or(0);
    match options.load_files(files, Path::new("s.json")) {
        Ok(scene) if scene.triangle_count() <= 64 => {
            // Too deep a hierarchy is an error.
            let _ = PreparedScene::new(&scene, BvhQuality::Fast);
        }
        Ok(scene) => scene.check().unwrap(),
        Err(error) => check(&error, longest),
    }
}

/// An error says something, and no more than a file of that length could have in it.
fn check(error: &SceneError, longest: usize) {
    let message = error.to_string();
    assert!(!message.is_empty() && message.len() < 4000 + 8 * longest, "{} bytes", message.len());
}

#[test]
fn obj_files_by_chance() {
    let png = picture(image::ImageFormat::Png);
    let seeds = vec![OBJ.into(), LARGER_OBJ.into()];
    fuzz("obj", seeds, WORDS, as_it_is, |obj| {
        load(&files(PLAIN_SCENE, obj, LARGER_MTL.as_bytes(), &png));
    });
}

#[test]
fn mtl_files_by_chance() {
    let png = picture(image::ImageFormat::Png);
    let seeds = vec![MTL.into(), LARGER_MTL.into()];
    fuzz("mtl", seeds, WORDS, as_it_is, |mtl| {
        load(&files(PLAIN_SCENE, LARGER_OBJ.as_bytes(), mtl, &png));
    });
}

#[test]
fn scene_files_by_chance() {
    let png = picture(image::ImageFormat::Png);
    let seeds = vec![SCENE.into(), PLAIN_SCENE.into(), SCENE_2.into()];
    fuzz("scene", seeds, JSON_WORDS, as_it_is, |scene| {
        let mut files = files("", OBJ.as_bytes(), MTL.as_bytes(), &png);
        files.insert("s.json".into(), scene.to_vec());
        load(&files);
    });
}

#[test]
fn textures_by_chance() {
    use image::ImageFormat::{Bmp, Jpeg, Png, Tga, Tiff};
    let seeds = [Bmp, Jpeg, Png, Tga, Tiff].map(picture).to_vec();
    let words = &["IHDR", "IDAT", "PLTE", "tRNS", "iCCP", "acTL", "BM", "II*\0", "GIF89a", "RIFF"];
    fuzz("texture", seeds, words, correct_checksums, |bytes| {
        let mut files = files(PLAIN_SCENE, LARGER_OBJ.as_bytes(), b"", bytes);
        for name in ["t.png", "t.tga"] {
            let mtl = format!("newmtl textured\nmap_Kd {name}\n");
            files.insert("a.mtl".into(), mtl.into_bytes());
            files.insert(name.into(), bytes.to_vec());
            load(&files);
        }
    });
}
