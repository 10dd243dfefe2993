//! A render in rounds.

use crate::errors::{value_error, without_lock};
use crate::options::{Options, options_of, path_text};
use crate::render::{ready, ready_of};
use crate::round::Round;
use crate::said::warn;
use crate::scene::{OF_ARRAYS, Scene};
use crate::watch::Signals;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use raystream::film_file::FilmFile;
use raystream::image::LayeredImage;
use raystream::render::{Run, Stop};
use raystream_cli::{Call, CliError, ReadyCall};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// A render under way: an iterator of its rounds.
///
/// Renderer(scene, **options): arguments as of render(). Each round is a Round, whose layers and
/// error can be looked at until the next one begins; those of the last one, always. The time of the
/// option `time` runs in rounds only. Ctrl-C ends a round with KeyboardInterrupt, as soon as
/// nothing is lost, and the render may be saved, or go on.
#[pyclass(frozen, module = "raystream")]
pub struct Renderer {
    state: Mutex<State>,
    size: (u32, u32),
    device: String,
}

/// All that changes.
struct State {
    ready: ReadyCall,
    renderer: raystream::render::Renderer,
    run: Run,
    /// What has ended it.
    stop: Option<Stop>,
    /// Rounds of this renderer so far.
    rounds: u32,
    /// The picture of that many rounds.
    looked_at: Option<(u32, Looked)>,
}

/// What there is to see of a render.
#[derive(Clone)]
pub struct Looked {
    /// All layers.
    pub layers: Arc<LayeredImage>,
    /// The picture's estimated relative error, where errors are estimated.
    pub error: Option<f64>,
}

/// Numbers of a round.
pub struct Numbers {
    /// Which one it is, from 1.
    pub number: u32,
    /// Samples per pixel in all.
    pub samples: f64,
    /// Seconds of all rounds.
    pub seconds: f64,
    /// Rays in all.
    pub rays: u64,
}

impl Renderer {
    fn begin(py: Python<'_>, mut ready: ReadyCall) -> PyResult<Self> {
        let before = ready.warnings().len();
        let (renderer, run, ready) = without_lock(py, move || {
            let (renderer, budget) = ready.begin()?;
            let run = Run::start(&renderer, budget)?;
            Ok((renderer, run, ready))
        })?;
        warn(py, &ready.warnings()[before..])?;
        let size = ready.settings().size;
        let device = ready.device().description();
        let state = State { ready, renderer, run, stop: None, rounds: 0, looked_at: None };
        Ok(Self { state: Mutex::new(state), size: (size.width, size.height), device })
    }

    /// Never asked for by who has the interpreter's lock: another thread may have this one, and
    /// want that.
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The picture after this many rounds, unless it is gone.
    pub fn look(&self, py: Python<'_>, rounds: u32) -> PyResult<Looked> {
        let looked = without_lock(py, || self.state().look(rounds))?;
        warn(py, &[])?;
        looked.ok_or_else(|| {
            PyRuntimeError::new_err(format!(
                "round {rounds} is over: look at its layers and its error before the next one"
            ))
        })
    }
}

impl State {
    /// Renders a round; none if there is none left, or if a signal came before it.
    fn next(&mut self, signals: &mut Signals) -> Result<Option<Numbers>, CliError> {
        if self.stop.is_some() {
            return Ok(None);
        }
        let before = self.renderer.paths();
        let stop = self.run.round(&mut self.renderer, signals)?;
        if self.renderer.paths() == before {
            self.stop = stop.filter(|stop| *stop != Stop::Interrupted);
            return Ok(None);
        }
        self.rounds += 1;
        self.looked_at = None;
        self.stop = match stop {
            Some(Stop::Interrupted) => None,
            Some(stop) => Some(stop),
            None => self.run.ended(&mut self.renderer)?,
        };
        Ok(Some(self.numbers()?))
    }

    fn numbers(&self) -> Result<Numbers, CliError> {
        Ok(Numbers {
            number: self.rounds,
            samples: self.renderer.paths() as f64 / f64::from(self.renderer.pixels()),
            seconds: self.seconds(),
            rays: self.renderer.rays()?,
        })
    }

    fn seconds(&self) -> f64 {
        self.run.elapsed().as_secs_f64()
    }

    fn look(&mut self, rounds: u32) -> Result<Option<Looked>, CliError> {
        if self.rounds != rounds {
            return Ok(None);
        }
        if let Some((_, looked)) = &self.looked_at {
            return Ok(Some(looked.clone()));
        }
        // Features get what a finished picture deserves, and rounds to come must not see that.
        let kept = if self.stop.is_some() { Some(self.renderer.checkpoint()?) } else { None };
        if kept.is_some() {
            self.renderer.finish_features()?;
        }
        let noise = self.renderer.noise()?;
        let film = self.renderer.film()?;
        if let Some(kept) = kept {
            self.renderer.restore(&kept)?;
        }
        let layers = Arc::new(LayeredImage::from_film(Path::new("the picture"), &film)?);
        let looked = Looked { layers, error: noise.map(|noise| noise.relative_error) };
        self.looked_at = Some((rounds, looked.clone()));
        Ok(Some(looked))
    }

    fn save(&self, path: &Path) -> Result<(), CliError> {
        let header = self.ready.header(self.seconds())?;
        let file = FilmFile { header, checkpoint: self.renderer.checkpoint()? };
        Ok(file.write(path)?)
    }
}

#[pymethods]
impl Renderer {
    #[new]
    #[pyo3(signature = (scene, **options))]
    fn new(scene: &Bound<'_, PyAny>, options: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        Self::begin(scene.py(), ready_of(scene, options)?)
    }

    fn __iter__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    fn __next__(slf: Py<Self>, py: Python<'_>) -> PyResult<Option<Round>> {
        let mut signals = Signals::of_round();
        let this = slf.get();
        let next = without_lock(py, || this.state().next(&mut signals))?;
        warn(py, &[])?;
        signals.raised()?;
        Ok(next.map(|numbers| Round { renderer: slf, numbers }))
    }

    /// Writes the render to a film file, with which resume() and `raystream resume` go on.
    ///
    /// Between rounds that is all of it: a render that goes on makes the picture, bit for bit, that
    /// it would have made without a break.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        without_lock(py, || self.state().save(&path))
    }

    /// Width and height of the picture in pixels.
    #[getter]
    fn size(&self) -> (u32, u32) {
        self.size
    }

    /// The device that has the film.
    #[getter]
    fn device(&self) -> &str {
        &self.device
    }

    /// What has ended the render: "samples", "time" or "noise"; None while there are rounds left.
    #[getter]
    fn stop(&self, py: Python<'_>) -> Option<&'static str> {
        let stop = py.detach(|| self.state().stop);
        stop.map(|stop| match stop {
            Stop::Samples => "samples",
            Stop::Time => "time",
            Stop::Noise => "noise",
            Stop::Interrupted => "interrupted",
        })
    }

    fn __repr__(&self) -> String {
        let (width, height) = self.size;
        format!("<raystream.Renderer: {width}x{height} pixels, on {}>", self.device)
    }
}

/// Goes on with a render that was kept in a film file, here or by `raystream render --checkpoint`.
///
/// resume(film, *, scene=None, spp=None, time=None, noise=None, device=None): returns a Renderer.
/// `spp` counts the samples that the film has, `time` begins anew; without spp, time and noise the
/// render ends where it was to end. A scene that was made of arrays is not in the film: give the
/// same one. Raises ValueError if the scene or its files have changed.
#[pyfunction]
#[pyo3(signature = (film, *, scene = None, **options))]
pub fn resume(
    film: &Bound<'_, PyAny>,
    scene: Option<Bound<'_, Scene>>,
    options: Option<&Bound<'_, PyDict>>,
) -> PyResult<Renderer> {
    let py = film.py();
    let path = PathBuf::from(path_text("film", film)?);
    let options: Options = options_of(options)?;
    let file = without_lock(py, || Ok(FilmFile::read(&path)?))?;
    let call = Call::resume(&file, &options).map_err(value_error)?;
    let scene = match scene {
        Some(scene) => scene,
        None if call.scene().ends_with(OF_ARRAYS) => {
            let path = path.display();
            return Err(value_error(format!(
                "{path}: is of a scene made of arrays, which is not in it; give that one (scene=)"
            )));
        }
        None => {
            let loaded = without_lock(py, || Ok(Scene::of_call(&call, Options::new())?))?;
            warn(py, &loaded.scene.warnings)?;
            Bound::new(py, loaded)?
        }
    };
    Renderer::begin(py, ready(py, scene.get(), call, Some((path, file)))?)
}
