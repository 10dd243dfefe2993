//! How long rounds are, how often the picture is shown, and how small it is while the camera moves.

use std::time::{Duration, Instant};

/// A picture is shown this often at most.
const SHORTEST_INTERVAL: Duration = Duration::from_millis(100);
/// Showing takes one part of so many of the time, at most.
const SHARE: u32 = 25;

/// When the next picture is due: often, but so that showing takes a small part of the time.
#[derive(Clone, Copy, Debug)]
pub struct Shows {
    last: Option<Instant>,
    /// How long the last one took.
    cost: Duration,
    /// How long all took.
    total: Duration,
}

impl Shows {
    /// The first picture is due at once.
    pub fn new() -> Self {
        Self { last: None, cost: Duration::ZERO, total: Duration::ZERO }
    }

    /// Whether a picture is due.
    pub fn is_due(&self, now: Instant) -> bool {
        let interval = SHORTEST_INTERVAL.max(self.cost * (SHARE - 1));
        self.last.is_none_or(|last| now.saturating_duration_since(last) >= interval)
    }

    /// A picture has been made, in so much time.
    pub fn shown(&mut self, now: Instant, cost: Duration) {
        (self.last, self.cost) = (Some(now), cost);
        self.total += cost;
    }

    /// Time that all pictures took.
    pub fn total(&self) -> Duration {
        self.total
    }
}

impl Default for Shows {
    fn default() -> Self {
        Self::new()
    }
}

/// A round should take this long, so that pictures and stops are in time.
const ROUND: Duration = Duration::from_millis(500);

/// How many paths a round may trace.
#[derive(Clone, Copy, Debug, Default)]
pub struct RoundLength {
    paths_per_second: Option<f64>,
}

impl RoundLength {
    /// So many paths have taken so much time.
    pub fn record(&mut self, paths: u64, time: Duration) {
        if paths > 0 && time > Duration::ZERO {
            self.paths_per_second = Some(paths as f64 / time.as_secs_f64());
        }
    }

    /// Paths of the next round of a picture of `pixels`: at least one each, or a few more where
    /// nothing is known.
    pub fn paths(&self, pixels: u32) -> u64 {
        let pixels = u64::from(pixels);
        let paths = self.paths_per_second.map(|rate| (rate * ROUND.as_secs_f64()) as u64);
        paths.unwrap_or(8 * pixels).max(pixels)
    }
}

/// A frame should take no longer while the camera moves.
const FRAME: Duration = Duration::from_millis(33);
/// Sides of the smallest picture are this part of the whole one's.
const SMALLEST: u32 = 16;

/// By what the sides of the picture are divided while the camera moves: by four at first, and then
/// by as little as leaves frames short enough.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MovingSize {
    divisor: u32,
}

impl Default for MovingSize {
    fn default() -> Self {
        Self { divisor: 4 }
    }
}

impl MovingSize {
    /// By what the sides are divided: 1, 2, 4, 8 or 16.
    pub fn divisor(self) -> u32 {
        self.divisor
    }

    /// The sides of a picture of `width` by `height`; at least 1.
    pub fn of(self, width: u32, height: u32) -> (u32, u32) {
        (width.div_ceil(self.divisor).max(1), height.div_ceil(self.divisor).max(1))
    }

    /// A frame has taken so long.
    pub fn record(&mut self, time: Duration) {
        if time > FRAME {
            self.divisor = (2 * self.divisor).min(SMALLEST);
        } else if time * 6 < FRAME {
            // A picture of twice the sides has four times the pixels.
            self.divisor = (self.divisor / 2).max(1);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: Duration = Duration::from_millis(1);

    #[test]
    fn showing_takes_a_small_part_of_the_time() {
        for cost in [MS, 10 * MS, 300 * MS] {
            let (mut shows, start) = (Shows::new(), Instant::now());
            let (mut now, mut shown) = (start, 0_u32);
            while now < start + 60_000 * MS {
                if shows.is_due(now) {
                    now += cost;
                    shows.shown(now, cost);
                    shown += 1;
                }
                now += MS;
            }
            let share = shows.total().as_secs_f64() / (now - start).as_secs_f64();
            assert!(share < 0.05, "{share} of the time at {cost:?} a picture");
            assert!((5..=601).contains(&shown), "{shown} pictures at {cost:?} each");
        }
    }

    #[test]
    fn the_first_picture_is_due_at_once() {
        assert!(Shows::new().is_due(Instant::now()));
    }

    #[test]
    fn rounds_are_as_long_as_the_device_is_fast() {
        let mut length = RoundLength::default();
        assert_eq!(length.paths(100), 800);
        length.record(10_000, Duration::from_secs(1));
        assert_eq!(length.paths(100), 5000);
        assert_eq!(length.paths(9000), 9000, "every pixel gets one");
        length.record(0, Duration::from_secs(1));
        length.record(10, Duration::ZERO);
        assert_eq!(length.paths(100), 5000, "what says nothing changes nothing");
    }

    #[test]
    fn a_slow_device_gets_smaller_pictures_and_a_fast_one_larger() {
        let mut size = MovingSize::default();
        assert_eq!(size.of(1280, 720), (320, 180));
        size.record(20 * MS);
        assert_eq!(size.divisor(), 4);
        (0..9).for_each(|_| size.record(50 * MS));
        assert_eq!(size.divisor(), 16);
        assert_eq!(size.of(10, 1), (1, 1));
        (0..9).for_each(|_| size.record(MS));
        assert_eq!(size.divisor(), 1);
    }

    /// Otherwise the picture would change its size with every frame.
    #[test]
    fn a_size_that_suits_stays() {
        for milliseconds_at_full_size in [10, 100, 300, 1000, 5000] {
            let time = |size: MovingSize| {
                milliseconds_at_full_size * MS / (size.divisor() * size.divisor())
            };
            let mut size = MovingSize::default();
            (0..9).for_each(|_| size.record(time(size)));
            let settled = size;
            size.record(time(size));
            assert_eq!(size, settled);
        }
    }
}
