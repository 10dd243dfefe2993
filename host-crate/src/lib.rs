//! Raystream: an adaptive path tracer whose kernels are written once, in Rust, and run on the GPU
//! and on the CPU.
//!
//! - A [`Scene`](scene::Scene) is what there is to see: geometry, materials, a camera. A file says
//!   so, or code does.
//! - A [`PreparedScene`](struct@render::PreparedScene) is the same in the layout that kernels read,
//!   with the tree that rays are traced through.
//! - A [`Device`](exec::Device) runs kernels: a GPU or the CPU. Whatever does so is an
//!   [`Executor`](exec::Executor).
//! - [`Settings`](struct@render::Settings) say what a render computes: picture size, length of
//!   paths, integrator, and how samples are spread over the picture.
//! - A [`Renderer`](struct@render::Renderer) is a render under way: it owns its device and what the
//!   render has there.
//! - A [`Film`](film::Film) is what comes of it, for each pixel: radiance, its variance, features
//!   of the first surface, and estimates of the error.
//!
//! ```
//! use raystream::prelude::*;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let folder = tempfile::tempdir()?;
//! # let path = folder.path().join("cornell_ball.png");
//! let scene = scene::load_named("cornell_ball")?;
//! let settings = Settings {
//!     size: FilmSize::new(32, 32)?,
//!     ..Settings::for_scene(&scene)
//! };
//! let film = render(&scene, &settings, Budget::samples(8), Device::open("cpu")?)?;
//! image::write_film(&path, &film)?;
//! # assert!(path.is_file());
//! # Ok(())
//! # }
//! ```
//!
//! From a scene file to a picture: [`scene`] loads, [`exec`] runs kernels on a device,
//! [`render`](mod@render) is the loop that fills the [`film`], [`image`] writes it, [`denoise`]
//! filters what was written, [`film_file`] keeps a render for later. The kernels themselves are the
//! crate [`raystream_shaders`].

pub mod clock;
pub mod color;
pub mod denoise;
pub mod exec;
mod facade;
pub mod film;
pub mod film_file;
pub mod image;
pub mod names;
pub mod prelude;
pub mod render;
pub mod scene;

pub use facade::render;
