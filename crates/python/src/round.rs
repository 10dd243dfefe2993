//! A round of a render, as Python sees it.

use crate::layers::{COLOR, array, dictionary, names};
use crate::renderer::{Numbers, Renderer};
use numpy::PyArrayDyn;
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use raystream::image::LayeredImage;

/// A round of a render, with the picture as it is after it.
///
/// `round["albedo"]` is a layer, a float32 array of shape (height, width) or (height, width, 3);
/// `names` are those that there are, as in an EXR (docs/LAYERS.md). They can be looked at until the
/// next round begins: after that, RuntimeError. Whoever never looks pays nothing.
#[pyclass(frozen, mapping, module = "raystream")]
pub struct Round {
    pub renderer: Py<Renderer>,
    pub numbers: Numbers,
}

#[pymethods]
impl Round {
    /// Which round of its Renderer it is, from 1.
    #[getter]
    fn number(&self) -> u32 {
        self.numbers.number
    }

    /// Samples per pixel so far, on average over the pixels; those of earlier runs included.
    #[getter]
    fn samples(&self) -> f64 {
        self.numbers.samples
    }

    /// Seconds that the rounds of this Renderer have taken.
    #[getter]
    fn seconds(&self) -> f64 {
        self.numbers.seconds
    }

    /// Rays traced so far.
    #[getter]
    fn rays(&self) -> u64 {
        self.numbers.rays
    }

    /// The picture's estimated relative error (0.02 is 2 %): with `denoise`, of the filtered one.
    /// None where errors are not estimated.
    #[getter]
    fn error(&self, py: Python<'_>) -> PyResult<Option<f64>> {
        Ok(self.renderer.get().look(py, self.numbers.number)?.error)
    }

    /// The picture: the layer "color".
    #[getter]
    fn image<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        self.__getitem__(py, COLOR)
    }

    /// The filtered picture: the layer "denoised", or None without the option `denoise`.
    #[getter]
    fn denoised<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArrayDyn<f32>>>> {
        let looked = self.renderer.get().look(py, self.numbers.number)?;
        Ok(array(py, &looked.layers, "denoised"))
    }

    /// The names of the layers.
    #[getter]
    fn names(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        Ok(names(&self.renderer.get().look(py, self.numbers.number)?.layers))
    }

    /// All layers by their names, as write() takes them.
    fn layers<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        dictionary(py, &self.renderer.get().look(py, self.numbers.number)?.layers)
    }

    fn __getitem__<'py>(
        &self,
        py: Python<'py>,
        name: &str,
    ) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        layer(py, &self.renderer.get().look(py, self.numbers.number)?.layers, name)
    }

    fn __contains__(&self, py: Python<'_>, name: &str) -> PyResult<bool> {
        Ok(self.names(py)?.iter().any(|known| known == name))
    }

    fn __repr__(&self) -> String {
        let Numbers { number, samples, seconds, .. } = self.numbers;
        format!("<raystream.Round {number}: {samples:.2} samples per pixel in {seconds:.2} s>")
    }
}

/// A layer of a picture.
///
/// # Errors
/// KeyError, if there is no such layer.
pub fn layer<'py>(
    py: Python<'py>,
    image: &LayeredImage,
    name: &str,
) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
    array(py, image, name).ok_or_else(|| {
        let known = names(image).join(", ");
        PyKeyError::new_err(format!("there is no layer '{name}'; there are: {known}"))
    })
}
