//! Raystream: an adaptive path tracer whose kernels are written once, in Rust, and run on the GPU
//! and on the CPU.
//!
//! From a scene file to a picture: [`scene`] loads, [`exec`] runs kernels on a device, [`render`]
//! is the loop that fills the [`film`], [`image`] writes it. The kernels themselves are the crate
//! [`raystream_shaders`].

pub mod color;
pub mod exec;
pub mod film;
pub mod image;
pub mod names;
pub mod render;
pub mod scene;
