//! What can go wrong with a picture on disk.

use std::io;
use std::path::{Path, PathBuf};

/// Why a picture could not be read, written or compared. Every message names the file and what to
/// do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ImageError {
    /// The extension names no known format.
    #[cfg_attr(
        feature = "exr",
        error("{}: not a picture format by its extension; use .exr or .png", path.display())
    )]
    #[cfg_attr(
        not(feature = "exr"),
        error(
            "{}: not a picture format by its extension; use .png (.exr takes the feature `exr`)",
            path.display()
        )
    )]
    UnknownExtension {
        /// The picture.
        path: PathBuf,
    },
    /// The folder to write into does not exist.
    #[error(
        "{}: there is no folder {}; create it or choose another path",
        path.display(),
        folder.display()
    )]
    NoFolder {
        /// The picture.
        path: PathBuf,
        /// The folder that is missing.
        folder: PathBuf,
    },
    /// The path names a folder.
    #[error("{}: is a folder; name a file", path.display())]
    IsFolder {
        /// The path.
        path: PathBuf,
    },
    /// The path names a device, a pipe or the like.
    #[error("{}: is not an ordinary file; choose another path", path.display())]
    NotAFile {
        /// The path.
        path: PathBuf,
    },
    /// The file to replace is read-only.
    #[error(
        "{}: exists and is write-protected; remove the protection or choose another path",
        path.display()
    )]
    WriteProtected {
        /// The picture.
        path: PathBuf,
    },
    /// No permission to create a file in the folder.
    #[error(
        "{}: no permission to write into the folder {}; change its permissions or choose another \
         path",
        path.display(), folder.display()
    )]
    FolderNotWritable {
        /// The picture.
        path: PathBuf,
        /// Its folder.
        folder: PathBuf,
    },
    /// The disk or the quota is full.
    #[error(
        "{}: no space left to write it; free some space or choose another disk",
        path.display()
    )]
    DiskFull {
        /// The picture.
        path: PathBuf,
    },
    /// Any other failure to write.
    #[error("{}: cannot be written: {source}; check the path and its disk", path.display())]
    Write {
        /// The picture.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// The file to read does not exist.
    #[error("{}: no such file; check the path", path.display())]
    NotFound {
        /// The picture.
        path: PathBuf,
    },
    /// Any other failure to read.
    #[error("{}: cannot be read: {source}; check its permissions and its disk", path.display())]
    Read {
        /// The picture.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// The contents are no valid picture.
    #[error(
        "{}: is not a valid {format} file ({reason}); it may be cut short: make or copy it again",
        path.display()
    )]
    Broken {
        /// The picture.
        path: PathBuf,
        /// EXR or PNG.
        format: &'static str,
        /// What the decoder found.
        reason: String,
    },
    /// A valid picture of a kind that is not read.
    #[error(
        "{}: {reason} is not supported; convert it to a flat, not subsampled EXR or an 8 or 16 \
         bit PNG",
        path.display()
    )]
    Unsupported {
        /// The picture.
        path: PathBuf,
        /// The feature.
        reason: String,
    },
    /// The EXR file has no red, green and blue.
    #[error(
        "{}: has no channels R, G, B, nor a layer with them; it has {channels}",
        path.display()
    )]
    NoColor {
        /// The picture.
        path: PathBuf,
        /// The names of its channels.
        channels: String,
    },
    /// A buffer does not hold one value for each pixel, or there is no pixel.
    #[error(
        "{}: {what} has {values} values, but the picture is {width}x{height} pixels (at least \
         1x1); nothing was written",
        path.display()
    )]
    BufferSize {
        /// The picture.
        path: PathBuf,
        /// The buffer.
        what: String,
        /// Its length.
        values: usize,
        /// Width of the picture in pixels.
        width: u32,
        /// Height of the picture in pixels.
        height: u32,
    },
    /// A setting cannot be stored under its key.
    #[error(
        "{}: the setting {key:?} cannot be stored; a key is 1 to 200 letters, digits, '.', '_' or \
         '-', and used once",
        path.display()
    )]
    SettingKey {
        /// The picture.
        path: PathBuf,
        /// The key.
        key: String,
    },
    /// The encoder refuses the picture.
    #[error(
        "{}: cannot be stored as {format}: {reason}; choose another format or size",
        path.display()
    )]
    Encode {
        /// The picture.
        path: PathBuf,
        /// EXR or PNG.
        format: &'static str,
        /// What the encoder says.
        reason: String,
    },
    /// Two pictures to compare have different sizes.
    #[error(
        "the pictures differ in size: the first is {}x{} pixels, the second {}x{}; render both at \
         the same size",
        test.0, test.1, reference.0, reference.1
    )]
    SizesDiffer {
        /// Width and height of the first.
        test: (u32, u32),
        /// Width and height of the second.
        reference: (u32, u32),
    },
}

impl ImageError {
    /// Fails unless the buffer `what` has one value for each of at least one pixel.
    ///
    /// # Errors
    /// [`Self::BufferSize`].
    pub fn check_buffer(
        path: &Path,
        what: &str,
        values: usize,
        width: u32,
        height: u32,
    ) -> Result<(), Self> {
        if values > 0 && values as u64 == u64::from(width) * u64::from(height) {
            return Ok(());
        }
        Err(Self::BufferSize {
            path: path.to_owned(),
            what: what.to_owned(),
            values,
            width,
            height,
        })
    }

    /// What `source`, met while writing `path` into `folder`, means.
    pub(super) fn from_write(path: &Path, folder: &Path, source: io::Error) -> Self {
        let path = path.to_owned();
        match source.kind() {
            io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => Self::DiskFull { path },
            io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => {
                Self::FolderNotWritable { path, folder: folder.to_owned() }
            }
            _ => Self::Write { path, source },
        }
    }

    /// What `source`, met while reading `path`, means.
    pub(crate) fn from_read(path: &Path, source: io::Error) -> Self {
        let path = path.to_owned();
        match source.kind() {
            io::ErrorKind::NotFound => Self::NotFound { path },
            _ => Self::Read { path, source },
        }
    }
}
