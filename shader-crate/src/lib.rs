//! Raystream's kernels.
//!
//! Every function here is compiled twice: to SPIR-V by rust-gpu and natively for the CPU. A kernel
//! is a plain function over slices and small `Copy` structs; [`kernels`] lists them all and makes
//! of each row of that list the GPU's entry point and (in the host crate) the native loop.
//!
//! Reading order, along one sample: [`film::stream`] (which pixel a slot traces),
//! [`integrator::path`] (the tracer), [`scene`] (what it hits: [`scene::bvh`], [`scene::bsdf`],
//! [`scene::light`]), and back into the [`film`]. Between rounds, an [`estimator`] says where the
//! film is wrong, and an [`allocator`] spends the next samples there. After the last of them a
//! [`reconstruction`] takes noise out of the picture.
#![no_std]
#![cfg_attr(target_arch = "spirv", feature(asm_experimental_arch))]

#[cfg(not(target_arch = "spirv"))]
extern crate std;

pub mod allocator;
pub mod estimator;
pub mod film;
pub mod integrator;
pub mod kernels;
#[cfg(not(target_arch = "spirv"))]
pub mod levels;
pub mod math;
pub mod memory;
pub mod parallel;
pub mod probe;
pub mod reconstruction;
pub mod scene;

pub use spirv_std::glam;
