//! A range of numbers along a line, and the numbers to write beside it.

/// A range of values, linear or logarithmic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scale {
    /// The smallest value.
    pub low: f64,
    /// The largest value, at least `low`.
    pub high: f64,
    /// Then `low` is above 0.
    pub logarithmic: bool,
}

/// Decades that a scale chosen for its values spans at most: of more, each had too few colours.
const MAX_DECADES: i32 = 6;

impl Scale {
    /// From `low` to `high`, logarithmic where that is more than a decade and has a logarithm.
    pub fn new(low: f64, high: f64) -> Self {
        Self { low, high, logarithmic: low > 0.0 && high > 10.0 * low }
    }

    /// The scale of the finite ones of `values`, none if there are none. Zeros do not keep it from
    /// being logarithmic.
    pub fn of(values: impl Iterator<Item = f32>) -> Option<Self> {
        let (mut low, mut lowest_positive, mut high) =
            (f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY);
        for value in values.filter(|v| v.is_finite()).map(f64::from) {
            (low, high) = (low.min(value), high.max(value));
            if value > 0.0 {
                lowest_positive = lowest_positive.min(value);
            }
        }
        if high < low {
            return None;
        }
        let positive = Self::new(lowest_positive.max(high * 10_f64.powi(-MAX_DECADES)), high);
        Some(if low >= 0.0 && positive.logarithmic {
            positive
        } else {
            Self { low, high, logarithmic: false }
        })
    }

    /// Where a number lies: 0 at (and below) the low end, 1 at (and above) the high one; 1/2 where
    /// they are one.
    pub fn position(&self, value: f64) -> f64 {
        if self.low == self.high {
            return 0.5;
        }
        let value = value.clamp(self.low, self.high);
        if self.logarithmic {
            (value / self.low).ln() / (self.high / self.low).ln()
        } else {
            (value - self.low) / (self.high - self.low)
        }
    }

    /// Round numbers between the ends, in order: sets of them from the finest to the empty one.
    pub fn tick_sets(&self) -> Vec<Vec<f64>> {
        let mut sets = if self.low == self.high {
            Vec::new()
        } else if self.logarithmic {
            self.logarithmic_sets()
        } else {
            self.linear_sets()
        };
        sets.push(Vec::new());
        for set in &mut sets {
            // One that differs from an end by a rounding error would need many digits to say so.
            set.retain(|&tick| (1e-4..1.0 - 1e-4).contains(&self.position(tick)));
        }
        sets
    }

    fn linear_sets(&self) -> Vec<Vec<f64>> {
        let decade = 10_f64.powf((self.high - self.low).log10().floor());
        let set = |factor: f64| {
            let step = decade * factor;
            let (first, last) = ((self.low / step).ceil(), (self.high / step).floor());
            // At most a hundred: the finest step is a tenth of the span's decade.
            (0..=(last - first).max(0.0) as u32).map(|i| (first + f64::from(i)) * step).collect()
        };
        [0.1, 0.2, 0.5, 1.0, 2.0, 5.0].map(set).into()
    }

    fn logarithmic_sets(&self) -> Vec<Vec<f64>> {
        let decades = self.low.log10().floor() as i32..=self.high.log10().ceil() as i32;
        let fine =
            decades.clone().flat_map(|k| [1.0, 2.0, 5.0].map(|m| m * 10_f64.powi(k))).collect();
        let every = |step: i32| {
            decades.clone().filter(|k| k.rem_euclid(step) == 0).map(|k| 10_f64.powi(k)).collect()
        };
        std::iter::once(fine).chain((1..=decades.end() - decades.start()).map(every)).collect()
    }
}

/// Numbers as text, short, but long enough that different ones differ.
pub(super) fn labels(numbers: &[f64]) -> Vec<String> {
    // A f32 has no more digits.
    const DIGITS: std::ops::RangeInclusive<usize> = 3..=9;
    let with =
        |digits: usize| -> Vec<String> { numbers.iter().map(|&n| label(n, digits)).collect() };
    DIGITS
        .map(with)
        .find(|labels| labels.iter().enumerate().all(|(i, label)| !labels[..i].contains(label)))
        .unwrap_or_else(|| with(*DIGITS.end()))
}

/// A number of so many digits; more where it is a whole number that can be written out.
fn label(number: f64, digits: usize) -> String {
    if number.fract() == 0.0 && number.abs() < 1e6 {
        // The sum makes 0 of -0.
        return format!("{:.0}", number + 0.0);
    }
    let scientific = format!("{number:.*e}", digits - 1);
    let Some((mantissa, exponent)) = scientific.split_once('e') else {
        return scientific;
    };
    match exponent.parse::<i32>() {
        Ok(exponent @ -3..=5) => {
            let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
            without_zeros(&format!("{number:.decimals$}")).to_owned()
        }
        _ => format!("{}e{exponent}", without_zeros(mantissa)),
    }
}

/// Without the zeros that end a decimal fraction.
fn without_zeros(number: &str) -> &str {
    if number.contains('.') { number.trim_end_matches('0').trim_end_matches('.') } else { number }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_than_a_decade_is_logarithmic() {
        let scale = |values: &[f32]| Scale::of(values.iter().copied());
        assert_eq!(
            scale(&[3.0, 1.0, 10.0]),
            Some(Scale { low: 1.0, high: 10.0, logarithmic: false })
        );
        assert_eq!(
            scale(&[3.0, 1.0, 11.0]),
            Some(Scale { low: 1.0, high: 11.0, logarithmic: true })
        );
        assert_eq!(
            scale(&[0.0, 2.0, 64.0]),
            Some(Scale { low: 2.0, high: 64.0, logarithmic: true })
        );
        assert_eq!(
            scale(&[0.0, 2.0, 5.0]),
            Some(Scale { low: 0.0, high: 5.0, logarithmic: false })
        );
        assert_eq!(
            scale(&[-1.0, 1.0, 64.0]),
            Some(Scale { low: -1.0, high: 64.0, logarithmic: false })
        );
        assert_eq!(
            scale(&[f32::NAN, 7.0, f32::INFINITY]),
            Some(Scale { low: 7.0, high: 7.0, logarithmic: false })
        );
        assert_eq!(scale(&[f32::NAN, f32::NEG_INFINITY]), None);
        assert_eq!(scale(&[]), None);
        let far = scale(&[1e-30, 1.0]).unwrap();
        assert!(far.logarithmic && (far.low - 1e-6).abs() < 1e-12, "{far:?}");
    }

    #[test]
    fn positions_along_the_scale() {
        let linear = Scale::new(2.0, 6.0);
        assert_eq!(
            [1.0, 2.0, 3.0, 6.0, 9.0].map(|v| linear.position(v)),
            [0.0, 0.0, 0.25, 1.0, 1.0]
        );
        let decades = Scale::new(0.01, 100.0);
        for (value, position) in [
            (-1.0, 0.0),
            (0.0, 0.0),
            (0.01, 0.0),
            (0.1, 0.25),
            (1.0, 0.5),
            (100.0, 1.0),
            (1e9, 1.0),
        ] {
            assert!((decades.position(value) - position).abs() < 1e-12, "{value}");
        }
        assert_eq!(Scale::new(3.0, 3.0).position(3.0), 0.5);
        let all = Scale::new(f64::from(f32::MIN), f64::from(f32::MAX));
        assert_eq!(all.position(0.0), 0.5);
    }

    #[test]
    fn ticks_are_round_ordered_and_within() {
        let f32s =
            [1e-45, 1e-30, 0.3, 1.0, 16_777_215.0, 16_777_216.0, 3e38].map(|v: f32| f64::from(v));
        for low in f32s.iter().flat_map(|&v| [-v, 0.0, v]) {
            for high in f32s.iter().flat_map(|&v| [-v, 0.0, v]).filter(|&high| high >= low) {
                let sets = Scale::new(low, high).tick_sets();
                assert_eq!(sets.last(), Some(&Vec::new()));
                for set in sets {
                    assert!(set.len() <= 300, "{} ticks from {low} to {high}", set.len());
                    assert!(
                        set.iter().all(|&t| t > low && t < high) && set.is_sorted(),
                        "{low} to {high}: {set:?}"
                    );
                }
            }
        }
        assert!(Scale::new(0.0, 5.0).tick_sets().contains(&vec![1.0, 2.0, 3.0, 4.0]));
        assert!(Scale::new(3.0, 2000.0).tick_sets().contains(&vec![10.0, 100.0, 1000.0]));
        let rounded = Scale::new(1e-6_f32.into(), 0.01_f32.into());
        assert!(rounded.tick_sets().contains(&vec![
            10_f64.powi(-5),
            10_f64.powi(-4),
            10_f64.powi(-3)
        ]));
        assert!(Scale::new(3.0, 40.0).tick_sets().contains(&vec![5.0, 10.0, 20.0]));
    }

    #[test]
    fn labels_are_short_and_differ() {
        assert_eq!(labels(&[0.0, -0.0, 16384.0]), ["0", "0", "16384"]);
        assert_eq!(labels(&[0.001_234_5, 1.5, 1234.5, -2.5]), ["0.00123", "1.5", "1234", "-2.5"]);
        assert_eq!(labels(&[1e-6, 1.234e-7, 1e9, 2.5e20]), ["1e-6", "1.23e-7", "1e9", "2.5e20"]);
        assert_eq!(labels(&[1000.14, 1000.2, 1000.4]), ["1000.1", "1000.2", "1000.4"]);
        assert_eq!(labels(&[-10.0, -0.0]), ["-10", "0"]);
    }
}
