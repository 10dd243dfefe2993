//! Executors: what runs kernels.

pub mod kernels;
