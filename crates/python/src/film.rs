//! Film files as Python sees them.

use crate::errors::{python_error, value_error, without_lock};
use crate::layers::{COLOR, dictionary, names};
use crate::round::layer;
use crate::said::warn;
use numpy::PyArrayDyn;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use raystream::exec::Device;
use raystream::film_file::FilmFile;
use raystream::image::LayeredImage;
use raystream::render::FilterKind;
use raystream_cli::merged;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// A render in a film file: what Renderer.save() and `raystream render --checkpoint` write.
///
/// Film(path) reads one; merge() makes one of parts. `film["color"]` is a layer, as of a Round, but
/// for those of estimated errors, which are not in it.
#[pyclass(frozen, mapping, module = "raystream")]
pub struct Film {
    file: FilmFile,
    layers: OnceLock<LayeredImage>,
}

impl Film {
    fn of(file: FilmFile) -> Self {
        Self { file, layers: OnceLock::new() }
    }

    fn look(&self, py: Python<'_>) -> PyResult<&LayeredImage> {
        if let Some(layers) = self.layers.get() {
            return Ok(layers);
        }
        let layers = self.layers_with(py, "cpu", None)?;
        Ok(self.layers.get_or_init(|| layers))
    }

    fn layers_with(
        &self,
        py: Python<'_>,
        device: &str,
        filter: Option<FilterKind>,
    ) -> PyResult<LayeredImage> {
        let layers = without_lock(py, || {
            let device = Device::open(device)?;
            let film = self.file.film(&device, filter)?;
            Ok(LayeredImage::from_film(Path::new("the film"), &film)?)
        });
        warn(py, &[])?;
        layers
    }
}

#[pymethods]
impl Film {
    #[new]
    fn new(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        Ok(Self::of(without_lock(py, || Ok(FilmFile::read(&path)?))?))
    }

    /// Writes it to a film file.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        without_lock(py, || Ok(self.file.write(&path)?))
    }

    /// What its scene is called.
    #[getter]
    fn scene(&self) -> &str {
        &self.file.header.scene
    }

    /// Width and height of the picture in pixels.
    #[getter]
    fn size(&self) -> (u32, u32) {
        (self.file.checkpoint.size.width, self.file.checkpoint.size.height)
    }

    /// Samples per pixel, on average over the pixels.
    #[getter]
    fn samples(&self) -> f64 {
        let (width, height) = self.size();
        self.file.checkpoint.progress.paths as f64 / (f64::from(width) * f64::from(height))
    }

    /// Seconds that it took.
    #[getter]
    fn seconds(&self) -> f64 {
        self.file.header.seconds
    }

    /// The parts of the render that it has, such as ["0/4", "2/4"]; none where it is of a whole
    /// one.
    #[getter]
    fn parts(&self) -> Vec<String> {
        self.file.header.own_parts().map(|part| part.to_string()).collect()
    }

    /// The picture: the layer "color".
    #[getter]
    fn image<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        self.__getitem__(py, COLOR)
    }

    /// The names of the layers.
    #[getter]
    fn names(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        Ok(names(self.look(py)?))
    }

    /// All layers by their names; with `denoise`, the name of a filter, that of the filtered
    /// picture, too, which takes samples in halves.
    #[pyo3(signature = (*, denoise = None, device = "cpu"))]
    fn layers<'py>(
        &self,
        py: Python<'py>,
        denoise: Option<&str>,
        device: &str,
    ) -> PyResult<Bound<'py, PyDict>> {
        let Some(filter) = denoise else { return dictionary(py, self.look(py)?) };
        let filter = filter.parse::<FilterKind>().map_err(|error| python_error(&error))?;
        if self.file.checkpoint.radiance.iter().all(|pixel| pixel.second_samples == 0) {
            return Err(value_error(
                "denoise: needs samples in halves, which the film has not; begin the render with \
                 denoise or halves",
            ));
        }
        dictionary(py, &self.layers_with(py, device, Some(filter))?)
    }

    fn __getitem__<'py>(
        &self,
        py: Python<'py>,
        name: &str,
    ) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        layer(py, self.look(py)?, name)
    }

    fn __contains__(&self, py: Python<'_>, name: &str) -> PyResult<bool> {
        Ok(self.names(py)?.iter().any(|known| known == name))
    }

    fn __repr__(&self) -> String {
        let (width, height) = self.size();
        let scene = &self.file.header.scene;
        format!("<raystream.Film of '{scene}': {width}x{height}, {:.2} samples>", self.samples())
    }
}

/// Adds up the films of parts of one render, in any order; warns where some are missing.
///
/// merge(films): paths of film files of renders with the option `part`, such as part="0/4". Returns
/// a Film. Raises ValueError if they do not go together.
#[pyfunction]
pub fn merge(py: Python<'_>, films: Vec<PathBuf>) -> PyResult<Film> {
    let (file, warning) = without_lock(py, || Ok(merged(&films)?))?;
    warn(py, warning.as_slice())?;
    Ok(Film::of(file))
}
