//! What the tests share: scenes, devices, renders and statistics.

#![allow(
    clippy::expect_used,
    clippy::unwrap_used,
    reason = "the tests that call it should fail where it does"
)]

pub mod cameras;
pub mod devices;
pub mod draco;
pub mod executors;
pub mod fuzz;
pub mod gltf;
pub mod histogram;
pub mod large_scenes;
pub mod materials;
pub mod meshopt;
pub mod renders;
pub mod run;
pub mod scene_folder;
pub mod scenes;
pub mod statistics;

pub use devices::{cpus, has_gpu, no_gpu, with_exact_gpu, with_gpu};
pub use large_scenes::large_scenes;
pub use renders::{prepare, render, render_on, settings};
pub use run::Run;

/// Says what is left out on the terminal itself: the test harness hides what passing tests print
/// the usual way.
pub fn not_tested(what: &str) {
    use std::io::Write;
    let _ = writeln!(std::io::stderr(), "NOT TESTED: {what}");
}
