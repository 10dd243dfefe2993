//! A render that outlives its device.
//!
//! Workers that fail are left out, and the render's own device does again what they had not handed
//! over. Where that device fails itself, with the film, the next one takes its place: it goes on
//! from the last state that was copied to the host, and traces again what came after.

use super::checkpoint::Checkpoint;
use super::error::RenderError;
use super::renderer::Renderer;
use crate::clock::Instant;
use crate::exec::{ExecError, Executor};
use std::sync::Arc;
use std::time::Duration;

/// Time between two copies of the state: what is traced again, at most, but for one round.
const INTERVAL: Duration = Duration::from_secs(10);
/// What a copy may take of it. The time to the next one grows with what is more.
const ALLOWED: Duration = Duration::from_millis(100);

/// The devices of a render, in the order in which they are to have its film.
pub struct Relay<'a, E> {
    devices: Vec<E>,
    /// Where it begins.
    from: Option<&'a Checkpoint>,
    kept: Kept,
}

/// Who renders until it is done or its device fails.
pub struct Leg<'a, E> {
    /// Who has the film.
    pub device: &'a E,
    /// Who else may trace.
    pub others: &'a [E],
    /// What to go on from; nothing at the beginning.
    pub from: Option<&'a Checkpoint>,
    /// To be [told](Kept::may_keep) wherever a checkpoint may be taken.
    pub kept: &'a mut Kept,
}

/// The last state of a render.
pub struct Kept {
    /// Shared with who goes on from it.
    checkpoint: Option<Arc<Checkpoint>>,
    /// When it is to be copied again.
    next: Instant,
    interval: Duration,
    /// Whether there is another device that could go on from it.
    is_wanted: bool,
}

impl Kept {
    /// Copies the state of a render, if it is time to. It is to be called only where
    /// [`Watch::may_checkpoint`](super::Watch::may_checkpoint) is.
    ///
    /// # Errors
    /// If the device fails.
    pub fn may_keep<E: Executor>(&mut self, renderer: &Renderer<E>) -> Result<(), ExecError> {
        let start = Instant::now();
        if self.is_wanted && start >= self.next {
            self.checkpoint = Some(Arc::new(renderer.checkpoint()?));
            let took = start.elapsed();
            let more = (took.as_secs_f64() / ALLOWED.as_secs_f64()).max(1.0);
            self.next = start + took + self.interval.mul_f64(more);
        }
        Ok(())
    }
}

impl<'a, E: Executor> Relay<'a, E> {
    /// Of a render that begins with the first of `devices`, or goes on there `from` a state.
    pub fn new(devices: Vec<E>, from: Option<&'a Checkpoint>) -> Self {
        let next = Instant::now();
        let kept = Kept { checkpoint: None, next, interval: INTERVAL, is_wanted: false };
        Self { devices, from, kept }
    }

    /// This one with another time between two copies than 10 s.
    pub fn with_interval(mut self, interval: Duration) -> Self {
        self.kept.interval = interval;
        self
    }

    /// Calls `leg` until it succeeds: again with the next device, if the one that has the film
    /// fails and there is another. Each failure is logged as a warning.
    ///
    /// # Errors
    /// What `leg` fails with for any other reason, or with the last device.
    ///
    /// # Panics
    /// If there is no device.
    #[expect(clippy::expect_used, reason = "whoever gives no device has a bug")]
    pub fn run<T>(
        &mut self,
        mut leg: impl FnMut(Leg<'_, E>) -> Result<T, RenderError>,
    ) -> Result<T, RenderError> {
        loop {
            let Self { devices, from, kept } = self;
            let (device, others) = devices.split_first().expect("a render has a device");
            kept.next = Instant::now() + kept.interval;
            kept.is_wanted = !others.is_empty();
            let last = kept.checkpoint.clone();
            let from = last.as_deref().or(*from);
            let error = match leg(Leg { device, others, from, kept }) {
                Err(error @ RenderError::Exec(ExecError::Device { .. })) => error,
                ended => return ended,
            };
            let Some(next) = others.first() else { return Err(error) };
            let from = kept.checkpoint.as_deref().or(self.from);
            let paths = from.map_or(0, |state| state.progress.paths);
            tracing::warn!(
                "{} is lost: {error}. {} goes on from the last copy, of {paths} paths.",
                device.name(),
                next.name()
            );
            self.devices.remove(0);
        }
    }
}
