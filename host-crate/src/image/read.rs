//! Files, read whole.

use super::ImageError;
use std::path::Path;

/// The bytes of an ordinary file.
pub(super) fn read_file(path: &Path) -> Result<Vec<u8>, ImageError> {
    let metadata = std::fs::metadata(path).map_err(|e| ImageError::from_read(path, e))?;
    if metadata.is_dir() {
        return Err(ImageError::IsFolder { path: path.to_owned() });
    }
    if !metadata.is_file() {
        return Err(ImageError::NotAFile { path: path.to_owned() });
    }
    std::fs::read(path).map_err(|e| ImageError::from_read(path, e))
}
