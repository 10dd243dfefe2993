//! How many paths to trace at once.

use std::time::Duration;

/// A batch should take this long: short enough for every watchdog (some drivers end a dispatch
/// after 2 s) and for a progress bar, long enough to hide the round trip to the device.
const TARGET: Duration = Duration::from_millis(100);
/// Where an unknown device starts.
const FIRST: u32 = 1 << 14;

/// Adapts the size of a batch to the speed of the device.
#[derive(Clone, Copy)]
pub struct BatchSize {
    slots: u32,
    capacity: u32,
    rate: f64,
}

impl BatchSize {
    /// Batches of at most `capacity` slots.
    pub fn new(capacity: u32) -> Self {
        Self { slots: FIRST.min(capacity), capacity, rate: 1.0 }
    }

    /// Slots of the next batch, at least 1.
    pub fn slots(&self) -> u32 {
        self.slots
    }

    /// Slots per second, as far as is known.
    pub fn rate(&self) -> f64 {
        self.rate
    }

    /// Learns from a batch of `slots` that took `elapsed`. Grows at most eightfold at a time, since
    /// a first batch may be of cheap pixels.
    pub fn record(&mut self, slots: u32, elapsed: Duration) {
        let wanted = f64::from(slots) * TARGET.as_secs_f64() / elapsed.as_secs_f64().max(1e-9);
        let next = wanted.min(f64::from(self.slots) * 8.0).max(1.0);
        // A last, small batch says little about large ones.
        if slots >= self.slots / 2 || next < f64::from(self.slots) {
            self.rate = f64::from(slots) / elapsed.as_secs_f64().max(1e-9);
            self.slots = (next as u32).clamp(1, self.capacity);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn batches_approach_the_target_and_never_pass_the_capacity() {
        let mut batch = BatchSize::new(1 << 22);
        let per_second = 2e6;
        for _ in 0..8 {
            let slots = batch.slots();
            batch.record(slots, Duration::from_secs_f64(f64::from(slots) / per_second));
        }
        assert_eq!(batch.slots(), 200_000);
        for _ in 0..8 {
            let slots = batch.slots();
            batch.record(slots, Duration::from_nanos(u64::from(slots)));
        }
        assert_eq!(batch.slots(), 1 << 22);
        batch.record(1 << 22, Duration::from_secs(4000));
        assert_eq!(batch.slots(), 104);
    }
}
