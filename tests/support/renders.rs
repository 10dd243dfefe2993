//! Renders of a number of samples.

use raystream::exec::Executor;
use raystream::exec::cpu::CpuExecutor;
use raystream::film::Film;
use raystream::render::{BvhQuality, IntegratorKind, PreparedScene, Renderer, Sampling, Settings};
use raystream::scene::Scene;

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
    PreparedScene::new(scene, BvhQuality::Fast).expect("the scene is small")
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
