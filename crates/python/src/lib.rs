//! Raystream as a Python package: what `raystream/__init__.py` takes from Rust.
//!
//! Options are those of the command line, read by the same parser
//! ([`raystream_cli::call_options`]). Everything that takes long is done without the interpreter's
//! lock, and signals are looked at meanwhile.

mod devices;
mod errors;
mod film;
mod layers;
mod options;
mod pictures;
mod render;
mod renderer;
mod round;
mod said;
mod scene;
mod watch;

use pyo3::prelude::*;

/// The part of the package that is in Rust.
#[pymodule]
fn _raystream(module: &Bound<'_, PyModule>) -> PyResult<()> {
    said::listen();
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<scene::Scene>()?;
    module.add_class::<renderer::Renderer>()?;
    module.add_class::<round::Round>()?;
    module.add_class::<film::Film>()?;
    module.add_function(wrap_pyfunction!(scene::load, module)?)?;
    module.add_function(wrap_pyfunction!(render::render, module)?)?;
    module.add_function(wrap_pyfunction!(renderer::resume, module)?)?;
    module.add_function(wrap_pyfunction!(film::merge, module)?)?;
    module.add_function(wrap_pyfunction!(pictures::read, module)?)?;
    module.add_function(wrap_pyfunction!(pictures::write, module)?)?;
    module.add_function(wrap_pyfunction!(devices::devices, module)?)?;
    module.add_function(wrap_pyfunction!(scene::scenes, module)?)?;
    module.add_function(wrap_pyfunction!(options::options, module)?)
}
