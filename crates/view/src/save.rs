//! Saving: pictures with their settings, and the camera in a copy of the scene's file.

use crate::choices::Choices;
use crate::news::Status;
use glam::DVec3;
use raystream::film::Film;
use raystream::image::{Display, ImageError, replace_file, write_film_as};
use raystream::render::FilterKind;
use raystream::scene::{Camera, Projection};
use serde_json::{Map, Value, json};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// What can go wrong with saving.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SaveError {
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] ImageError),
    /// A file cannot be read.
    #[error("cannot read {path}: {source}")]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The scene is none of those whose file has a camera that can be written.
    #[error(
        "{path} is no scene file (JSON), and its format keeps no such camera. In a scene file it \
         would be \"camera\": {camera}"
    )]
    NoSceneFile {
        /// The file.
        path: PathBuf,
        /// The camera, as a scene file would have it.
        camera: String,
    },
    /// The copy would lie where the paths in it lead nowhere.
    #[error(
        "{path} is not in the folder of the scene, {folder}, from where the paths in it start: \
         save it there"
    )]
    OtherFolder {
        /// The copy.
        path: PathBuf,
        /// The folder of the scene.
        folder: PathBuf,
    },
}

/// Writes a film as `.exr` with all its layers and how it was made, or its picture as `.png`.
///
/// # Errors
/// If the name ends in neither, or the file cannot be written: what was there stays.
pub fn save_picture(
    path: &Path,
    film: &Film,
    display: &Display,
    settings: &[(String, String)],
) -> Result<(), SaveError> {
    Ok(write_film_as(path, film, settings, display)?)
}

/// What an EXR says of how it was made.
pub fn settings_of(
    scene: &str,
    device: &str,
    choices: &Choices,
    status: &Status,
) -> Vec<(String, String)> {
    [
        ("scene", scene.to_owned()),
        ("device", device.to_owned()),
        ("allocator", choices.allocator.to_string()),
        ("estimator", choices.estimator.to_string()),
        ("relative", choices.relative.to_string()),
        ("integrator", choices.integrator.to_string()),
        ("denoise", choices.filter.map_or("none", FilterKind::name).to_owned()),
        ("seed", choices.seed.to_string()),
        ("samples", format!("{:.3}", status.samples)),
        ("seconds", format!("{:.3}", status.time.as_secs_f64())),
    ]
    .map(|(key, value)| (key.to_owned(), value))
    .into()
}

/// Writes a copy of a scene file that has this camera; all else stays as it is, byte for byte.
/// `before` is the camera that the file was loaded with: where a scene lies far from the origin the
/// renderer's coordinates start elsewhere than the file's.
///
/// # Errors
/// If `scene` is no scene file or cannot be read, or `copy` is in another folder or cannot be
/// written: what was there stays.
pub fn save_camera(
    scene: &Path,
    copy: &Path,
    camera: &Camera,
    before: &Camera,
) -> Result<(), SaveError> {
    let read = |source| SaveError::Read { path: scene.to_owned(), source };
    let bytes = std::fs::read(scene).map_err(read)?;
    let no_scene_file = |origin| SaveError::NoSceneFile {
        path: scene.to_owned(),
        camera: Value::Object(camera_keys(camera, origin)).to_string(),
    };
    let text = String::from_utf8(bytes).map_err(|_| no_scene_file(DVec3::ZERO))?;
    let Some((place, value)) = camera_in(&text) else { return Err(no_scene_file(DVec3::ZERO)) };
    let folder = |path: &Path| {
        let parent = path.parent().filter(|parent| !parent.as_os_str().is_empty());
        parent.unwrap_or(Path::new(".")).canonicalize().ok()
    };
    if folder(scene) != folder(copy) {
        let folder = scene.parent().unwrap_or(Path::new(".")).to_owned();
        return Err(SaveError::OtherFolder { path: copy.to_owned(), folder });
    }
    let keys = camera_keys(camera, origin_of(&value, before));
    let mut changed = text.clone();
    changed.replace_range(place, &pretty(&keys));
    Ok(replace_file(copy, changed.as_bytes())?)
}

/// Where the copy of a scene's file lies unless somebody says otherwise: `a.view.json` beside
/// `a.json`.
pub fn copy_of(scene: &Path) -> PathBuf {
    scene.with_extension("view.json")
}

/// The camera of a scene file: where in the text it is, and what it says.
fn camera_in(text: &str) -> Option<(Range<usize>, Value)> {
    let whole: Map<String, Value> = serde_json::from_str(text).ok()?;
    let value = whole.get("camera").filter(|_| whole.contains_key("format"))?;
    Some((place_of(text, "camera")?, value.clone()))
}

/// Where in the text of an object the value of a key is. The text is JSON.
fn place_of(text: &str, key: &str) -> Option<Range<usize>> {
    let bytes = text.as_bytes();
    let (mut depth, mut at) = (0, 0);
    let (mut last, mut start) = (None, None);
    while at < bytes.len() {
        match bytes[at] {
            b'"' => {
                let end = end_of_string(bytes, at)?;
                last = serde_json::from_str::<String>(&text[at..end]).ok();
                at = end;
                continue;
            }
            b':' if depth == 1 && last.as_deref() == Some(key) => start = Some(at + 1),
            b'{' | b'[' => depth += 1,
            byte @ (b'}' | b']' | b',') => {
                if let Some(start) = start.filter(|_| depth == 1) {
                    let value = &text[start..at];
                    let before = value.len() - value.trim_start().len();
                    return Some(start + before..start + value.trim_end().len());
                }
                depth -= i32::from(byte != b',');
            }
            _ => {}
        }
        at += 1;
    }
    None
}

/// Behind the quotation mark that ends the string which begins at `start`.
fn end_of_string(bytes: &[u8], start: usize) -> Option<usize> {
    let mut at = start + 1;
    loop {
        match bytes.get(at)? {
            b'"' => return Some(at + 1),
            b'\\' => at += 2,
            _ => at += 1,
        }
    }
}

/// What the renderer's coordinates lack of the file's; zero unless the scene lies far away.
fn origin_of(in_file: &Value, before: &Camera) -> DVec3 {
    let number = |axis: usize| in_file["origin"][axis].as_f64();
    let (Some(x), Some(y), Some(z)) = (number(0), number(1), number(2)) else { return DVec3::ZERO };
    let difference = DVec3::new(x, y, z) - before.origin.as_dvec3();
    // As much as a float may be off.
    let rounding = 1e-6 * (1.0 + DVec3::new(x, y, z).abs().max_element());
    if difference.abs().max_element() > rounding { difference } else { DVec3::ZERO }
}

/// A camera as the keys of a scene file.
fn camera_keys(camera: &Camera, origin: DVec3) -> Map<String, Value> {
    let place = |point: glam::Vec3| vector(point.to_array(), origin);
    let mut keys = Map::new();
    match camera.projection {
        Projection::Perspective { .. } => {}
        Projection::Orthographic { .. } => drop(keys.insert("type".into(), json!("orthographic"))),
        Projection::Panorama => drop(keys.insert("type".into(), json!("panorama"))),
    }
    keys.insert("origin".into(), place(camera.origin));
    keys.insert("target".into(), place(camera.target));
    keys.insert("up".into(), vector(camera.up.to_array(), DVec3::ZERO));
    match camera.projection {
        Projection::Perspective { fov_y, lens } => {
            keys.insert("fov_y".into(), number(fov_y));
            if let Some(lens) = lens {
                keys.insert("aperture".into(), number(lens.radius));
                keys.insert("focus".into(), number(lens.focus_distance));
                keys.insert("blades".into(), json!(lens.blades));
            }
        }
        Projection::Orthographic { width } => drop(keys.insert("width".into(), number(width))),
        Projection::Panorama => {}
    }
    keys
}

fn vector(components: [f32; 3], origin: DVec3) -> Value {
    let origin = origin.to_array();
    Value::Array(
        (0..3)
            .map(|axis| match origin[axis] {
                0.0 => number(components[axis]),
                far => json!(far + f64::from(components[axis])),
            })
            .collect(),
    )
}

/// A float in as few digits as tell it from others.
fn number(value: f32) -> Value {
    let shortest: f64 = value.to_string().parse().unwrap_or(f64::from(value));
    if shortest.fract() == 0.0 && shortest.abs() < 1e9 {
        return json!(shortest as i64);
    }
    json!(shortest)
}

/// An object with a key a line, as it looks inside of another.
fn pretty(keys: &Map<String, Value>) -> String {
    let order = ["type", "origin", "target", "up", "fov_y", "aperture", "focus", "blades", "width"];
    let lines: Vec<String> = order
        .iter()
        .filter_map(|key| Some(format!("    \"{key}\": {}", keys.get(*key)?)))
        .map(|line| line.replace(',', ", "))
        .collect();
    format!("{{\n{}\n  }}", lines.join(",\n"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use raystream::scene::{self, Lens};

    const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

    /// A folder with a scene file whose camera is written so.
    fn folder(camera: &str, obj: &str) -> (tempfile::TempDir, PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.json");
        let text = format!(
            "{{\n  \"format\": 2, \"name\": \"a \\\"camera\\\": {{}}\",\n  \"about\": {{\"camera\": \
             [1, 2]}},\n  \"camera\": {camera},\n  \"film\": {{\"width\": 8, \"height\": 6}},\n  \
             \"background\": [1, 1, 1],\n  \"meshes\": [{{\"file\": \"a.obj\"}}]\n}}\n"
        );
        std::fs::write(&path, text).unwrap();
        std::fs::write(folder.path().join("a.obj"), obj).unwrap();
        (folder, path)
    }

    const PLAIN: &str =
        r#"{"origin": [0, 0, 4], "target": [0, 0.1, 0], "up": [0, 1, 0], "fov_y": 40}"#;

    #[test]
    fn the_copy_has_the_camera_and_all_else_as_it_was() {
        let (_folder, path) = folder(PLAIN, OBJ);
        let before = scene::load(&path).unwrap();
        let lens = Some(Lens { radius: 0.1, focus_distance: 3.3, blades: 5 });
        let perspective = Projection::Perspective { fov_y: 33.3, lens };
        for projection in
            [perspective, Projection::Orthographic { width: 2.5 }, Projection::Panorama]
        {
            let camera = Camera {
                origin: Vec3::new(0.1, -2.0, 1e-7),
                target: Vec3::new(1.0 / 3.0, 0.0, -4.5),
                up: Vec3::Y,
                projection,
            };
            let copy = copy_of(&path);
            save_camera(&path, &copy, &camera, &before.camera).unwrap();
            let after = scene::load(&copy).unwrap();
            assert_eq!(after.camera, camera);
            assert_eq!(scene::Scene { camera: before.camera, ..after }, before);
            let (old, new) =
                [&path, &copy].map(|path| std::fs::read_to_string(path).unwrap()).into();
            assert_eq!(new.split("\"film\"").nth(1), old.split("\"film\"").nth(1));
            assert!(new.starts_with(old.split(PLAIN).next().unwrap()), "{new}");
        }
    }

    #[test]
    fn a_scene_far_away_stays_there() {
        let obj = "v 448250 95 5411780\nv 448251 95 5411780\nv 448250 96 5411780\nf 1 2 3\n";
        let camera = r#"{"origin": [448250.5, 95.25, 5411784.5], "target": [448250.5, 95.25, 5411780],
            "up": [0, 1, 0], "fov_y": 40}"#;
        let (_folder, path) = folder(camera, obj);
        let before = scene::load(&path).unwrap();
        let camera = Camera { origin: before.camera.origin + Vec3::X, ..before.camera };
        let copy = copy_of(&path);
        save_camera(&path, &copy, &camera, &before.camera).unwrap();
        let text = std::fs::read_to_string(&copy).unwrap();
        assert!(text.contains("\"origin\": [448251.5, 95.25, 5411784.5]"), "{text}");
        assert_eq!(scene::load(&copy).unwrap().camera, camera);
    }

    #[test]
    fn what_is_no_scene_file_is_refused_and_the_camera_said() {
        let folder = tempfile::tempdir().unwrap();
        let camera = Camera::new(Vec3::new(1.5, 2.0, 3.0), Vec3::ZERO, 40.0);
        for (name, bytes) in [
            ("a.glb", &b"glTF\xff\xfe"[..]),
            ("a.gltf", br#"{"asset": {"version": "2.0"}, "camera": {}}"#),
            ("a.obj", b"v 0 0 0\n"),
            ("a.ply", b"ply\n"),
        ] {
            let path = folder.path().join(name);
            std::fs::write(&path, bytes).unwrap();
            let error = save_camera(&path, &copy_of(&path), &camera, &camera).unwrap_err();
            let error = error.to_string();
            assert!(error.contains(name) && error.contains("[1.5,2,3]"), "{error}");
        }
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 4, "nothing was written");
        let missing = folder.path().join("none.json");
        let error = save_camera(&missing, &missing, &camera, &camera).unwrap_err().to_string();
        assert!(error.contains("none.json"), "{error}");
    }

    #[test]
    fn a_copy_elsewhere_would_not_find_its_files() {
        let (_folder, path) = folder(PLAIN, OBJ);
        let elsewhere = tempfile::tempdir().unwrap();
        let camera = scene::load(&path).unwrap().camera;
        let copy = elsewhere.path().join("a.json");
        let error = save_camera(&path, &copy, &camera, &camera).unwrap_err().to_string();
        assert!(error.contains("the folder of the scene"), "{error}");
        assert!(!copy.exists());
    }

    #[test]
    fn pictures_say_how_they_were_made() {
        let folder = tempfile::tempdir().unwrap();
        let film = Film::new(1, 1, vec![Default::default()], vec![Default::default()]);
        let settings = settings_of(
            "a",
            "cpu",
            &Choices::default(),
            &Status { samples: 2.5, ..Status::default() },
        );
        let path = folder.path().join("a.exr");
        save_picture(&path, &film, &Display::default(), &settings).unwrap();
        let read = raystream::image::read_settings(&path).unwrap();
        assert_eq!(read.get("allocator").map(String::as_str), Some("runs"), "{read:?}");
        assert_eq!(read.get("samples").map(String::as_str), Some("2.500"), "{read:?}");
        let path = folder.path().join("a.png");
        save_picture(&path, &film, &Display::default(), &settings).unwrap();
        assert!(path.is_file());
        let error =
            save_picture(&folder.path().join("a.bmp"), &film, &Display::default(), &settings);
        assert!(error.unwrap_err().to_string().contains("a.bmp"));
    }
}
