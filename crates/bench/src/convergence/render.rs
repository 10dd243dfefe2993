//! Renders whose errors are recorded on the way.

use super::curve::Point;
use super::errors::Errors;
use super::reference::Reference;
use super::rounds::Round;
use crate::BenchError;
use rayon::prelude::*;
use raystream::exec::{ExecError, Executor};
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

/// Renders to each of `checkpoints` (samples per pixel, rising) and records errors against
/// `reference`; also every round, if `with_rounds`. Only the rounds themselves count as time, with
/// the last step to the picture, and not the looking in between, which is no more than reading the
/// picture: a device that is left idle slows down.
///
/// A uniform render goes on from checkpoint to checkpoint. An adaptive one begins anew for each,
/// since what it does depends on what it may spend, after `keep_warm` has kept the device busy; the
/// rounds are those of the last. It ends early if no pixel wants samples any more.
pub fn record<E: Executor>(
    executor: &E,
    scene: &PreparedScene,
    settings: &Settings,
    checkpoints: &[u32],
    reference: &Reference,
    with_rounds: bool,
    keep_warm: &mut dyn FnMut() -> Result<(), ExecError>,
) -> Result<Recorded, BenchError> {
    let is_uniform = settings.sampling.allocator == AllocatorKind::Uniform;
    let mut recording = Recording::new(executor, scene, settings)?;
    let mut looks = Vec::new();
    for (&checkpoint, k) in checkpoints.iter().zip(0..) {
        if !is_uniform && k > 0 {
            recording = Recording::new(executor, scene, settings)?;
        }
        if !is_uniform || k == 0 {
            keep_warm()?;
        }
        let reached = recording.render_to(checkpoint, with_rounds)?;
        looks.push(recording.look(checkpoint)?);
        if !reached {
            break;
        }
    }
    let points = looks
        .par_iter()
        .map(|look| look.point(reference))
        .collect::<Result<Vec<_>, BenchError>>()?;
    let Some(&end) = points.last() else {
        return Err(BenchError::Wrong("the render took no samples".into()));
    };
    Ok(Recorded { points, end, rounds: recording.rounds, film: recording.renderer.film()? })
}

/// A render under way, and what it has taken so far.
struct Recording<'e, E: Executor> {
    renderer: Renderer<&'e E>,
    rounds: Vec<Round>,
    wall: Duration,
    device: Timings,
    rays: u64,
}

impl<'e, E: Executor> Recording<'e, E> {
    fn new(
        executor: &'e E,
        scene: &PreparedScene,
        settings: &Settings,
    ) -> Result<Self, BenchError> {
        Ok(Self {
            renderer: Renderer::new(executor, scene, settings)?,
            rounds: Vec::new(),
            wall: Duration::ZERO,
            device: Timings::default(),
            rays: 0,
        })
    }

    /// Renders on to so many samples per pixel; whether it got there.
    fn render_to(&mut self, samples: u32, with_rounds: bool) -> Result<bool, BenchError> {
        let goal = u64::from(samples) * u64::from(self.renderer.pixels());
        while self.renderer.paths() < goal {
            let before = self.renderer.paths();
            let start = Instant::now();
            let timings = self.renderer.step(goal - before)?;
            let elapsed = start.elapsed();
            self.wall += elapsed;
            self.device += timings;
            let paths = self.renderer.paths() - before;
            if paths == 0 {
                return Ok(false);
            }
            if with_rounds {
                let rays = self.renderer.rays()?;
                self.rounds.push(Round { paths, rays: rays - self.rays, timings, wall: elapsed });
                self.rays = rays;
            }
        }
        Ok(true)
    }

    /// Takes the last step to the picture as it is; the time with it, by wall and device.
    fn resolve(&self) -> Result<(Duration, Timings), BenchError> {
        let start = Instant::now();
        let mut device = self.device;
        device += self.renderer.resolve()?;
        Ok((self.wall + start.elapsed(), device))
    }

    /// The picture as it is.
    fn look(&mut self, checkpoint: u32) -> Result<Look, BenchError> {
        let (wall, device) = self.resolve()?;
        Ok(Look {
            image: ColorImage::from_film(&self.renderer.film()?),
            checkpoint,
            samples: self.renderer.paths() as f64 / f64::from(self.renderer.pixels()),
            wall,
            device,
            rays: self.renderer.rays()?,
        })
    }
}

/// Renders to `samples` per pixel, or as far as pixels want any, with the time that it took.
pub fn render_timed<E: Executor>(
    executor: &E,
    scene: &PreparedScene,
    settings: &Settings,
    samples: u32,
) -> Result<(Film, Duration), BenchError> {
    let mut recording = Recording::new(executor, scene, settings)?;
    recording.render_to(samples, false)?;
    let (wall, _) = recording.resolve()?;
    Ok((recording.renderer.film()?, wall))
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
