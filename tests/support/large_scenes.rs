//! The large scenes, which are not in the repository.

use crate::not_tested;
use std::path::PathBuf;

/// Names the folder with the large scenes and their reference pictures.
const FOLDER: &str = "RAYSTREAM_SCENES";

/// The folder with the large scenes and their reference pictures; says so loudly if none is named.
///
/// # Panics
/// If a folder is named that is not there.
pub fn large_scenes() -> Option<PathBuf> {
    let Some(folder) = std::env::var_os(FOLDER).filter(|folder| !folder.is_empty()) else {
        not_tested(&format!(
            "the large scenes and their reference pictures, whose folder {FOLDER} would name"
        ));
        return None;
    };
    let folder = PathBuf::from(folder);
    assert!(folder.is_absolute(), "{FOLDER}={}: not an absolute path", folder.display());
    assert!(folder.is_dir(), "{FOLDER}={}: there is no such folder", folder.display());
    Some(folder)
}
