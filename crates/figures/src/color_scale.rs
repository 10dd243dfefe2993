//! The colours of numbers, and the numbers of colours.

use super::scale::{Scale, labels};

/// Colour of what is not finite: no colour of the map is near it.
pub(super) const NOT_FINITE: [u8; 3] = [255, 0, 255];
/// Colour of zeros that have no place along the colours.
pub(super) const ZERO: [u8; 3] = [0; 3];

/// Where a number lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Place {
    /// 0..=1 along the colours.
    Along(f64),
    Below,
    Above,
    /// A zero that has no place along the colours.
    Zero,
    NotFinite,
}

impl Place {
    pub(super) fn color(self) -> [u8; 3] {
        match self {
            Place::Along(position) => color_at(position),
            Place::Below => color_at(0.0),
            Place::Above => color_at(1.0),
            Place::Zero => ZERO,
            Place::NotFinite => NOT_FINITE,
        }
    }
}

/// The colours of numbers, as [`write_color_map`](super::write_color_map) takes them: viridis, over
/// the values that there are. Where it is logarithmic, zero is black; what is not finite is magenta.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColorScale {
    /// What the colours span; none if no value has a place there.
    pub(super) scale: Option<Scale>,
    /// Whether a zero is a value, and not the lack of one.
    pub(super) zero_is_value: bool,
}

impl ColorScale {
    /// The colours of `values`, from the least to the largest of the finite ones. Where they are
    /// more than a decade apart they are logarithmic, over six decades at most. A zero has a place
    /// there only if it is a value.
    pub fn of(values: impl Iterator<Item = f32>, zero_is_value: bool) -> Self {
        let scale = Scale::of(values.filter(|&value| zero_is_value || value != 0.0));
        Self { scale, zero_is_value }
    }

    /// The numbers at both ends of the colours; None if no value has a place there.
    pub fn range(&self) -> Option<(f64, f64)> {
        self.scale.map(|scale| (scale.low, scale.high))
    }

    /// The colour of a number, sRGB.
    pub fn color(&self, value: f32) -> [u8; 3] {
        self.place(value).color()
    }

    /// The colour at a position from 0 to 1 along the colours, sRGB; where all values are one, its.
    pub fn color_along(&self, position: f64) -> [u8; 3] {
        let is_one = self.scale.is_some_and(|scale| scale.low == scale.high);
        color_at(if is_one { 0.5 } else { position })
    }

    /// The ends and round numbers between them, `most` in all but at least the ends: each with its
    /// position from 0 to 1, in order.
    pub fn ticks(&self, most: usize) -> Vec<(f64, String)> {
        let Some(scale) = &self.scale else { return Vec::new() };
        let mut numbers = vec![scale.low];
        if scale.low < scale.high {
            let fitting = |set: &Vec<f64>| set.len() + 2 <= most.max(2);
            numbers.extend(scale.tick_sets().into_iter().find(fitting).unwrap_or_default());
            numbers.push(scale.high);
        }
        let texts = labels(&numbers);
        numbers.iter().map(|&number| scale.position(number)).zip(texts).collect()
    }

    pub(super) fn place(&self, value: f32) -> Place {
        if !value.is_finite() {
            return Place::NotFinite;
        }
        match self.scale {
            Some(scale) if value != 0.0 || self.zero_is_value && !scale.logarithmic => {
                match f64::from(value) {
                    value if value < scale.low => Place::Below,
                    value if value > scale.high => Place::Above,
                    value => Place::Along(scale.position(value)),
                }
            }
            // Without a scale, all that is finite is zero.
            _ => Place::Zero,
        }
    }
}

/// The colour at a position from 0 to 1, sRGB.
pub(super) fn color_at(position: f64) -> [u8; 3] {
    colorous::VIRIDIS.eval_continuous(position).as_array()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_the_ends_and_round_numbers_between() {
        let scale = ColorScale::of([0.0, 1.0, 2000.0].into_iter(), true);
        let ticks = scale.ticks(6);
        let texts: Vec<&str> = ticks.iter().map(|(_, text)| text.as_str()).collect();
        assert_eq!(texts, ["1", "10", "100", "1000", "2000"]);
        assert_eq!((ticks[0].0, ticks[4].0), (0.0, 1.0));
        assert!(ticks.is_sorted_by(|a, b| a.0 < b.0));
        for most in 0..20 {
            assert!(scale.ticks(most).len() <= most.max(2));
        }
    }

    #[test]
    fn one_value_has_one_tick_and_no_value_none() {
        let one = ColorScale::of([7.0, 7.0].into_iter(), true);
        assert_eq!(one.ticks(5), [(0.5, "7".to_owned())]);
        assert_eq!(one.color(7.0), one.color_along(0.0));
        let none = ColorScale::of([0.0, f32::NAN].into_iter(), false);
        assert_eq!((none.ticks(5), none.range()), (Vec::new(), None));
        assert_eq!((none.color(0.0), none.color(f32::NAN)), (ZERO, NOT_FINITE));
    }

    #[test]
    fn colours_are_those_of_the_positions() {
        let scale = ColorScale::of([1.0, 5.0].into_iter(), true);
        assert_eq!(scale.color(1.0), scale.color_along(0.0));
        assert_eq!(scale.color(3.0), scale.color_along(0.5));
        assert_eq!(scale.color(9.0), scale.color_along(1.0));
    }
}
