//! Speed of whole paths.

use super::{BenchError, WARM_UP};
use raystream::exec::Executor;
use raystream::render::{Budget, Outcome, PreparedScene, Renderer, Sampling, Settings, run};
use std::time::Duration;

/// The speed of a render.
#[derive(Clone, Copy, Debug)]
pub struct PathSpeed {
    /// Paths per second, in millions, by the clock on the wall.
    pub mpaths_per_second: f64,
    /// Rays per second, in millions, shadow rays included.
    pub mrays_per_second: f64,
    /// Rays of a path.
    pub rays_per_path: f64,
    /// The run: samples, and where the time went.
    pub outcome: Outcome,
    /// Mean radiance of the picture, over its three components.
    pub mean: f64,
    /// Standard error of the mean, by the differences of the picture's halves.
    pub mean_error: f64,
}

/// Renders for `time`, after a short run that warms up.
///
/// The result is checked: the picture's two independent halves must be finite and their means agree
/// within five standard errors of their difference.
pub fn measure<E: Executor>(
    executor: &E,
    scene: &PreparedScene,
    settings: &Settings,
    time: Duration,
) -> Result<PathSpeed, BenchError> {
    let sampling = Sampling { halves: true, ..settings.sampling };
    let mut renderer = Renderer::new(executor, scene, &Settings { sampling, ..*settings })?;
    let mut render =
        |time: Duration| run(&mut renderer, Budget::time(time), &|| false, &mut |_| ());
    render(WARM_UP)?;
    let outcome = render(time)?;
    let film = renderer.film()?;
    let [first, second] = film
        .halves()
        .ok_or_else(|| BenchError::Wrong("the render took no two samples of any pixel".into()))?
        .map(|half| half.iter().map(|c| f64::from(c.element_sum()) / 3.0).collect::<Vec<_>>());
    let pixels = first.len() as f64;
    let pairs = || first.iter().zip(&second);
    let mean = pairs().map(|(a, b)| (a + b) / 2.0).sum::<f64>() / pixels;
    let difference = pairs().map(|(a, b)| a - b).sum::<f64>() / pixels;
    let squares = pairs().map(|(a, b)| (a - b).powi(2)).sum::<f64>() / pixels;
    let error = ((squares - difference * difference).max(0.0) / pixels).sqrt();
    if !mean.is_finite() || difference.abs() > 5.0 * error + f64::EPSILON {
        return Err(BenchError::Wrong(format!(
            "the picture's halves differ by {difference:.3e}, its mean is {mean:.4}, the standard \
             error {error:.1e}"
        )));
    }
    let paths = outcome.paths as f64;
    let rays = outcome.rays as f64;
    let seconds = outcome.elapsed.as_secs_f64();
    Ok(PathSpeed {
        mpaths_per_second: paths / seconds / 1e6,
        mrays_per_second: rays / seconds / 1e6,
        rays_per_path: rays / paths,
        outcome,
        mean,
        mean_error: error / 2.0,
    })
}
