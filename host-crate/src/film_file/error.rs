//! What can go wrong with a film file.

use super::header::Difference;
use crate::image::ImageError;
use std::path::PathBuf;

/// Why a film file could not be read, written, gone on from or merged. Every message names the file
/// and what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FilmFileError {
    /// The file itself: it is missing, damaged, on a full disk.
    #[error(transparent)]
    File(#[from] ImageError),
    /// The file is something else.
    #[error("{}: is not a film file; name one that a render was kept in", path.display())]
    NotAFilm {
        /// The file.
        path: PathBuf,
    },
    /// The file is of another form.
    #[error(
        "{}: is a film file of format {found}, but this is version {} of Raystream, which reads \
         format {reads}; use the version that wrote it",
        path.display(),
        env!("CARGO_PKG_VERSION")
    )]
    Format {
        /// The file.
        path: PathBuf,
        /// Its format.
        found: u32,
        /// The format that is read.
        reads: u32,
    },
    /// The film is of another render.
    #[error(
        "{}: its {} are not those of {}; merge films of one render only",
        path.display(),
        match difference {
            Difference::Kernels => "kernels",
            Difference::Scene => "scene's triangles, materials, lights and camera",
            Difference::Settings => "settings",
            Difference::Parts => "parts",
        },
        other.display()
    )]
    Differs {
        /// The file.
        path: PathBuf,
        /// What differs.
        difference: Difference,
        /// The file that it differs from.
        other: PathBuf,
    },
    /// A film to be merged is of a whole render.
    #[error(
        "{}: is not of a part of a render; only parts of one are merged",
        path.display()
    )]
    NoPart {
        /// The file.
        path: PathBuf,
    },
    /// Two films to be merged have the same samples.
    #[error(
        "{}: is of the same part as {}; leave out one of them", path.display(), other.display()
    )]
    Twice {
        /// The file.
        path: PathBuf,
        /// The other one.
        other: PathBuf,
    },
    /// There are no films to merge.
    #[error("no film to merge; name at least one")]
    Nothing,
}
