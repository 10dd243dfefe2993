//! Devices, and the kernels that they are given.

mod gpu;
mod shaders;
mod uniformity;
mod wgsl;
