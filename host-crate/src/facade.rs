//! A scene to a picture in one call.

use crate::exec::Executor;
use crate::film::Film;
use crate::render::{Budget, BvhQuality, PreparedScene, RenderError, Renderer, Settings, run::run};
use crate::scene::Scene;

/// Renders `scene` until `budget` is spent, or the noise of
/// [`Sampling::noise`](crate::render::Sampling::noise) is reached: without either it never ends.
///
/// `device` is a [`Device`](crate::exec::Device), or any other executor, or a reference to one. A
/// [`Renderer`] does the same in steps; see [`run`] for interruption and progress.
///
/// # Errors
/// If the device fails or has not enough memory, or the scene is too deep for the traversal.
pub fn render(
    scene: &Scene,
    settings: &Settings,
    budget: Budget,
    device: impl Executor,
) -> Result<Film, RenderError> {
    let prepared = PreparedScene::new(scene, BvhQuality::default())?;
    let mut renderer = Renderer::new(device, &prepared, settings)?;
    run(&mut renderer, budget, &|| false, &mut |_| ())?;
    renderer.finish_features()?;
    renderer.film()
}
