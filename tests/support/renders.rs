//! Renders of a number of samples.

use raystream::exec::Executor;
use raystream::exec::cpu::CpuExecutor;
use raystream::film::Film;
use raystream::render::{
    BvhQuality, IntegratorKind, LightCacheSettings, PreparedScene, Renderer, Sampling, Settings,
    Techniques,
};
use raystream::scene::Scene;

/// Renders `samples` per pixel on `executor`.
pub fn render_on<E: Executor>(
    executor: &E,
    scene: &PreparedScene,
    settings: &Settings,
    samples: u32,
) -> Film {
    let mut renderer = Renderer::new(executor, scene, settings).expect("the scene fits");
    renderer.round(samples, &mut |_| ()).expect("the device works");
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
        size: scene.film,
        seed: 1,
        independent_sampler: true,
        max_depth: scene.limits.max_depth,
        roulette_depth: scene.limits.roulette_depth,
        techniques: Techniques::Both,
        ray_offset: raystream_shaders::scene::ray::OFFSET_ROUNDINGS,
        sampling: Sampling::UNIFORM,
        integrator: IntegratorKind::Megakernel,
        light_cache: LightCacheSettings::default(),
    }
}
