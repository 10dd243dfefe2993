//! Whether two renders are of one scene: their difference in standard errors.

use super::{ColorImage, ImageError};
use glam::{DVec3, Vec3};
use serde::Serialize;
use std::f64::consts::TAU;

/// Share of the pixels, the worst ones, that are left out as fireflies: a rare bright path that
/// only one of the pictures has found says nothing of the rest, and its pixel's variance is not
/// known before it is found.
const FIREFLIES: f64 = 0.001;

/// How far a render is from another.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Agreement {
    /// Ratio of the means over all pixels and components, test by reference, fireflies included.
    pub mean_ratio: f64,
    /// The largest difference of a block's mean in one component, in standard errors of that
    /// difference.
    pub worst_block: f64,
    /// That block's top left pixel, x and y.
    pub worst_at: [u32; 2],
    /// Blocks that were compared.
    pub blocks: usize,
    /// Standard errors that the worst block of two renders of one scene is beyond in one of a
    /// thousand comparisons.
    pub limit: f64,
    /// Pixels whose variance is not known: they have fewer than two samples.
    pub unknown: usize,
    /// Pixels left out as fireflies.
    pub fireflies: usize,
}

/// How often two renders of one scene are beyond the limit of [`Agreement`] by chance.
const FALSE_ALARMS: f64 = 1e-3;

impl Agreement {
    /// Whether the pictures differ by no more than noise makes renders of one scene differ; none
    /// where too many variances are not known to say so.
    pub fn is_same_scene(&self) -> Option<bool> {
        if self.unknown > self.fireflies {
            return None;
        }
        Some(self.worst_block <= self.limit)
    }
}

/// Standard errors that one of `count` normal variables is beyond with a probability of at most
/// [`FALSE_ALARMS`]: by the bound e^(-z^2 / 2) / (z sqrt(2 pi)) of each tail.
fn limit(count: usize) -> f64 {
    let each = FALSE_ALARMS / (2.0 * count.max(1) as f64);
    let tail = |z: f64| (-0.5 * z * z).exp() / (z * TAU.sqrt());
    // Halves the interval that the limit lies in until nothing is left of it.
    let (mut low, mut high) = (1.0, 40.0);
    for _ in 0..64 {
        let middle = 0.5 * (low + high);
        if tail(middle) > each { low = middle } else { high = middle }
    }
    high
}

/// Compares `test` with an independent `reference` by blocks of `block` (width, height) pixels;
/// those cut by the right and lower edges count too.
///
/// `variance` is the variance of each pixel's mean in `test`, which took `samples_ratio` times as
/// many samples per pixel as the reference did; the reference is taken to have the same variance
/// per sample.
///
/// # Errors
/// [`ImageError::SizesDiffer`] if the pictures are not of one size.
pub fn agreement(
    test: &ColorImage,
    variance: &[Vec3],
    samples_ratio: f64,
    reference: &ColorImage,
    block: [u32; 2],
) -> Result<Agreement, ImageError> {
    super::compare::check_sizes(test, reference)?;
    let differences: Vec<Difference> = test
        .pixels
        .iter()
        .zip(&reference.pixels)
        .zip(variance)
        .map(|((&test, &reference), &variance)| {
            Difference::new(test, reference, variance, samples_ratio)
        })
        .collect();
    let is_firefly = fireflies(&differences);
    let sum =
        |image: &ColorImage| image.pixels.iter().map(|p| p.as_dvec3().element_sum()).sum::<f64>();
    let mut result = Agreement {
        mean_ratio: sum(test) / sum(reference),
        worst_block: 0.0,
        worst_at: [0, 0],
        blocks: 0,
        limit: 0.0,
        unknown: variance.iter().filter(|variance| !variance.is_finite()).count(),
        fireflies: is_firefly.iter().filter(|&&is| is).count(),
    };
    for top in (0..test.height).step_by(block[1].max(1) as usize) {
        for left in (0..test.width).step_by(block[0].max(1) as usize) {
            let rows = top..test.height.min(top + block[1]);
            let pixels = rows.flat_map(|y| {
                (left..test.width.min(left + block[0])).map(move |x| (y * test.width + x) as usize)
            });
            let errors = pixels
                .filter(|&pixel| !is_firefly[pixel])
                .fold(Difference::default(), |sum, pixel| sum.plus(differences[pixel]))
                .in_errors();
            // NaN must not pass for agreement.
            if errors > result.worst_block || errors.is_nan() {
                (result.worst_block, result.worst_at) = (errors, [left, top]);
            }
            result.blocks += 1;
        }
    }
    result.limit = limit(3 * result.blocks);
    Ok(result)
}

/// The difference of a pixel, or the sum of some pixels' differences.
#[derive(Clone, Copy, Default)]
struct Difference {
    value: DVec3,
    variance: DVec3,
}

impl Difference {
    fn new(test: Vec3, reference: Vec3, variance: Vec3, samples_ratio: f64) -> Self {
        // What never varies, such as a lamp seen directly, still differs by rounding.
        let rounding = reference.as_dvec3() * 1e-5;
        Self {
            value: test.as_dvec3() - reference.as_dvec3(),
            variance: variance.as_dvec3() * (1.0 + samples_ratio) + rounding * rounding,
        }
    }

    fn plus(self, other: Self) -> Self {
        Self { value: self.value + other.value, variance: self.variance + other.variance }
    }

    /// In standard errors, of the component that is furthest off.
    fn in_errors(self) -> f64 {
        (0..3).fold(0.0_f64, |worst, c| match self.value[c] {
            0.0 => worst,
            d => worst.max(d.abs() / self.variance[c].sqrt()),
        })
    }
}

/// Which pixels are left out: the share [`FIREFLIES`] of the furthest off.
fn fireflies(differences: &[Difference]) -> Vec<bool> {
    let mut by_error: Vec<usize> = (0..differences.len()).collect();
    by_error.sort_by(|&a, &b| differences[b].in_errors().total_cmp(&differences[a].in_errors()));
    let count = (differences.len() as f64 * FIREFLIES).ceil() as usize;
    let mut is_firefly = vec![false; differences.len()];
    by_error.iter().take(count).for_each(|&pixel| is_firefly[pixel] = true);
    is_firefly
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(value: impl Fn(usize) -> f32) -> ColorImage {
        ColorImage {
            width: 40,
            height: 50,
            pixels: (0..2000).map(|p| Vec3::splat(value(p))).collect(),
        }
    }

    #[test]
    fn a_shifted_block_stands_out_and_a_firefly_does_not() {
        let noise = |p: usize| if p.is_multiple_of(2) { 1.1 } else { 0.9 };
        let variance = vec![Vec3::splat(0.005); 2000];
        let reference = image(|_| 1.0);
        let with_firefly = image(|p| if p == 77 { 900.0 } else { noise(p) });
        let same = agreement(&with_firefly, &variance, 1.0, &reference, [10, 10]).unwrap();
        assert!(same.worst_block < 1.0 && same.blocks == 20 && same.fireflies == 2, "{same:?}");

        let shifted = image(|p| noise(p) + if p % 40 >= 30 && p >= 1600 { 0.1 } else { 0.0 });
        let differs = agreement(&shifted, &variance, 1.0, &reference, [10, 10]).unwrap();
        // 100 pixels, each 0.1 off with a standard error of 0.1: 10 standard errors, less what two
        // fireflies take away.
        assert!((9.5..10.5).contains(&differs.worst_block), "{differs:?}");
        assert_eq!(differs.worst_at, [30, 40]);
        assert_eq!((same.is_same_scene(), differs.is_same_scene()), (Some(true), Some(false)));

        let mut unknown = variance;
        unknown[..3].fill(Vec3::INFINITY);
        let unsure = agreement(&shifted, &unknown, 1.0, &reference, [10, 10]).unwrap();
        assert_eq!((unsure.unknown, unsure.is_same_scene()), (3, None));
    }

    /// Quantiles of the normal distribution from tables, which the bound is a little above.
    #[test]
    fn limits_are_quantiles() {
        for (count, quantile) in [(1, 3.2905), (10, 3.8906), (100, 4.4172), (1000, 4.8916)] {
            let limit = limit(count);
            assert!(limit > quantile && limit < quantile + 0.03, "{count}: {limit}");
        }
    }
}
