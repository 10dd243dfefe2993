//! How often the picture is shown, and how small it is while the camera moves.

use raystream::clock::Instant;
use std::time::Duration;

/// A picture is shown this often at most.
const SHORTEST_INTERVAL: Duration = Duration::from_millis(100);
/// Showing takes one part of so many of the time, at most.
const SHARE: u32 = 25;

/// So much more it may take, so that a render is looked at often while it changes most.
const CREDIT: Duration = Duration::from_millis(500);

/// When the next picture is due: often, but so that showing takes a small part of the time.
#[derive(Clone, Copy, Debug)]
pub struct Shows {
    start: Instant,
    last: Option<Instant>,
    /// How long the last one took.
    cost: Duration,
    /// How long all took.
    total: Duration,
}

impl Shows {
    /// Of a render that begins now. The first picture is due at once.
    pub fn new(now: Instant) -> Self {
        Self { start: now, last: None, cost: Duration::ZERO, total: Duration::ZERO }
    }

    /// Whether a picture is due, which will take as long as the last one.
    pub fn is_due(&self, now: Instant) -> bool {
        let Some(last) = self.last else { return true };
        let affordable = now.saturating_duration_since(self.start) / SHARE + CREDIT;
        let is_affordable = self.total + self.cost <= affordable;
        is_affordable && now.saturating_duration_since(last) >= SHORTEST_INTERVAL.max(self.cost)
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
            let (mut shows, start) = (Shows::new(Instant::now()), Instant::now());
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
    fn what_costs_little_is_shown_often_and_what_costs_more_often_at_first() {
        let shown_in = |seconds: u32, cost: Duration| {
            let start = Instant::now();
            let (mut shows, mut now, mut shown) = (Shows::new(start), start, 0);
            while now < start + seconds * 1000 * MS {
                if shows.is_due(now) {
                    now += cost;
                    shows.shown(now, cost);
                    shown += 1;
                }
                now += MS;
            }
            shown
        };
        assert!((9..=10).contains(&shown_in(1, 2 * MS)));
        assert!(shown_in(2, 100 * MS) >= 5);
        assert!(shown_in(100, 100 * MS) <= 46);
    }

    #[test]
    fn the_first_picture_is_due_at_once() {
        let now = Instant::now();
        assert!(Shows::new(now).is_due(now));
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
