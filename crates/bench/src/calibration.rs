//! How near the estimated errors of pixels are to the true ones.

use super::convergence::squared_errors;
use glam::Vec3;
use raystream::film::Film;

/// Groups of pixels, by their estimates.
pub const GROUPS: usize = 10;

/// Estimated and true squared errors of pixels, summed over renders in groups: the tenth of the
/// pixels that are estimated to be the calmest, then the next one, and so on.
#[derive(Clone, Debug, Default)]
pub struct Calibration {
    /// Sums of estimated squared errors.
    estimated: [f64; GROUPS],
    /// Sums of true ones.
    actual: [f64; GROUPS],
}

impl Calibration {
    /// Adds a render; nothing where its errors are not estimated.
    pub fn add(&mut self, film: &Film, truth: &[Vec3]) {
        let Some(estimates) = film.squared_error() else { return };
        let actual = squared_errors(&film.color(), truth);
        let mut pixels: Vec<(f64, f64)> =
            estimates.into_iter().map(f64::from).zip(actual).collect();
        pixels.sort_by(|a, b| a.0.total_cmp(&b.0));
        let count = pixels.len();
        for (place, (estimate, actual)) in pixels.into_iter().enumerate() {
            let group = place * GROUPS / count;
            self.estimated[group] += estimate;
            self.actual[group] += actual;
        }
    }

    /// For each group the estimated error by the true one, both as roots of their means; none where
    /// nothing is wrong.
    pub fn ratios(&self) -> [Option<f64>; GROUPS] {
        std::array::from_fn(|k| root_of_ratio(self.estimated[k], self.actual[k]))
    }

    /// The same of all pixels; none where nothing was estimated.
    pub fn ratio(&self) -> Option<f64> {
        root_of_ratio(self.estimated.iter().sum(), self.actual.iter().sum())
    }
}

fn root_of_ratio(estimated: f64, actual: f64) -> Option<f64> {
    (actual > 0.0).then(|| (estimated / actual).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use raystream_shaders::estimator::Estimate;
    use raystream_shaders::film::FilmPixel;
    use raystream_shaders::integrator::first_hits::FeaturePixel;

    /// A film whose pixels are off by 1, 2, ... and are estimated to be off by a factor of that.
    fn film(pixels: u32, factor: f32) -> Film {
        let pixel = |k| FilmPixel {
            first_sum: Vec3::splat(1.0 + k as f32),
            first_samples: 1,
            ..FilmPixel::NOTHING
        };
        let features = vec![FeaturePixel::default(); pixels as usize];
        let mut film = Film::new(pixels, 1, (0..pixels).map(pixel).collect(), features);
        let estimate = |k| Estimate {
            squared_error: (factor * (1.0 + k as f32)).powi(2),
            ..Estimate::default()
        };
        film.estimates = Some((0..pixels).map(estimate).collect());
        film
    }

    #[test]
    fn estimates_are_set_against_errors() {
        let truth = vec![Vec3::ZERO; 95];
        let mut calibration = Calibration::default();
        assert_eq!(calibration.ratio(), None);
        for _ in 0..3 {
            calibration.add(&film(95, 0.5), &truth);
        }
        let ratios = calibration.ratios();
        assert!(
            ratios
                .iter()
                .chain([&calibration.ratio()])
                .all(|ratio| { ratio.is_some_and(|ratio| (ratio - 0.5).abs() < 1e-6) })
        );
    }
}
