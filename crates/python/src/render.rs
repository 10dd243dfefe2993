//! A render in one call.

use crate::devices;
use crate::errors::{value_error, without_lock};
use crate::layers::{COLOR, array};
use crate::options::{Options, options_of};
use crate::said::warn;
use crate::scene::{Scene, scene_of};
use crate::watch::Signals;
use numpy::PyArrayDyn;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use raystream::film_file::FilmFile;
use raystream::image::{ColorImage, LayeredImage};
use raystream::render::run_watched;
use raystream_cli::{Call, CliError, ReadyCall, Rendered, in_keywords};
use std::path::PathBuf;

/// Makes a call ready, from its beginning or from a film of a file: scene, hierarchy, devices. Warns
/// of what is to be known.
pub fn ready(
    py: Python<'_>,
    scene: &Scene,
    call: Call,
    from: Option<(PathBuf, FilmFile)>,
) -> PyResult<ReadyCall> {
    let (ready, warnings) = without_lock(py, || {
        let (prepared, warnings) = scene.prepare(&call)?;
        let devices = devices::open(&call)?;
        Ok((call.ready(&scene.scene, prepared, devices, from), warnings))
    })?;
    warn(py, &warnings)?;
    warn(py, ready.warnings())?;
    Ok(ready)
}

/// A render of `scene`, a Scene or what load() takes, with these keywords, made ready.
pub fn ready_of(
    scene: &Bound<'_, PyAny>,
    options: Option<&Bound<'_, PyDict>>,
) -> PyResult<ReadyCall> {
    let (scene, others) = scene_of(scene, options_of(options)?)?;
    let (py, scene) = (scene.py(), scene.get());
    let options: Options = scene.options.iter().cloned().chain(others).collect();
    ready(py, scene, Call::new(&scene.source, &options).map_err(value_error)?, None)
}

/// Renders a scene to an array of float32, (height, width, 3): linear Rec.709.
///
/// render(scene, **options): the scene is a Scene, or what load() takes, with the options for that.
/// The others are those of `raystream render`, by the same names with `_` for `-`, such as spp,
/// time, noise, size, seed, device, integrator, allocator, estimator, denoise; options() lists
/// them. By default 64 samples per pixel are spent, adaptively, on the best GPU or else on the CPU.
/// With `denoise` the picture is the filtered one.
///
/// The interpreter's lock is released; Ctrl-C ends the render with KeyboardInterrupt. Raises
/// ValueError, OSError, MemoryError and, where a device fails, RuntimeError.
#[pyfunction]
#[pyo3(signature = (scene, **options))]
pub fn render<'py>(
    scene: &Bound<'py, PyAny>,
    options: Option<&Bound<'py, PyDict>>,
) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
    let py = scene.py();
    let ready = ready_of(scene, options)?;
    let mut signals = Signals::of_one();
    let rendered = without_lock(py, || picture(ready, &mut signals))?;
    signals.raised()?;
    let (picture, shortcomings) = rendered;
    warn(py, &shortcomings)?;
    array(py, &picture, COLOR).ok_or_else(|| value_error("the picture has no colours"))
}

/// Renders to the end, or until a signal comes; returns what the picture lacks, too.
fn picture(
    mut ready: ReadyCall,
    signals: &mut Signals,
) -> Result<(LayeredImage, Vec<String>), CliError> {
    let (mut renderer, budget) = ready.begin()?;
    let outcome = run_watched(&mut renderer, budget, signals)?;
    renderer.finish_features()?;
    let noise = renderer.noise()?;
    let rendered = Rendered { film: renderer.film()?, outcome, noise, kept: Ok(()) };
    let lacks = rendered.shortcomings(ready.settings().sampling.noise);
    let lacks = lacks.iter().map(|what| in_keywords(what)).collect();
    Ok((LayeredImage::from_color(&ColorImage::from_film(&rendered.film)), lacks))
}
