//! Devices, and the kernels that they are given.

mod exact;
mod gpu;
mod mutations;
mod shaders;
mod tables;
mod uniformity;
mod wgsl;
