//! What the library has to say, as Python's warnings.
//!
//! Threads that have not the interpreter's lock leave their words here; whoever has it next warns.

use pyo3::exceptions::PyUserWarning;
use pyo3::prelude::*;
use std::ffi::CString;
use std::io::{self, Write};
use std::sync::{Mutex, PoisonError};
use tracing_subscriber::filter::LevelFilter;

/// Words that nobody has been told.
static WAITING: Mutex<Vec<String>> = Mutex::new(Vec::new());

/// Has the library's warnings wait here from now on.
pub fn listen() {
    // Fails only where somebody listens already, who then goes on.
    let _ = tracing_subscriber::fmt()
        .with_max_level(LevelFilter::WARN)
        .without_time()
        .with_target(false)
        .with_level(false)
        .with_ansi(false)
        .log_internal_errors(false)
        .with_writer(|| Words)
        .try_init();
}

/// Takes words to wait.
struct Words;

impl Write for Words {
    fn write(&mut self, words: &[u8]) -> io::Result<usize> {
        let text = String::from_utf8_lossy(words).trim().to_owned();
        WAITING.lock().unwrap_or_else(PoisonError::into_inner).push(text);
        Ok(words.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Warns of `texts`, and of what waits.
///
/// # Errors
/// Where the user has made errors of warnings.
pub fn warn(py: Python<'_>, texts: &[String]) -> PyResult<()> {
    let waiting = std::mem::take(&mut *WAITING.lock().unwrap_or_else(PoisonError::into_inner));
    for text in waiting.iter().chain(texts) {
        let text = CString::new(text.replace('\0', " ")).unwrap_or_default();
        PyErr::warn(py, &py.get_type::<PyUserWarning>(), &text, 1)?;
    }
    Ok(())
}
