//! The tests that need the library alone, by the folders that kernels lie in.

#![allow(clippy::expect_used, clippy::unwrap_used, reason = "what fails is a test")]

mod allocator;
mod estimator;
mod exec;
mod film;
mod fuzz;
mod image;
mod integrator;
mod math;
mod parallel;
mod reconstruction;
mod render;
mod scene;
