//! Whether a measured render shows what the reference shows.

use super::reference::Reference;
use crate::BenchError;
use glam::Vec3;
use raystream::exec::Executor;
use raystream::film::Film;
use raystream::render::{IntegratorKind, PreparedScene, Renderer, Sampling, Settings};

/// Standard errors by which the mean of a uniform render may be off: one false alarm in two
/// million.
pub const LIMIT: f64 = 5.0;
/// The same where the standard error is that of the spread of [`ROUNDS`] rounds: by Student's t
/// distribution of 31 degrees of freedom.
pub const LIMIT_BY_SPREAD: f64 = 6.27;
/// Rounds whose spread is measured.
pub const ROUNDS: u32 = 32;
/// Share by which the mean of an adaptive render may be off without a warning.
pub const ADAPTIVE_BIAS: f64 = 0.02;
/// What sums of f32 may be off by, as a share.
const ROUNDING: f64 = 1e-5;
/// Samples of a pixel in a round whose spread is measured, at most.
const LONGEST: u32 = 16;
/// The seed of the rounds whose spread is measured, unlike that of any other render.
const SPREAD_SEED: u32 = 0x7370_7264;

/// How much the mean radiance of rounds varies, where the samples of a round share light paths.
///
/// The film's variances are those of pixels by themselves: light paths that are a little too bright
/// make all pixels of their round too bright. So the error of the mean is taken from whole rounds,
/// which are independent of each other.
#[derive(Clone, Copy, Debug)]
pub struct Spread {
    /// Variance of the sum of all pixels, each the mean of a round's samples and of its components.
    variance: f64,
    /// Samples of each pixel in a measured round.
    samples: u32,
    /// Samples of each pixel that share light paths in other renders, at most.
    shared: u32,
}

impl Spread {
    /// Renders [`ROUNDS`] rounds uniformly with `settings`, as long as those of a uniform render
    /// (at most of 16 samples per pixel). Nothing if its samples are independent.
    pub fn measure<E: Executor>(
        executor: &E,
        scene: &PreparedScene,
        settings: &Settings,
    ) -> Result<Option<Self>, BenchError> {
        let settings = Settings { seed: SPREAD_SEED, sampling: Sampling::UNIFORM, ..*settings };
        let mut renderer = Renderer::new(executor, scene, &settings)?;
        let Some(shared) = renderer.samples_that_share() else { return Ok(None) };
        let samples = shared.min(LONGEST);
        let mut before = 0.0;
        let mut sums = Vec::new();
        for round in 1..=ROUNDS {
            renderer.uniform_round(samples).finish()?;
            // Rounds are of one length, so the film is the mean of their pictures.
            let mean: f64 = renderer.film()?.color().into_iter().map(gray).sum();
            let sum = mean * f64::from(round);
            sums.push(sum - before);
            before = sum;
        }
        Ok(Some(Self { variance: variance(&sums), samples, shared }))
    }

    /// An upper bound for the variance of the sum of all pixels of a render of `samples` per pixel.
    ///
    /// That of a round of `n` samples is `a / n + b`, where `a` is due to what its samples have
    /// each for themselves. With rounds of at most `m` samples, that of `N` samples is at most `(a
    /// + b m) / N`, which for `m` beyond `n` is less than `(a / n + b) m / N`.
    fn of_mean(&self, samples: f64) -> f64 {
        let together = f64::from(self.shared).min(samples).max(f64::from(self.samples));
        self.variance * together / samples
    }
}

/// The variance that `values` are drawn with.
pub(crate) fn variance(values: &[f64]) -> f64 {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (count - 1.0)
}

/// The difference of two means.
#[derive(Clone, Copy, Debug)]
pub struct Deviation {
    /// In its standard errors.
    pub errors: f64,
    /// How many of these are allowed.
    pub limit: f64,
}

impl Deviation {
    /// Whether it is more than chance explains, or not a number.
    pub fn is_wrong(&self) -> bool {
        self.errors.is_nan() || self.errors > self.limit
    }
}

/// The difference of the means of `film`, a uniform render of `samples` per pixel by `integrator`,
/// and of the reference. `spread` is that of the integrator `lvc`, if either is by it and its
/// samples share light paths.
///
/// The variance of both is taken from the reference: it has seen the rare bright paths that a short
/// render may have missed, and then underestimates. Only where one of them is by `lvc` and the
/// other by a path tracer (all others are alike), each has its own. A path's components are taken
/// to vary together, which cannot underestimate. For `lvc` the spread of rounds counts, where it is
/// larger.
pub fn mean_difference(
    film: &Film,
    samples: f64,
    integrator: IntegratorKind,
    reference: &Reference,
    spread: Option<Spread>,
) -> Deviation {
    let is_lvc = |integrator| integrator == IntegratorKind::Lvc;
    let with_spread =
        |variance: f64, samples, integrator| match spread.filter(|_| is_lvc(integrator)) {
            Some(spread) => spread.of_mean(samples).max(variance),
            None => variance,
        };
    let reference_samples = f64::from(reference.samples);
    let of_reference = variance_of_sum(&reference.variance);
    let of_film = if is_lvc(integrator) == is_lvc(reference.integrator) {
        of_reference * reference_samples / samples
    } else {
        variance_of_sum(&film.variance())
    };
    let variance = with_spread(of_reference, reference_samples, reference.integrator)
        + with_spread(of_film, samples, integrator);
    let pairs = film.color().into_iter().zip(&reference.image.pixels);
    let difference: f64 = pairs.map(|(t, &r)| gray(t) - gray(r)).sum();
    let sum: f64 = reference.image.pixels.iter().map(|&r| gray(r)).sum();
    let error = variance.sqrt() + ROUNDING * sum;
    let by_spread = spread.is_some() && (is_lvc(integrator) || is_lvc(reference.integrator));
    Deviation {
        errors: if difference == 0.0 { 0.0 } else { difference.abs() / error },
        limit: if by_spread { LIMIT_BY_SPREAD } else { LIMIT },
    }
}

/// The variance of the sum over pixels of the mean of their components, of the variances of
/// independent pixels.
fn variance_of_sum(variance: &[Vec3]) -> f64 {
    variance.iter().map(|v| (v.as_dvec3().map(f64::sqrt).element_sum() / 3.0).powi(2)).sum()
}

/// The mean of the components.
pub(crate) fn gray(color: Vec3) -> f64 {
    color.as_dvec3().element_sum() / 3.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use IntegratorKind::{Lvc, Megakernel, Streaming};
    use raystream::image::ColorImage;
    use raystream_shaders::film::FilmPixel;

    /// 100 pixels of mean `value` by 9 samples, whose variance is 0.36 each, and so 0.04 * 9 / 8 =
    /// 0.045 that of their means.
    fn film(value: f32) -> Film {
        let pixel = FilmPixel {
            first_sum: Vec3::splat(9.0 * value),
            first_samples: 9,
            sum_of_squares: Vec3::splat(9.0 * (value * value + 0.36)),
            ..Default::default()
        };
        Film::new(10, 10, vec![pixel; 100], Vec::new())
    }

    /// One of 90 samples whose means of pixels have variance 0.01: 0.9 with one sample and 0.1 with
    /// nine.
    fn reference(integrator: IntegratorKind) -> Reference {
        let image = ColorImage { width: 10, height: 10, pixels: vec![Vec3::ONE; 100] };
        Reference {
            image,
            variance: vec![Vec3::splat(0.01); 100],
            difference: Vec::new(),
            samples: 90,
            integrator,
        }
    }

    /// Asserts that a mean 10 % off is so many standard errors off as the two variances of pixels'
    /// means say.
    fn assert_errors(deviation: Deviation, of_film: f64, of_reference: f64, limit: f64) {
        let expected = 0.1 * 100.0 / (((of_film + of_reference) * 100.0).sqrt() + 1e-3);
        assert!(
            (deviation.errors / expected - 1.0).abs() < 1e-5,
            "{deviation:?} is not {expected}"
        );
        assert_eq!(deviation.limit, limit);
    }

    #[test]
    fn counts_in_standard_errors_of_the_difference() {
        let of = |value, integrator| {
            mean_difference(&film(value), 9.0, integrator, &reference(Streaming), None)
        };
        // All path tracers are alike.
        assert_errors(of(1.1, Streaming), 0.1, 0.01, LIMIT);
        assert_errors(of(1.1, Megakernel), 0.1, 0.01, LIMIT);
        assert_eq!(of(1.0, Streaming).errors, 0.0);
        assert!(of(f32::NAN, Streaming).is_wrong());
        assert!(of(9.0, Streaming).is_wrong() && !of(1.1, Streaming).is_wrong());
        // That which is not a path tracer has a variance of its own.
        assert_errors(of(1.1, Lvc), 0.045, 0.01, LIMIT);
    }

    #[test]
    fn rounds_that_share_light_paths_have_the_error_of_their_spread() {
        // Rounds of 3 samples whose means vary by 3: those of 9 samples by 1 and those of 90 by
        // 0.1.
        let spread = Some(Spread { variance: 300.0, samples: 3, shared: 3 });
        let of = |integrator, of_reference, spread| {
            mean_difference(&film(1.1), 9.0, integrator, &reference(of_reference), spread)
        };
        assert_errors(of(Lvc, Lvc, spread), 1.0, 0.1, LIMIT_BY_SPREAD);
        assert_errors(of(Lvc, Streaming, spread), 1.0, 0.01, LIMIT_BY_SPREAD);
        assert_errors(of(Streaming, Lvc, spread), 0.045, 0.1, LIMIT_BY_SPREAD);
        assert_errors(of(Streaming, Megakernel, spread), 0.1, 0.01, LIMIT);
        let far = mean_difference(&film(3.0), 9.0, Lvc, &reference(Lvc), spread);
        assert!(far.is_wrong() && !of(Lvc, Lvc, spread).is_wrong(), "{far:?}");
        // Pixels may vary more than the spread of their sum happens to say.
        let small = Some(Spread { variance: 0.0, samples: 3, shared: 3 });
        assert_errors(of(Lvc, Lvc, small), 0.1, 0.01, LIMIT_BY_SPREAD);
    }

    #[test]
    fn longer_rounds_than_measured_share_more() {
        let spread = Spread { variance: 2.0, samples: 16, shared: 64 };
        assert_eq!(spread.of_mean(256.0), 0.5);
        assert_eq!(spread.of_mean(32.0), 2.0, "no more than there are");
        assert_eq!(spread.of_mean(4.0), 8.0);
        assert_eq!(variance(&[1.0, 3.0, 5.0]), 4.0);
    }
}
