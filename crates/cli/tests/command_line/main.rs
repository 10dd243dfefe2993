//! The program as a user runs it, on the CPU with tiny pictures.

#![allow(clippy::expect_used, clippy::unwrap_used, reason = "what fails is a test")]

mod adaptive;
mod checkpoints;
mod commands;
mod comparing;
mod convergence;
mod denoise;
mod diff_devices;
mod environment;
mod integrators;
mod interrupt;
mod kills;
mod memory;
mod models;
mod oidn;
mod options;
mod outputs;
mod program;
mod renders;
mod scenes;
mod tev;
mod validation;
#[cfg(unix)]
mod view;
