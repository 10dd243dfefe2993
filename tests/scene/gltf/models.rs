//! Models of others, which are not in the repository.

use raystream::scene::{SceneError, load};
use raystream_tests::{not_tested, prepare};
use std::path::{Path, PathBuf};

/// Names a folder of models, such as Khronos' glTF-Sample-Assets.
const FOLDER: &str = "RAYSTREAM_GLTF";

/// All files below a folder that are models by their names.
fn models(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            models(&path, found);
        } else if path.extension().is_some_and(|end| end == "gltf" || end == "glb") {
            found.push(path);
        }
    }
}

/// Every model becomes a scene that can be rendered, or else it is one of those whose error says
/// that it is not read.
#[test]
fn models_of_others_are_scenes() {
    let Some(folder) = std::env::var_os(FOLDER).filter(|folder| !folder.is_empty()) else {
        not_tested(&format!("models of others, whose folder {FOLDER} would name"));
        return;
    };
    let mut found = Vec::new();
    models(Path::new(&folder), &mut found);
    found.sort();
    assert!(!found.is_empty(), "{FOLDER}={}: there are no models", folder.display());
    let mut loaded = 0;
    for path in &found {
        match load(path) {
            Ok(scene) => {
                assert_eq!(scene.check(), Ok(()), "{}", path.display());
                prepare(&scene);
                loaded += 1;
            }
            Err(error @ SceneError::Extensions { .. }) => println!("{error}"),
            Err(error) => println!("refused: {error}"),
        }
    }
    println!("{loaded} of {} models are scenes", found.len());
    assert!(loaded > 0);
}
