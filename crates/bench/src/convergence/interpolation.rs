//! Between the points of a falling curve: straight lines in log-log scale, and never beyond its
//! ends.

/// Where a curve falls to a level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Crossing {
    /// From here on it stays at or below the level.
    At(f64),
    /// Its first point is below already.
    BelowFromTheStart,
    /// Its last point is above.
    NotReached,
}

impl Crossing {
    /// The place, if the curve says where.
    pub fn place(self) -> Option<f64> {
        match self {
            Self::At(x) => Some(x),
            Self::BelowFromTheStart | Self::NotReached => None,
        }
    }

    /// Why there is no place; empty where there is one.
    pub fn note(self) -> &'static str {
        match self {
            Self::At(_) => "",
            Self::BelowFromTheStart => "below it from the first point on",
            Self::NotReached => "not reached",
        }
    }
}

/// The place from which on `curve` (points (x, y) by rising x) stays at or below `level`: its last
/// crossing, so that a lucky dip does not count.
///
/// Only points with both numbers above 0 count.
pub fn crossing(curve: &[(f64, f64)], level: f64) -> Crossing {
    let points = positive(curve);
    let Some(above) = points.iter().rposition(|&(_, y)| y > level) else {
        return match points.first() {
            Some(&(x, y)) if y == level => Crossing::At(x),
            Some(_) => Crossing::BelowFromTheStart,
            None => Crossing::NotReached,
        };
    };
    match points.get(above + 1) {
        Some(&(x1, y1)) => {
            let (x0, y0) = points[above];
            Crossing::At(between((y0, x0), (y1, x1), level))
        }
        None => Crossing::NotReached,
    }
}

/// The height of `curve` (points (x, y) by rising x) at `x`; nothing before its first and after its
/// last point.
pub fn height(curve: &[(f64, f64)], x: f64) -> Option<f64> {
    let points = positive(curve);
    let after = points.iter().position(|&(right, _)| right >= x)?;
    let right = points[after];
    if right.0 == x {
        return Some(right.1);
    }
    let left = *points.get(after.checked_sub(1)?)?;
    Some(between(left, right, x))
}

/// The second coordinate at the first one `at`, on the line through `a` and `b` in log-log scale.
fn between(a: (f64, f64), b: (f64, f64), at: f64) -> f64 {
    let t = (at / a.0).ln() / (b.0 / a.0).ln();
    a.1 * (b.1 / a.1).powf(t)
}

fn positive(curve: &[(f64, f64)]) -> Vec<(f64, f64)> {
    curve.iter().copied().filter(|&(x, y)| x > 0.0 && y > 0.0).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn power_law(factor: f64, exponent: f64) -> Vec<(f64, f64)> {
        (0..10).map(|k| 2.0_f64.powi(k)).map(|x| (x, factor * x.powf(exponent))).collect()
    }

    fn close(a: f64, b: f64) {
        assert!((a / b - 1.0).abs() < 1e-12, "{a} is not {b}");
    }

    #[test]
    fn power_laws_are_met_exactly() {
        for (factor, exponent) in [(1.0, -0.5), (0.3, -0.4), (7.0, -1.0)] {
            let curve = power_law(factor, exponent);
            for x in [1.0_f64, 1.1, 3.0, 100.0, 511.9, 512.0] {
                let y = factor * x.powf(exponent);
                close(height(&curve, x).unwrap(), y);
                close(crossing(&curve, y * (1.0 + 1e-15)).place().unwrap_or(1.0), x);
            }
        }
    }

    #[test]
    fn nothing_is_extrapolated() {
        let curve = power_law(1.0, -0.5);
        assert_eq!(crossing(&curve, 0.99 * 512.0_f64.powf(-0.5)), Crossing::NotReached);
        assert_eq!(crossing(&curve, 1.01), Crossing::BelowFromTheStart);
        assert_eq!(crossing(&curve, 1.0), Crossing::At(1.0));
        assert_eq!((height(&curve, 0.99), height(&curve, 513.0)), (None, None));
        assert_eq!((crossing(&[], 1.0), height(&[], 1.0)), (Crossing::NotReached, None));
    }

    #[test]
    fn a_lucky_dip_does_not_count() {
        let curve = [(1.0, 1.0), (2.0, 0.1), (4.0, 0.8), (8.0, 0.2)];
        close(crossing(&curve, 0.4).place().unwrap(), 32.0_f64.sqrt());
    }

    #[test]
    fn points_without_a_logarithm_are_left_out() {
        let curve = [(0.0, 5.0), (1.0, 1.0), (2.0, 0.0), (4.0, 0.25)];
        close(height(&curve, 2.0).unwrap(), 0.5);
        close(crossing(&curve, 0.5).place().unwrap(), 2.0);
    }
}
