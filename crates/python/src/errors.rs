//! Errors of the library as Python's.

use crate::devices;
use pyo3::exceptions::{
    PyFileNotFoundError, PyMemoryError, PyOSError, PyRuntimeError, PyValueError,
};
use pyo3::prelude::*;
use raystream::exec::ExecError;
use raystream::film_file::FilmFileError;
use raystream::image::ImageError;
use raystream::render::RenderError;
use raystream::scene::SceneError;
use raystream_cli::{CliError, in_keywords, with_hint};
use std::error::Error;
use std::io::ErrorKind;

/// What kind of error Python's users expect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// A file is not there.
    NotFound,
    /// The system refuses something.
    System,
    /// What was given is wrong.
    Value,
    /// There is not enough memory.
    Memory,
    /// A device fails.
    Device,
}

/// Does something without the interpreter's lock.
///
/// # Errors
/// What went wrong, as Python's.
pub fn without_lock<T: Send>(
    py: Python<'_>,
    something: impl FnOnce() -> Result<T, CliError> + Send,
) -> PyResult<T> {
    // The error itself need not be one that threads can pass on.
    let done = py.detach(|| something().map_err(|error| said(error.as_ref())));
    done.map_err(|(kind, text)| raised(kind, text))
}

/// The error in Python, with the same text.
pub fn python_error(error: &(dyn Error + 'static)) -> PyErr {
    let (kind, text) = said(error);
    raised(kind, text)
}

fn said(error: &(dyn Error + 'static)) -> (Kind, String) {
    (kind(error), in_keywords(&with_hint(error)))
}

fn raised(kind: Kind, text: String) -> PyErr {
    match kind {
        Kind::NotFound => PyFileNotFoundError::new_err(text),
        Kind::System => PyOSError::new_err(text),
        Kind::Value => PyValueError::new_err(text),
        Kind::Memory => PyMemoryError::new_err(text),
        Kind::Device => PyRuntimeError::new_err(text),
    }
}

/// An error of what was given.
pub fn value_error(text: impl Into<String>) -> PyErr {
    PyValueError::new_err(text.into())
}

fn kind(error: &(dyn Error + 'static)) -> Kind {
    if let Some(error) = error.downcast_ref::<FilmFileError>() {
        return match error {
            FilmFileError::File(error) => of_image(error),
            _ => Kind::Value,
        };
    }
    if let Some(error) = error.downcast_ref() {
        return of_image(error);
    }
    if let Some(error) = error.downcast_ref() {
        return of_scene(error);
    }
    if let Some(error) = error.downcast_ref() {
        return of_device(error);
    }
    match error.downcast_ref::<RenderError>() {
        Some(RenderError::Exec(error)) => of_device(error),
        _ => Kind::Value,
    }
}

fn of_image(error: &ImageError) -> Kind {
    match error {
        ImageError::NotFound { .. } | ImageError::NoFolder { .. } => Kind::NotFound,
        ImageError::IsFolder { .. }
        | ImageError::NotAFile { .. }
        | ImageError::WriteProtected { .. }
        | ImageError::FolderNotWritable { .. }
        | ImageError::DiskFull { .. }
        | ImageError::Write { .. }
        | ImageError::Read { .. } => Kind::System,
        _ => Kind::Value,
    }
}

fn of_scene(error: &SceneError) -> Kind {
    match error {
        SceneError::Read { source, .. } if source.kind() == ErrorKind::NotFound => Kind::NotFound,
        SceneError::Missing { .. } => Kind::NotFound,
        SceneError::Read { .. } | SceneError::Folder { .. } => Kind::System,
        SceneError::Picture { source } => of_image(source),
        _ => Kind::Value,
    }
}

fn of_device(error: &ExecError) -> Kind {
    // One may be lost.
    devices::forget();
    match error {
        ExecError::NoSuchDevice { .. } => Kind::Value,
        ExecError::OutOfMemory { .. } | ExecError::TooLarge { .. } => Kind::Memory,
        _ => Kind::Device,
    }
}
