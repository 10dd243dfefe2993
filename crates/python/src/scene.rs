//! Scenes: loaded from files, or made of arrays.

use crate::errors::{python_error, value_error, without_lock};
use crate::options::{Options, options_of, path_text, split};
use crate::said::warn;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use raystream::render::PreparedScene;
use raystream::scene::{LoadOptions, SceneError, shipped};
use raystream_cli::{Call, CliError};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// What stands for the file of a scene that is none.
pub const OF_ARRAYS: &str = "<scene>";

/// A scene: loaded by load(), or made of arrays.
///
/// Scene(*, camera, size=(800, 600), meshes=(), materials=None, lights=(), environment=None,
/// background=None, max_depth=None, rr_depth=None, name="scene")
///
/// All but `meshes`, `size` and `lights` are what they are in scene files (docs/SCENE_FORMAT.md):
/// dictionaries with those keys, such as Camera, PointLight and the materials make; `lights` may be
/// Quads, too. Raises ValueError, which names the part that is wrong.
#[pyclass(frozen, module = "raystream")]
pub struct Scene {
    pub scene: raystream::scene::Scene,
    /// The file or name that it was loaded by.
    pub source: String,
    /// How it was loaded.
    pub options: Options,
    /// What was built of it last, and how carefully.
    prepared: Mutex<Option<(&'static str, Arc<PreparedScene>)>>,
}

impl Scene {
    fn new(scene: raystream::scene::Scene, source: String, options: Options) -> Self {
        Self { scene, source, options, prepared: Mutex::default() }
    }

    /// Loads what a call asks for.
    pub fn of_call(call: &Call, options: Options) -> Result<Self, SceneError> {
        let source = call.scene().to_string_lossy().into_owned();
        Ok(Self::new(call.load()?, source, options))
    }

    /// What devices take of it, built once; and what it lacks, said once.
    pub fn prepare(&self, call: &Call) -> Result<(Arc<PreparedScene>, Vec<String>), CliError> {
        let mut prepared = self.prepared.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((hierarchy, prepared)) = &*prepared
            && *hierarchy == call.hierarchy()
        {
            return Ok((Arc::clone(prepared), Vec::new()));
        }
        let built = Arc::new(call.prepare(&self.scene)?);
        *prepared = Some((call.hierarchy(), Arc::clone(&built)));
        let name = &self.scene.name;
        let warnings = built.warnings().iter().map(|what| format!("{name}: {what}")).collect();
        Ok((built, warnings))
    }
}

#[pymethods]
impl Scene {
    #[new]
    #[pyo3(signature = (**parts))]
    fn of_parts(py: Python<'_>, parts: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let describe = py.import("raystream._parts")?.getattr("describe")?;
        let (json, meshes): (String, BTreeMap<String, Py<PyBytes>>) =
            describe.call((), parts)?.extract()?;
        let bytes = |(name, bytes): (String, Py<PyBytes>)| {
            (PathBuf::from(name), bytes.as_bytes(py).to_vec())
        };
        let mut files: BTreeMap<PathBuf, Vec<u8>> = meshes.into_iter().map(bytes).collect();
        files.insert(OF_ARRAYS.into(), json.into_bytes());
        let options = LoadOptions { max_memory: u64::MAX, ..LoadOptions::default() };
        let loaded = py.detach(|| options.load_files_over_disk(&files, Path::new(OF_ARRAYS)));
        let scene = loaded.map_err(|error| of_arrays(&error))?;
        warn(py, &scene.warnings)?;
        Ok(Self::new(scene, OF_ARRAYS.to_owned(), Options::new()))
    }

    /// What the scene is called.
    #[getter]
    fn name(&self) -> &str {
        &self.scene.name
    }

    /// Width and height of its picture in pixels.
    #[getter]
    fn size(&self) -> (u32, u32) {
        (self.scene.film.width, self.scene.film.height)
    }

    /// How many triangles it has.
    #[getter]
    fn triangles(&self) -> usize {
        self.scene.triangle_count()
    }

    /// What the picture will not show, a sentence each.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.scene.warnings.clone()
    }

    /// Each thing that the picture will not show: what `warnings` sum up.
    #[getter]
    fn details(&self) -> Vec<String> {
        self.scene.details.clone()
    }

    /// The names of its cameras; load(camera=...) takes one.
    #[getter]
    fn cameras(&self) -> Vec<String> {
        self.scene.cameras.iter().map(|camera| camera.name.clone()).collect()
    }

    /// The names of the variants of its materials; load(variant=...) takes one.
    #[getter]
    fn variants(&self) -> Vec<String> {
        self.scene.variants.clone()
    }

    fn __repr__(&self) -> String {
        let (width, height) = self.size();
        format!(
            "<raystream.Scene '{}': {} triangles, {width}x{height} pixels>",
            self.scene.name,
            self.scene.triangle_count()
        )
    }
}

/// The error of a scene that has neither file nor lines.
fn of_arrays(error: &SceneError) -> PyErr {
    match error {
        SceneError::Json { key, source, .. } => {
            let said = source.to_string();
            let what = said.split_once(" at line ").map_or(said.as_str(), |(what, _)| what);
            let key = if key.is_empty() { String::new() } else { format!("{key}: ") };
            value_error(format!("{key}{what}"))
        }
        _ => python_error(error),
    }
}

/// A scene as an argument: one that is there, or a file or name that is loaded with the options
/// for that. Returns what is left of the options.
pub fn scene_of<'py>(
    scene: &Bound<'py, PyAny>,
    options: Options,
) -> PyResult<(Bound<'py, Scene>, Options)> {
    let (loading, others) = split(options);
    let Ok(loaded) = scene.cast::<Scene>() else {
        return Ok((Bound::new(scene.py(), load_with(scene, loading)?)?, others));
    };
    match loading.first() {
        Some((name, _)) => Err(value_error(format!(
            "{name}: is an option of load(), and the scene is loaded already; give it there"
        ))),
        None => Ok((loaded.clone(), others)),
    }
}

fn load_with(scene: &Bound<'_, PyAny>, options: Options) -> PyResult<Scene> {
    let py = scene.py();
    let source = path_text("scene", scene)?;
    let call = Call::new(&source, &options).map_err(value_error)?;
    let scene = without_lock(py, || Ok(Scene::of_call(&call, options)?))?;
    warn(py, &scene.scene.warnings)?;
    Ok(scene)
}

/// Loads a scene: a scene file, a glTF (.gltf, .glb), an OBJ, a PLY, or one that ships, by name.
///
/// load(scene, **options): the options that `raystream render` has for that, by the same names with
/// `_` for `-`; options() lists them. What the picture will not show is warned of. Raises
/// FileNotFoundError, another OSError or ValueError, which name the file and the place in it.
#[pyfunction]
#[pyo3(signature = (scene, **options))]
pub fn load(scene: &Bound<'_, PyAny>, options: Option<&Bound<'_, PyDict>>) -> PyResult<Scene> {
    let options = options_of(options)?;
    let (loading, others) = split(options);
    if let Some((name, _)) = others.first() {
        let known = raystream_cli::call_options();
        if known.iter().any(|option| option.name == *name) {
            let what = "is an option of render() and Renderer(), and says nothing of loading";
            return Err(value_error(format!("{name}: {what}")));
        }
        let loads = known.into_iter().filter(|option| option.loads);
        let mut names: Vec<String> = loads.map(|option| option.name).collect();
        names.sort_unstable();
        let names = names.join(", ");
        return Err(value_error(format!("there is no option '{name}'; there are: {names}")));
    }
    load_with(scene, loading)
}

/// The scenes that ship: what there is to see, by their names.
#[pyfunction]
pub fn scenes(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let scenes = PyDict::new(py);
    for scene in shipped() {
        scenes.set_item(scene.name, scene.description)?;
    }
    Ok(scenes)
}
