//! Batches that take too long, so that a render makes the next ones shorter.

use raystream::exec::{Kernel, Launch};
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

/// How long slow batches take at least: 2.5 times as long as batches should.
const SLOW: Duration = Duration::from_millis(250);

/// The batches that are still to be slow.
pub struct SlowBatches {
    tracing: &'static Kernel,
    left: AtomicU32,
}

impl SlowBatches {
    /// The first `count` that launch `tracing`.
    pub fn new(tracing: &'static Kernel, count: u32) -> Self {
        Self { tracing, left: AtomicU32::new(count) }
    }

    /// Waits if `parts` are one of them.
    pub fn hold_up<B>(&self, parts: &[&[Launch<'_, B>]]) {
        let traces =
            parts.iter().copied().flatten().any(|launch| launch.kernel().name == self.tracing.name);
        let fewer = |left: u32| left.checked_sub(1);
        if traces && self.left.fetch_update(Ordering::Relaxed, Ordering::Relaxed, fewer).is_ok() {
            std::thread::sleep(SLOW);
        }
    }
}
