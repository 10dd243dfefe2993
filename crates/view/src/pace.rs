//! How small the picture is while the camera moves.

use std::time::Duration;

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
