//! Devices, and the kernels that they are given.

mod exact;
mod gpu;
mod shaders;
mod uniformity;
mod wgsl;
