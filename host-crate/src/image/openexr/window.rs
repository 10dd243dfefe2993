//! Where the pixels of a file lie.

use exr::meta::attribute::IntegerBounds;
use std::fmt;

/// A rectangle of pixels in the plane that all windows of a file share; corners may be negative.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Window {
    pub left: i64,
    pub top: i64,
    pub width: usize,
    pub height: usize,
}

impl Window {
    pub(super) fn new(bounds: IntegerBounds) -> Self {
        Self {
            left: bounds.position.0.into(),
            top: bounds.position.1.into(),
            width: bounds.size.0,
            height: bounds.size.1,
        }
    }

    pub(super) fn pixels(&self) -> u128 {
        self.width as u128 * self.height as u128
    }

    /// Whether every pixel of `other` lies in this window too.
    pub(super) fn covers(&self, other: &Self) -> bool {
        self.overlap(other) == *other
    }

    /// What lies in both; without pixels where nothing does.
    pub(super) fn overlap(&self, other: &Self) -> Self {
        let span = |a: i64, a_size: usize, b: i64, b_size: usize| {
            let first = a.max(b);
            let end = (a + a_size as i64).min(b + b_size as i64);
            (first, usize::try_from(end - first).unwrap_or(0))
        };
        let (left, width) = span(self.left, self.width, other.left, other.width);
        let (top, height) = span(self.top, self.height, other.top, other.height);
        Self { left, top, width, height }
    }

    /// The values of this window, row by row, as those of `display`; 0 where this window has none.
    pub(super) fn show_in<T: Copy + Default>(&self, display: &Self, values: Vec<T>) -> Vec<T> {
        if self == display {
            return values;
        }
        let mut shown = vec![T::default(); display.width * display.height];
        let both = self.overlap(display);
        let first = |window: &Self, row: usize| {
            let y = (both.top - window.top) as usize + row;
            y * window.width + (both.left - window.left) as usize
        };
        if both.width > 0 {
            for row in 0..both.height {
                let (to, from) = (first(display, row), first(self, row));
                shown[to..to + both.width].copy_from_slice(&values[from..from + both.width]);
            }
        }
        shown
    }
}

impl fmt::Display for Window {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}x{} pixels at ({}, {})", self.width, self.height, self.left, self.top)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn window(left: i64, top: i64, width: usize, height: usize) -> Window {
        Window { left, top, width, height }
    }

    /// By the definition: each place of the display window by itself.
    #[test]
    fn pixels_keep_their_places() {
        let display = window(-2, 3, 4, 3);
        for left in -8..5 {
            for top in -3..9 {
                let data = window(left, top, 3, 2);
                let values: Vec<f32> = (1..=6).map(|value| value as f32).collect();
                let at = |x: i64, y: i64| {
                    let (x, y) = (x - left, y - top);
                    let inside = (0..3).contains(&x) && (0..2).contains(&y);
                    if inside { values[(y * 3 + x) as usize] } else { 0.0 }
                };
                let places = (3..6).flat_map(|y| (-2..2).map(move |x| (x, y)));
                let expected: Vec<f32> = places.map(|(x, y)| at(x, y)).collect();
                assert_eq!(data.show_in(&display, values.clone()), expected, "{data}");
                assert!(!data.covers(&display));
            }
        }
        assert!(window(-3, 0, 9, 9).covers(&display) && display.covers(&display));
    }
}
