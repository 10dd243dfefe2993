//! The tests that need the library alone, by the folders that kernels lie in.

mod allocator;
mod estimator;
mod exec;
mod film;
mod image;
mod integrator;
mod math;
mod parallel;
mod render;
mod scene;
