//! The error over time.

use crate::news::Status;
use glam::DVec3;
use rayon::prelude::*;
use raystream::film::Film;
use raystream_shaders::film::FilmPixel;

/// The relative error of a film's picture by the variance of its samples: the root of the mean
/// squared error over pixels and components, divided by the mean radiance. None where a pixel has
/// fewer than two samples, or all is black.
///
/// It is the same measure whatever decides about samples, so that renders can be compared. As any
/// variance of few samples it knows nothing of light that has not been found.
pub fn relative_error(film: &Film) -> Option<f64> {
    // Part by part, so that the sums are the same however many threads there are.
    let parts: Vec<_> = film.radiance.par_chunks(1 << 14).map(variance_and_mean).collect();
    let (mut variance, mut mean) = (0.0, 0.0);
    for part in parts {
        let (of_part, mean_of_part) = part?;
        variance += of_part;
        mean += mean_of_part;
    }
    let splats = film.splats.iter().flatten();
    mean += splats.map(|splat| splat.as_dvec3().element_sum()).sum::<f64>();
    let components = 3.0 * film.radiance.len() as f64;
    let error = (variance / components).sqrt() / (mean / components);
    (error.is_finite() && mean > 0.0).then_some(error)
}

/// The sums of variances and of means over pixels and components; None where a pixel has fewer than
/// two samples. As `Film::variance` and `Film::plain`, without a picture of each: this is done
/// often.
fn variance_and_mean(pixels: &[FilmPixel]) -> Option<(f64, f64)> {
    let (mut variance, mut mean) = (0.0, 0.0);
    for pixel in pixels {
        let n = f64::from(pixel.samples());
        if n < 2.0 {
            return None;
        }
        let m = (pixel.first_sum.as_dvec3() + pixel.second_sum.as_dvec3()) / n;
        let squares = pixel.sum_of_squares.as_dvec3() / n;
        variance += ((squares - m * m) / (n - 1.0)).max(DVec3::ZERO).element_sum();
        mean += m.element_sum();
    }
    Some((variance, mean))
}

/// A point of a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Seconds of rendering.
    pub seconds: f64,
    /// Samples, on average over the pixels.
    pub samples: f64,
    /// Relative error.
    pub error: f64,
}

/// The curve of a render, of bounded length: where it has too many points, every other one goes.
#[derive(Clone, Debug, Default)]
pub struct Curve {
    points: Vec<Point>,
    /// Points that are taken for one that is kept.
    stride: usize,
    /// Points since one was kept.
    skipped: usize,
}

/// Points that a curve has at most.
const MOST_POINTS: usize = 512;

impl Curve {
    /// Adds a point, unless nothing is known of the error.
    pub fn add(&mut self, status: &Status) {
        let Some(error) = status.error.filter(|error| *error > 0.0) else { return };
        let seconds = status.time.as_secs_f64();
        let point = Point { seconds, samples: status.samples, error };
        if seconds <= 0.0 || self.points.last().is_some_and(|last| last.seconds >= seconds) {
            return;
        }
        self.skipped += 1;
        if self.skipped < self.stride && status.stop.is_none() {
            return;
        }
        self.skipped = 0;
        self.points.push(point);
        if self.points.len() > MOST_POINTS {
            let mut keep = false;
            self.points.retain(|_| {
                keep = !keep;
                keep
            });
            self.stride = 2 * self.stride.max(1);
        }
    }

    /// The points, by time.
    pub fn points(&self) -> &[Point] {
        &self.points
    }

    /// The error after so many seconds, between points along a line of logarithms; None before the
    /// first point and after the last.
    pub fn error_at(&self, seconds: f64) -> Option<f64> {
        let after = self.points.iter().position(|point| point.seconds >= seconds)?;
        let b = self.points[after];
        if b.seconds == seconds {
            return Some(b.error);
        }
        let a = *self.points.get(after.checked_sub(1)?)?;
        let part = (seconds / a.seconds).ln() / (b.seconds / a.seconds).ln();
        Some((a.error.ln() + part * (b.error / a.error).ln()).exp())
    }
}

/// How much faster the first of two renders is: the variance that the second has beside that of
/// the first after the same time, the last that both have been at. None where there is none.
pub fn speedup(first: &Curve, second: &Curve) -> Option<f64> {
    let last = |curve: &Curve| curve.points().last().map(|point| point.seconds);
    let seconds = last(first)?.min(last(second)?);
    let (a, b) = (first.error_at(seconds)?, second.error_at(seconds)?);
    Some((b / a).powi(2))
}

#[cfg(test)]
mod tests {
    use super::*;
    use raystream_shaders::film::FilmPixel;
    use raystream_shaders::integrator::first_hits::FeaturePixel;
    use std::time::Duration;

    fn status(seconds: f64, error: Option<f64>) -> Status {
        Status { time: Duration::from_secs_f64(seconds), error, ..Status::default() }
    }

    fn curve(points: &[(f64, f64)]) -> Curve {
        let mut curve = Curve::default();
        points.iter().for_each(|&(seconds, error)| curve.add(&status(seconds, Some(error))));
        curve
    }

    #[test]
    fn the_error_is_that_of_the_mean() {
        // Samples of 0 and 2: their variance is 2 (of two) about the mean 1, that of it 1.
        let pixel = FilmPixel {
            first_sum: glam::Vec3::splat(2.0),
            first_samples: 2,
            sum_of_squares: glam::Vec3::splat(4.0),
            ..FilmPixel::default()
        };
        let film = Film::new(2, 1, vec![pixel; 2], vec![FeaturePixel::default(); 2]);
        assert!((relative_error(&film).unwrap() - 1.0).abs() < 1e-6);
        let few = FilmPixel { first_samples: 1, ..pixel };
        let film = Film::new(2, 1, vec![pixel, few], vec![FeaturePixel::default(); 2]);
        assert_eq!(relative_error(&film), None);
        let black = FilmPixel { first_samples: 9, ..FilmPixel::default() };
        let film = Film::new(1, 1, vec![black], vec![FeaturePixel::default()]);
        assert_eq!(relative_error(&film), None);
    }

    #[test]
    fn the_error_is_by_the_films_own_variance() {
        let pixel = |i: u32| FilmPixel {
            first_sum: glam::Vec3::new(1.0, 2.0, 3.0) * i as f32,
            first_samples: i + 1,
            second_sum: glam::Vec3::new(3.0, 1.0, 0.5) * i as f32,
            second_samples: 2,
            sum_of_squares: glam::Vec3::new(9.0, 8.0, 7.0) * (i * i) as f32,
            ..FilmPixel::default()
        };
        let mut film =
            Film::new(9, 1, (1..10).map(pixel).collect(), vec![FeaturePixel::default(); 9]);
        film.splats = Some(vec![glam::Vec3::new(0.5, 0.0, 1.0); 9]);
        let mean = |pixels: Vec<glam::Vec3>| {
            pixels.iter().map(|p| p.as_dvec3().element_sum()).sum::<f64>() / 27.0
        };
        let expected = mean(film.variance()).sqrt() / mean(film.plain());
        assert!((relative_error(&film).unwrap() / expected - 1.0).abs() < 1e-5);
    }

    #[test]
    fn curves_stay_short_and_keep_their_ends() {
        let mut curve = Curve::default();
        for step in 1..100_000 {
            curve.add(&status(f64::from(step), Some(1.0 / f64::from(step))));
        }
        let points = curve.points();
        assert!((200..=MOST_POINTS).contains(&points.len()), "{}", points.len());
        assert_eq!(points[0].seconds, 1.0);
        assert!(points[points.len() - 1].seconds > 99_000.0);
        assert!(points.is_sorted_by(|a, b| a.seconds < b.seconds));
    }

    #[test]
    fn what_is_not_known_is_no_point() {
        let mut curve = Curve::default();
        for error in [None, Some(0.0), Some(f64::NAN)] {
            curve.add(&status(1.0, error));
        }
        curve.add(&status(0.0, Some(1.0)));
        assert!(curve.points().is_empty());
        curve.add(&status(1.0, Some(1.0)));
        curve.add(&status(1.0, Some(0.5)));
        assert_eq!(curve.points().len(), 1, "the same time again");
    }

    #[test]
    fn between_points_errors_fall_as_powers() {
        let curve = curve(&[(1.0, 1.0), (100.0, 0.1)]);
        assert!((curve.error_at(10.0).unwrap() - 0.1_f64.sqrt()).abs() < 1e-12);
        assert_eq!(curve.error_at(1.0), Some(1.0));
        assert_eq!((curve.error_at(0.5), curve.error_at(101.0)), (None, None));
    }

    #[test]
    fn half_the_error_at_equal_time_is_four_times_as_fast() {
        let fast = curve(&[(1.0, 0.5), (4.0, 0.25), (9.0, 0.1)]);
        let slow = curve(&[(1.0, 1.0), (4.0, 0.5)]);
        assert!((speedup(&fast, &slow).unwrap() - 4.0).abs() < 1e-9);
        assert!((speedup(&slow, &fast).unwrap() - 0.25).abs() < 1e-9);
        assert_eq!(speedup(&slow, &Curve::default()), None);
    }
}
