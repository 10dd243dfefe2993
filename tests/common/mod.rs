//! Scenes, devices and statistics that the tests share.
#![allow(dead_code)] // every test file uses a part

pub mod scenes;
pub mod slow;
pub mod statistics;

use raystream::exec::Executor;
use raystream::exec::cpu::CpuExecutor;
use raystream::exec::device::Device;
use raystream::exec::gpu::GpuExecutor;
use raystream::film::Film;
use raystream::render::{BvhQuality, IntegratorKind, PreparedScene, Renderer, Sampling, Settings};
use raystream::scene::Scene;
use std::path::PathBuf;
use std::sync::Mutex;

/// Set where a missing GPU must fail the tests instead of leaving some out.
const REQUIRE_GPU: &str = "RAYSTREAM_REQUIRE_GPU";

/// One test at a time on the GPU: a software one is slow, and a real one has only so much memory.
static GPU: Mutex<()> = Mutex::new(());

/// Runs `test` on any GPU, a software one too. Without one it says so loudly, or fails if
/// [`REQUIRE_GPU`] is set.
pub fn with_gpu(test: impl FnOnce(&GpuExecutor)) {
    let _turn = GPU.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    match Device::open("gpu") {
        Ok(Device::Gpu(gpu)) => test(&gpu),
        Ok(_) => unreachable!("the CPU is no GPU"),
        Err(error) => no_gpu(&error.to_string()),
    }
}

/// What a test that needs a GPU does without one.
pub fn no_gpu(reason: &str) {
    assert!(std::env::var_os(REQUIRE_GPU).is_none(), "{REQUIRE_GPU} is set, but {reason}");
    say_loudly(&format!(
        "no Vulkan device: {reason}. Install a driver (a software one: mesa-vulkan-drivers)."
    ));
}

/// Whether there is a GPU; says so loudly, or fails, if there is none.
pub fn has_gpu() -> bool {
    let mut found = false;
    with_gpu(|_| found = true);
    found
}

/// The folder with the large scenes and their references, beside the repository; says so loudly if
/// it is not there.
pub fn large_scenes() -> Option<PathBuf> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../shared/scenes");
    if folder.is_dir() {
        return Some(folder);
    }
    say_loudly(&format!("the large scenes and their references are not in {}", folder.display()));
    None
}

/// Says what is left out on the terminal itself: the test harness hides what passing tests print
/// the usual way.
fn say_loudly(what: &str) {
    use std::io::Write;
    let _ = writeln!(std::io::stderr(), "NOT TESTED: {what}");
}

/// Renders `samples` per pixel on `executor`.
pub fn render_on<E: Executor>(
    executor: &E,
    scene: &PreparedScene,
    settings: &Settings,
    samples: u32,
) -> Film {
    let mut renderer = Renderer::new(executor, scene, settings).expect("the scene fits");
    renderer.uniform_round(samples).finish().expect("the device works");
    renderer.finish_features().expect("the device works");
    renderer.film().expect("the device works")
}

/// Renders `samples` per pixel on the CPU.
pub fn render(scene: &PreparedScene, settings: &Settings, samples: u32) -> Film {
    render_on(&CpuExecutor, scene, settings, samples)
}

/// Builds the scene's BVH and lights.
pub fn prepare(scene: &Scene) -> PreparedScene {
    PreparedScene::new(scene.clone(), BvhQuality::Fast).expect("the scene is small")
}

/// The scene's own settings, with independent random numbers: then standard errors mean what they
/// say.
pub fn settings(scene: &Scene) -> Settings {
    Settings {
        seed: 1,
        independent_sampler: true,
        sampling: Sampling::UNIFORM,
        integrator: IntegratorKind::Megakernel,
        ..Settings::for_scene(scene)
    }
}
