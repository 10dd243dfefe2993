//! How often a render under way is looked at.

use std::time::Duration;

/// A picture is followed by this many times as much rendering as it took.
const RENDERING: u32 = 24;

/// When the next picture of a render is due: often, but so that showing costs little.
///
/// A picture that took `c` is followed by at least `24 c` of rendering. Where pictures cost the
/// same within a quarter, showing then takes at most 5 % of any time that begins after a picture,
/// the first one say, however long or short that time is; of any other time it takes that and a
/// picture more. Nothing is saved up for later: a render that was looked at seldom is not looked at
/// more often afterwards.
///
/// Times are of rendering alone, so that renders which take turns are told apart.
#[derive(Clone, Copy, Debug)]
pub struct Pace {
    /// Rendering between two pictures, at least.
    shortest: Duration,
    due: Duration,
    total: Duration,
}

impl Pace {
    /// Of a render that begins, with at least `shortest` of rendering from a picture to the next.
    /// The first picture is due at once.
    pub fn new(shortest: Duration) -> Self {
        Self { shortest, due: Duration::ZERO, total: Duration::ZERO }
    }

    /// Whether a picture is due after so much rendering in all.
    pub fn is_due(&self, rendered: Duration) -> bool {
        rendered >= self.due
    }

    /// A picture has been made after so much rendering in all, and took `cost`.
    pub fn shown(&mut self, rendered: Duration, cost: Duration) {
        self.due = rendered.saturating_add(self.shortest.max(cost.saturating_mul(RENDERING)));
        self.total += cost;
    }

    /// Time that all pictures took.
    pub fn total(&self) -> Duration {
        self.total
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: Duration = Duration::from_millis(1);
    const SHORTEST: Duration = Duration::from_millis(100);

    /// A picture: when it began and ended, by the clock.
    type Shown = (Duration, Duration);

    /// The pictures of so much rendering, by batches of `batch`, where picture `i` takes `cost(i)`.
    fn pictures(
        rendering: Duration,
        batch: Duration,
        cost: impl Fn(usize) -> Duration,
    ) -> Vec<Shown> {
        let (mut pace, mut rendered, mut shown) = (Pace::new(SHORTEST), Duration::ZERO, Vec::new());
        while rendered < rendering {
            if pace.is_due(rendered) {
                let start = rendered + pace.total();
                pace.shown(rendered, cost(shown.len()));
                shown.push((start, rendered + pace.total()));
            }
            rendered += batch;
        }
        shown
    }

    /// The largest share of showing in a time that begins after a picture.
    fn largest_share(shown: &[Shown]) -> f64 {
        let mut largest = 0.0_f64;
        for (first, (_, start)) in shown.iter().enumerate() {
            let mut showing = Duration::ZERO;
            for (from, to) in &shown[first + 1..] {
                // Nowhere is the share as large as at the end of a picture.
                showing += *to - *from;
                largest = largest.max(showing.as_secs_f64() / (*to - *start).as_secs_f64());
            }
        }
        largest
    }

    #[test]
    fn showing_takes_at_most_a_twentieth_of_any_time_after_a_picture() {
        for base in [MS, 10 * MS, 50 * MS, 220 * MS, 1000 * MS] {
            for batch in [MS, 7 * MS, 100 * MS] {
                let steady = |_: usize| base;
                // Up and down by a quarter, in several rhythms.
                let uneven = |i: usize| base + base / 4 * u32::from(i % 3 == 1);
                let growing = |i: usize| base.mul_f64(1.02_f64.powi(i.min(100) as i32));
                let costs: [&dyn Fn(usize) -> Duration; 3] = [&steady, &uneven, &growing];
                for cost in costs {
                    let shown = pictures(60_000 * MS, batch, cost);
                    assert!(shown.len() > 2, "{} pictures at {base:?}", shown.len());
                    let share = largest_share(&shown);
                    assert!(share <= 0.05, "{share} at {base:?}, by batches of {batch:?}");
                }
            }
        }
    }

    /// Any time at all has a picture more than that, so that of a second or more it is no more than
    /// a twentieth where pictures take up to a hundredth of a second.
    #[test]
    fn of_any_second_a_cheap_picture_takes_at_most_a_twentieth() {
        for base in [MS, 3 * MS, 10 * MS] {
            let shown = pictures(30_000 * MS, MS, |_| base);
            for (first, (start, _)) in shown.iter().enumerate().skip(1) {
                let mut showing = Duration::ZERO;
                for (from, to) in &shown[first..] {
                    showing += *to - *from;
                    let time = (*to - *start).max(1000 * MS);
                    let share = showing.as_secs_f64() / time.as_secs_f64();
                    assert!(share <= 0.05, "{share} of {time:?} at {base:?} a picture");
                }
            }
        }
    }

    #[test]
    fn what_costs_little_is_shown_often_and_what_costs_more_less_often() {
        let in_ten_seconds = |cost: Duration| pictures(10_000 * MS, MS, |_| cost).len();
        assert_eq!(in_ten_seconds(2 * MS), 100);
        assert_eq!(in_ten_seconds(100 * MS), 5);
        assert_eq!(in_ten_seconds(1000 * MS), 1);
    }

    #[test]
    fn the_first_picture_is_due_at_once() {
        assert!(Pace::new(SHORTEST).is_due(Duration::ZERO));
    }
}
