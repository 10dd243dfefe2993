//! Tests of agreement with a stated confidence.

use glam::DVec3;
use raystream::film::Film;

/// Sum over the pixels of a film, by component, and the variance of that sum.
fn total(film: &Film, pixels: impl Iterator<Item = usize> + Clone) -> (DVec3, DVec3) {
    let (color, variance) = (film.color(), film.variance());
    (
        pixels.clone().map(|p| color[p].as_dvec3()).sum(),
        pixels.map(|p| variance[p].as_dvec3()).sum(),
    )
}

/// Asserts that two independent renders have the same expectation, for the whole picture and for
/// every block of 4x4 pixels. Their samples must be independent.
///
/// Each comparison is a z-test by colour component. The limit is Bonferroni's for a false alarm in
/// 1 of 10^4 test runs: about 5 standard errors for some 40 comparisons.
pub fn assert_same_expectation(a: &Film, b: &Film, what: &str) {
    assert_eq!((a.width, a.height), (b.width, b.height));
    let total_of = |film| move |pixels: &[usize]| total(film, pixels.iter().copied());
    assert_same_totals(a.width as usize, a.height as usize, &total_of(a), &total_of(b), what);
}

/// [`assert_same_expectation`] of a render whose samples are independent and of one whose rounds
/// are, though samples within a round may not be: `rounds` are pictures, row by row from the top.
/// Their spread tells the standard error, so there must be many.
pub fn assert_rounds_have_expectation(film: &Film, rounds: &[Vec<DVec3>], what: &str) {
    assert!(rounds.len() >= 100, "{what}: too few rounds to tell their spread");
    let of_rounds = |pixels: &[usize]| {
        let totals: Vec<DVec3> =
            rounds.iter().map(|round| pixels.iter().map(|&p| round[p]).sum()).collect();
        let count = totals.len() as f64;
        let mean = totals.iter().sum::<DVec3>() / count;
        let spread = totals.iter().map(|total| (*total - mean) * (*total - mean)).sum::<DVec3>()
            / (count - 1.0);
        (mean, spread / count)
    };
    let of_film = |pixels: &[usize]| total(film, pixels.iter().copied());
    assert_same_totals(film.width as usize, film.height as usize, &of_rounds, &of_film, what);
}

/// Sum over some pixels, by component, and the variance of that sum.
type Total<'a> = &'a dyn Fn(&[usize]) -> (DVec3, DVec3);

fn assert_same_totals(width: usize, height: usize, a: Total<'_>, b: Total<'_>, what: &str) {
    let mut regions: Vec<(String, Vec<usize>)> =
        vec![("picture".into(), (0..width * height).collect())];
    for top in (0..height).step_by(4) {
        for left in (0..width).step_by(4) {
            let pixels = (top..height.min(top + 4))
                .flat_map(|y| (left..width.min(left + 4)).map(move |x| y * width + x))
                .collect();
            regions.push((format!("block at ({left}, {top})"), pixels));
        }
    }
    let limit = normal_quantile(1.0 - 0.5e-4 / (3 * regions.len()) as f64);
    for (name, pixels) in regions {
        let (mean_a, variance_a) = a(&pixels);
        let (mean_b, variance_b) = b(&pixels);
        for channel in 0..3 {
            let error = (variance_a[channel] + variance_b[channel]).sqrt();
            let difference = (mean_a[channel] - mean_b[channel]).abs();
            // Where nothing varies (black, or lit by the lamp's own light alone) only rounding may
            // differ.
            let rounding = 1e-5 * mean_a[channel].abs().max(mean_b[channel].abs());
            assert!(
                difference <= limit * error + rounding,
                "{what}: {name}, channel {channel}: {} and {} differ by {:.1} standard errors, \
                 {limit:.1} are allowed",
                mean_a[channel] / pixels.len() as f64,
                mean_b[channel] / pixels.len() as f64,
                difference / error,
            );
        }
    }
}

/// Pearson's test that `counts` were drawn with the probabilities `expected` (in counts, same sum);
/// cells with an expectation under 5 are put together. Fails where chance would give as large a
/// deviation in less than 1 of 10^5 cases.
pub fn assert_chi_square(counts: &[u32], expected: &[f64], what: &str) {
    assert_eq!(counts.len(), expected.len());
    let (mut statistic, mut cells) = (0.0, 0_u32);
    let (mut pooled_count, mut pooled_expected) = (0.0, 0.0);
    for (&count, &expected) in counts.iter().zip(expected) {
        if expected >= 5.0 {
            statistic += (f64::from(count) - expected).powi(2) / expected;
            cells += 1;
        } else {
            pooled_count += f64::from(count);
            pooled_expected += expected;
        }
    }
    if pooled_expected >= 5.0 {
        statistic += (pooled_count - pooled_expected).powi(2) / pooled_expected;
        cells += 1;
    } else {
        assert!(
            pooled_count <= pooled_expected + 25.0,
            "{what}: {pooled_count} where {pooled_expected} were expected"
        );
    }
    assert!(cells > 1, "{what}: too few samples for the test");
    let limit = chi_square_quantile(1.0 - 1e-5, f64::from(cells - 1));
    assert!(
        statistic <= limit,
        "{what}: chi-square {statistic:.1} over {cells} cells, {limit:.1} is the limit"
    );
}

/// The quantile of the chi-square distribution: Wilson and Hilferty's approximation, within
/// 1 % beyond 5 degrees of freedom.
pub fn chi_square_quantile(probability: f64, degrees: f64) -> f64 {
    let z = normal_quantile(probability);
    let h = 2.0 / (9.0 * degrees);
    degrees * (1.0 - h + z * h.sqrt()).powi(3)
}

/// The quantile of the normal distribution, by bisection.
pub fn normal_quantile(probability: f64) -> f64 {
    let (mut low, mut high) = (-10.0, 10.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if normal_distribution(middle) < probability { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// The normal distribution: a series in the middle, a continued fraction in the tails.
fn normal_distribution(x: f64) -> f64 {
    let tail = |x: f64| {
        // Continued fraction of Mills' ratio, evaluated from the inside.
        let mut fraction = 0.0;
        for k in (1..=200).rev() {
            fraction = f64::from(k) / (x + fraction);
        }
        (-0.5 * x * x).exp() / (2.0 * std::f64::consts::PI).sqrt() / (x + fraction)
    };
    match x {
        x if x > 0.5 => 1.0 - tail(x),
        x if x < -0.5 => tail(-x),
        x => {
            // Taylor series of the integral of the density.
            let (mut term, mut sum) = (x, x);
            for k in 1..40 {
                term *= -x * x / (2.0 * f64::from(k));
                sum += term / f64::from(2 * k + 1);
            }
            0.5 + sum / (2.0 * std::f64::consts::PI).sqrt()
        }
    }
}

/// Mean and its standard error.
pub fn mean_and_error(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (mean, (variance / n).sqrt())
}
