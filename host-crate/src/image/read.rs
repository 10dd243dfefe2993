//! Files, opened and read whole.

use super::ImageError;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// An ordinary file.
pub(crate) fn open_file(path: &Path) -> Result<File, ImageError> {
    let metadata = std::fs::metadata(path).map_err(|e| ImageError::from_read(path, e))?;
    if metadata.is_dir() {
        return Err(ImageError::IsFolder { path: path.to_owned() });
    }
    if !metadata.is_file() {
        return Err(ImageError::NotAFile { path: path.to_owned() });
    }
    File::open(path).map_err(|e| ImageError::from_read(path, e))
}

/// The bytes of an ordinary file.
pub(crate) fn read_file(path: &Path) -> Result<Vec<u8>, ImageError> {
    let (mut file, mut bytes) = (open_file(path)?, Vec::new());
    file.read_to_end(&mut bytes).map_err(|e| ImageError::from_read(path, e))?;
    Ok(bytes)
}
