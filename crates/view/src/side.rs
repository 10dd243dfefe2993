//! One render among those beside each other: its rounds, its clock, its pictures.

use crate::choices::Stops;
use crate::curve::relative_error;
use crate::news::Status;
use rayon::prelude::*;
use raystream::clock::Instant;
use raystream::exec::{Device, Executor};
use raystream::film::Film;
use raystream::render::{PreparedScene, RenderError, Renderer, Settings, Stop};
use raystream_figures::Pace;
use std::sync::Arc;
use std::time::Duration;

/// Rendering between two pictures, at least.
const SHORTEST: Duration = Duration::from_millis(100);

/// One render.
pub struct Side<E: Executor = Device> {
    renderer: Renderer<E>,
    pace: Pace,
    /// How many paths the last round was given, if it was left before its end: the next one goes on
    /// with it.
    left: Option<u64>,
    time: Duration,
    stop: Option<Stop>,
}

impl<E: Executor> Side<E> {
    /// A render that has not begun.
    ///
    /// # Errors
    /// If the device has no room for it.
    pub fn new(device: E, scene: &PreparedScene, settings: &Settings) -> Result<Self, RenderError> {
        Ok(Self {
            renderer: Renderer::new(device, scene, settings)?,
            pace: Pace::new(SHORTEST),
            left: None,
            time: Duration::ZERO,
            stop: None,
        })
    }

    /// The render.
    pub fn renderer(&mut self) -> &mut Renderer<E> {
        &mut self.renderer
    }

    /// Time of rendering so far, without that of showing.
    pub fn time(&self) -> Duration {
        self.time
    }

    /// What ended it, if anything.
    pub fn stop(&self) -> Option<Stop> {
        self.stop
    }

    /// Whether one of `stops` is reached.
    ///
    /// # Errors
    /// If the device fails.
    pub fn check(&mut self, stops: &Stops) -> Result<Option<Stop>, RenderError> {
        let pixels = u64::from(self.renderer.pixels());
        let most = stops.samples.map(|samples| u64::from(samples) * pixels);
        let has_samples = self.renderer.paths() >= pixels;
        self.stop = if most.is_some_and(|most| self.renderer.paths() >= most) {
            Some(Stop::Samples)
        } else if has_samples && stops.time.is_some_and(|time| self.time >= time) {
            Some(Stop::Time)
        } else if stops.noise.is_some() && self.renderer.has_converged()? {
            Some(Stop::Noise)
        } else {
            None
        };
        Ok(self.stop)
    }

    /// Renders a round, or a part of one where a picture is due. Where `interrupted` says so, ends
    /// after the batch at hand.
    ///
    /// The first round is a sample of each pixel, so that there is a whole picture soon.
    ///
    /// # Errors
    /// If the device fails.
    pub fn turn(
        &mut self,
        stops: &Stops,
        interrupted: &dyn Fn() -> bool,
    ) -> Result<(), RenderError> {
        let start = Instant::now();
        let paths = self.paths_left(stops).max(self.left.take().unwrap_or(0));
        let is_first = self.renderer.paths() == 0;
        let mut round = if is_first {
            self.renderer.uniform_round(1)
        } else {
            self.renderer.next_round(paths)?
        };
        while round.next_batch()?.is_some() {
            let is_late = stops.time.is_some_and(|time| self.time + start.elapsed() >= time);
            if interrupted() || is_late && !is_first && round.is_in_film() {
                break;
            }
            let is_due = self.pace.is_due(self.time + start.elapsed());
            if round.can_be_kept() && is_due && !is_first {
                self.left = Some(paths);
                break;
            }
        }
        drop(round);
        self.time += start.elapsed();
        Ok(())
    }

    /// Paths that are left until a stop, as far as that can be known. Less would be wrong: rounds
    /// are planned by it.
    fn paths_left(&self, stops: &Stops) -> u64 {
        let (pixels, paths) = (u64::from(self.renderer.pixels()), self.renderer.paths());
        let samples = stops.samples.map(|n| (u64::from(n) * pixels).saturating_sub(paths));
        let in_time = stops.time.map(|time| {
            let rate = paths as f64 / self.time.as_secs_f64().max(1e-9);
            (rate * time.saturating_sub(self.time).as_secs_f64()) as u64
        });
        samples.unwrap_or(u64::MAX).min(in_time.unwrap_or(u64::MAX)).max(1)
    }

    /// Whether a picture is due.
    pub fn is_due(&self) -> bool {
        self.renderer.paths() > 0 && self.pace.is_due(self.time)
    }

    /// A picture of what there is. The last one, and one that is to have `all`, has corrections,
    /// features, estimates and the filtered picture, which take time to compute.
    ///
    /// # Errors
    /// If the device fails.
    pub fn show(&mut self, all: bool) -> Result<Shot, RenderError> {
        let start = Instant::now();
        if self.stop.is_some() {
            self.renderer.finish_features()?;
        }
        let all = all || self.stop.is_some();
        let film = if all { self.renderer.film()? } else { self.renderer.glance()? };
        let rays = film.radiance.par_iter().map(|pixel| u64::from(pixel.rays)).sum();
        let error = relative_error(&film);
        self.pace.shown(self.time, start.elapsed());
        let status = Status {
            samples: self.renderer.paths() as f64 / f64::from(self.renderer.pixels()),
            rays,
            time: self.time,
            showing: self.pace.total(),
            error,
            stop: self.stop,
        };
        Ok(Shot { film: Arc::new(film), all, status })
    }
}

/// A picture of a render, and how far that is.
pub struct Shot {
    /// What there is.
    pub film: Arc<Film>,
    /// Whether it has all that can be computed of it.
    pub all: bool,
    /// How far the render is.
    pub status: Status,
}
