//! How kernels reach memory: buffers, rows of sixteen bytes, structs that cross from the host.

pub mod access;
mod device_struct;
pub mod rows;
pub mod soa;

pub(crate) use device_struct::device_struct;
