//! Renders whose errors are recorded on the way.

use super::curve::Point;
use super::errors::Errors;
use super::reference::Reference;
use super::rounds::Round;
use crate::BenchError;
use rayon::prelude::*;
use raystream::exec::Executor;
use raystream::film::Film;
use raystream::image::ColorImage;
use raystream::render::{AllocatorKind, PreparedScene, Renderer, Settings, Timings};
use std::time::{Duration, Instant};

/// A render from its first sample to the last checkpoint.
pub struct Recorded {
    /// What was measured at the checkpoints that a round passed.
    pub points: Vec<Point>,
    /// The last of these.
    pub end: Point,
    /// Every round, if that was wanted.
    pub rounds: Vec<Round>,
    /// The film at the end.
    pub film: Film,
}

/// Has `renderer`, which has rendered nothing yet, render to the last of `checkpoints` (samples per
/// pixel, rising) and records errors against `reference`; also every round, if `with_rounds`. Only
/// the rounds themselves count as time, not the looking in between, and that is no more than
/// reading the picture: a device that is left idle slows down.
///
/// A uniform render stops at every checkpoint, an adaptive one takes its rounds as they come: what
/// a round passes is measured after it. It ends early if no pixel wants samples any more.
pub fn record<E: Executor>(
    renderer: &mut Renderer<E>,
    settings: &Settings,
    checkpoints: &[u32],
    reference: &Reference,
    with_rounds: bool,
) -> Result<Recorded, BenchError> {
    let pixels = u64::from(renderer.pixels());
    let uniform = settings.sampling.allocator == AllocatorKind::Uniform;
    let (mut wall, mut device) = (Duration::ZERO, Timings::default());
    let (mut looks, mut rounds) = (Vec::new(), Vec::new());
    let mut rays = 0;
    let mut next = 0;
    while let Some(&checkpoint) = checkpoints.get(next) {
        let before = renderer.paths();
        let paths_left = if uniform { u64::from(checkpoint) * pixels - before } else { u64::MAX };
        let start = Instant::now();
        let timings = renderer.step(paths_left)?;
        let elapsed = start.elapsed();
        wall += elapsed;
        device += timings;
        let paths = renderer.paths();
        if paths == before {
            break;
        }
        if with_rounds {
            let total = renderer.rays()?;
            rounds.push(Round {
                paths: paths - before,
                rays: total - rays,
                timings,
                wall: elapsed,
            });
            rays = total;
        }
        let passed = checkpoints.partition_point(|&c| u64::from(c) * pixels <= paths);
        if passed > next {
            next = passed;
            looks.push(Look {
                image: ColorImage::from_film(&renderer.film()?),
                checkpoint: checkpoints[passed - 1],
                samples: paths as f64 / pixels as f64,
                wall,
                device,
                rays: renderer.rays()?,
            });
        }
    }
    let points = looks
        .par_iter()
        .map(|look| look.point(reference))
        .collect::<Result<Vec<_>, BenchError>>()?;
    let Some(&end) = points.last() else {
        return Err(BenchError::Wrong("the render took no samples".into()));
    };
    Ok(Recorded { points, end, rounds, film: renderer.film()? })
}

/// What was seen of a render on the way.
struct Look {
    image: ColorImage,
    checkpoint: u32,
    samples: f64,
    wall: Duration,
    device: Timings,
    rays: u64,
}

impl Look {
    fn point(&self, reference: &Reference) -> Result<Point, BenchError> {
        let Self { checkpoint, samples, wall, device, rays, .. } = *self;
        Ok(Point {
            checkpoint,
            samples,
            wall,
            device,
            rays,
            errors: Errors::of(&self.image, &reference.image)?,
        })
    }
}

/// A few short rounds, so that what happens once (compiling kernels, memory) happens before
/// anything is measured.
pub fn rehearse<E: Executor>(
    executor: &E,
    scene: &PreparedScene,
    settings: &Settings,
) -> Result<(), BenchError> {
    let mut renderer = Renderer::new(executor, scene, settings)?;
    let paths = 2 * u64::from(renderer.pixels());
    for _ in 0..3 {
        renderer.step(paths)?;
    }
    renderer.film()?;
    Ok(())
}

/// Share of the samples that may be missing from a render to a given count: an allocator that hits
/// its number only on average would otherwise end with ever smaller rounds.
const MISSING: f64 = 0.01;

/// Renders until there are about `samples` per pixel.
pub fn render_to<E: Executor>(
    executor: &E,
    scene: &PreparedScene,
    settings: &Settings,
    samples: f64,
) -> Result<Film, BenchError> {
    let mut renderer = Renderer::new(executor, scene, settings)?;
    let pixels = u64::from(renderer.pixels());
    let goal = ((samples * pixels as f64).round() as u64).max(pixels);
    loop {
        let before = renderer.paths();
        let missing = goal.saturating_sub(before);
        if missing as f64 <= MISSING * goal as f64 {
            return Ok(renderer.film()?);
        }
        renderer.step(missing)?;
        if renderer.paths() == before {
            return Ok(renderer.film()?);
        }
    }
}
