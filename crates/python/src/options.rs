//! Keywords as options of the command line.

use crate::errors::value_error;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyString, PyTuple};
use raystream_cli::{CallOption, call_options};
use std::path::PathBuf;

/// Options by name; a flag has no value.
pub type Options = Vec<(String, Option<String>)>;

/// Those of keywords. What is None, and a flag that is False, is not given.
///
/// # Errors
/// If a value is of a type that no option has.
pub fn options_of(keywords: Option<&Bound<'_, PyDict>>) -> PyResult<Options> {
    let known = call_options();
    let mut options = Options::new();
    let Some(keywords) = keywords else { return Ok(options) };
    for (name, value) in keywords {
        let name: String = name.extract()?;
        if value.is_none() {
            continue;
        }
        let option = known.iter().find(|option| option.name == name);
        if let Some(value) = option_value(&name, &value, option)? {
            options.push((name, value));
        }
    }
    Ok(options)
}

/// The value of an option; None outside where it is not given, and inside where it stands alone.
fn option_value(
    name: &str,
    value: &Bound<'_, PyAny>,
    option: Option<&CallOption>,
) -> PyResult<Option<Option<String>>> {
    let is_flag = option.is_some_and(|option| option.is_flag);
    let truth = if is_flag { value.is_truthy().ok() } else { None };
    let truth = truth.or_else(|| value.cast::<PyBool>().ok().map(PyBoolMethods::is_true));
    match truth {
        Some(false) => Ok(None),
        Some(true) if option.is_none_or(|option| option.is_flag || option.may_be_bare) => {
            Ok(Some(None))
        }
        Some(true) => Err(value_error(format!("{name}: takes a value, and no True"))),
        None => Ok(Some(Some(text_of(name, value)?))),
    }
}

/// A value as a word of a command line: of a pair, `8x6` or `0/4`; of a list, its elements with
/// commas.
fn text_of(name: &str, value: &Bound<'_, PyAny>) -> PyResult<String> {
    if value.is_instance_of::<PyString>() {
        return value.extract();
    }
    if let Ok(values) = value.cast::<PyTuple>() {
        let values: PyResult<Vec<_>> = values.iter().map(|value| text_of(name, &value)).collect();
        return Ok(values?.join(if name == "part" { "/" } else { "x" }));
    }
    if let Ok(values) = value.cast::<PyList>() {
        let values: PyResult<Vec<_>> = values.iter().map(|value| text_of(name, &value)).collect();
        return Ok(values?.join(","));
    }
    if value.is_instance_of::<PyInt>() || value.hasattr("__index__")? {
        let number = value.py().import("operator")?.call_method1("index", (value,))?;
        return Ok(number.str()?.to_string());
    }
    if value.is_instance_of::<PyFloat>() || value.hasattr("__float__")? {
        let number: f64 = value.extract()?;
        return Ok(number.to_string());
    }
    if value.hasattr("__fspath__")? {
        return path_text(name, value);
    }
    let kind = value.get_type();
    Err(PyTypeError::new_err(format!("{name}: takes no {}", kind.name()?)))
}

/// A path in words.
///
/// # Errors
/// If it is none, or not in Unicode.
pub fn path_text(name: &str, value: &Bound<'_, PyAny>) -> PyResult<String> {
    let path: PathBuf = value.extract()?;
    path.into_os_string().into_string().map_err(|path| {
        value_error(format!("{name}: {}: is not in UTF-8; rename it", path.display()))
    })
}

/// The options that say how scenes are loaded, and the others.
pub fn split(options: Options) -> (Options, Options) {
    let known = call_options();
    let loads = |name: &str| known.iter().any(|option| option.name == name && option.loads);
    options.into_iter().partition(|(name, _)| loads(name))
}

/// The options of render() and Renderer(), and those of load(): names and what they mean.
///
/// Returns two dictionaries. The options are those of `raystream render`, so that its manual holds
/// for them, too.
#[pyfunction]
pub fn options(py: Python<'_>) -> PyResult<(Bound<'_, PyDict>, Bound<'_, PyDict>)> {
    let (of_render, of_load) = (PyDict::new(py), PyDict::new(py));
    for option in call_options() {
        let options = if option.loads { &of_load } else { &of_render };
        options.set_item(option.name, option.help)?;
    }
    Ok((of_render, of_load))
}
