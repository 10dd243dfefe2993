//! One render among those beside each other: its rounds, its clock, its pictures.

use crate::choices::Stops;
use crate::curve::relative_error;
use crate::news::{Frame, Status};
use crate::pace::{RoundLength, Shows};
use raystream::exec::Device;
use raystream::render::{PreparedScene, RenderError, Renderer, Settings, Stop};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// One render.
pub struct Side {
    renderer: Renderer,
    shows: Shows,
    length: RoundLength,
    /// How many paths the last round was given, if it was left before its end: the next one goes on
    /// with it.
    left: Option<u64>,
    time: Duration,
    stop: Option<Stop>,
}

impl Side {
    /// A render that has not begun.
    ///
    /// # Errors
    /// If the device has no room for it.
    pub fn new(
        device: Device,
        scene: &PreparedScene,
        settings: &Settings,
    ) -> Result<Self, RenderError> {
        Ok(Self {
            renderer: Renderer::new(device, scene, settings)?,
            shows: Shows::new(),
            length: RoundLength::default(),
            left: None,
            time: Duration::ZERO,
            stop: None,
        })
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
    /// # Errors
    /// If the device fails.
    pub fn turn(
        &mut self,
        stops: &Stops,
        interrupted: &dyn Fn() -> bool,
    ) -> Result<(), RenderError> {
        let (start, pixels) = (Instant::now(), self.renderer.pixels());
        let total = stops.samples.map_or(u64::MAX, |n| u64::from(n) * u64::from(pixels));
        let wanted = self.left.take().unwrap_or_else(|| self.length.paths(pixels));
        let paths = wanted.min(total.saturating_sub(self.renderer.paths()));
        let mut round = self.renderer.next_round(paths)?;
        let mut traced = 0;
        while let Some(batch) = round.next_batch()? {
            traced += u64::from(batch.paths);
            if interrupted() {
                break;
            }
            if round.can_be_kept() && self.shows.is_due(Instant::now()) {
                self.left = Some(paths);
                break;
            }
        }
        drop(round);
        self.length.record(traced, start.elapsed());
        self.time += start.elapsed();
        Ok(())
    }

    /// Whether a picture is due.
    pub fn is_due(&self) -> bool {
        self.renderer.paths() > 0 && self.shows.is_due(Instant::now())
    }

    /// A picture of what there is. The last one has all features.
    ///
    /// # Errors
    /// If the device fails.
    pub fn show(&mut self, version: u64, side: usize, moving: bool) -> Result<Frame, RenderError> {
        let start = Instant::now();
        if self.stop.is_some() {
            self.renderer.finish_features()?;
        }
        let film = self.renderer.film()?;
        let rays = self.renderer.rays()?;
        let error = relative_error(&film);
        self.shows.shown(Instant::now(), start.elapsed());
        let status = Status {
            samples: self.renderer.paths() as f64 / f64::from(self.renderer.pixels()),
            rays,
            time: self.time,
            showing: self.shows.total(),
            error,
            stop: self.stop,
        };
        Ok(Frame { version, side, film: Arc::new(film), moving, status })
    }
}
