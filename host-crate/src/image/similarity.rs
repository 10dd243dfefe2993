//! How alike two pictures look: the structural similarity index.
//!
//! After Wang, Bovik, Sheikh and Simoncelli, "Image Quality Assessment: From Error Visibility to
//! Structural Similarity", IEEE Transactions on Image Processing 13(4), 2004, with the parameters
//! that they give. Pictures are not made smaller first.

use super::tone::Display;
use crate::color::srgb_encode;
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Side of the window in pixels.
const WINDOW: usize = 11;
/// Standard deviation of its weights, a Gaussian, in pixels.
const SIGMA: f64 = 1.5;
/// K1 of the paper, squared: keeps the comparison of means calm where both are dark. The range of
/// values, L, is 1.
const C1: f64 = 0.01 * 0.01;
/// K2, squared: likewise for contrast.
const C2: f64 = 0.03 * 0.03;
/// The luminance of Rec. 709's primaries.
const LUMINANCE: Vec3 = Vec3::new(0.2126, 0.7152, 0.0722);

/// What a screen shows of colours: the luminance after the tone map, encoded as sRGB, in 0..1.
pub(super) fn shown_luminance(pixels: &[DVec3], display: &Display) -> Vec<f64> {
    let shown = |pixel: &DVec3| {
        let luminance = display.mapped(pixel.as_vec3()).dot(LUMINANCE).clamp(0.0, 1.0);
        f64::from(srgb_encode(luminance))
    };
    pixels.par_iter().map(shown).collect()
}

/// The mean structural similarity of two pictures of values in 0..1, `width` in a row, over all
/// windows that lie in them: 1 where they are the same, symmetric, at least -1. None where no whole
/// window fits.
pub(super) fn structural_similarity(a: &[f64], b: &[f64], width: usize) -> Option<f64> {
    let height = a.len().checked_div(width)?;
    if width < WINDOW || height < WINDOW {
        return None;
    }
    let weights = weights();
    let row = |y: usize| {
        let window = y * width..(y + WINDOW) * width;
        similarity_of_row(&a[window.clone()], &b[window], width, &weights)
    };
    let (rows, columns) = (height - WINDOW + 1, width - WINDOW + 1);
    // Summed in order: the result must not go by how the rows are spread over threads.
    let sums: Vec<f64> = (0..rows).into_par_iter().map(row).collect();
    Some(sums.iter().sum::<f64>() / (rows * columns) as f64)
}

/// The weights of the window along an axis; their sum is 1.
fn weights() -> [f64; WINDOW] {
    let weights: [f64; WINDOW] = std::array::from_fn(|i| {
        let distance = i as f64 - (WINDOW / 2) as f64;
        (-0.5 * (distance / SIGMA).powi(2)).exp()
    });
    let sum: f64 = weights.iter().sum();
    weights.map(|weight| weight / sum)
}

/// Weighted means of a, b, aa, bb and ab.
type Moments = [f64; 5];

/// The sum of the similarities of all windows in as many rows as a window has.
fn similarity_of_row(a: &[f64], b: &[f64], width: usize, weights: &[f64; WINDOW]) -> f64 {
    let mut columns: Vec<Moments> = vec![[0.0; 5]; width];
    for (weight, (a, b)) in weights.iter().zip(a.chunks_exact(width).zip(b.chunks_exact(width))) {
        for (column, (&a, &b)) in columns.iter_mut().zip(a.iter().zip(b)) {
            add(column, *weight, &[a, b, a * a, b * b, a * b]);
        }
    }
    let similarity = |window: &[Moments]| {
        let mut moments = [0.0; 5];
        for (weight, column) in weights.iter().zip(window) {
            add(&mut moments, *weight, column);
        }
        similarity_of_window(moments)
    };
    columns.windows(WINDOW).map(similarity).sum()
}

fn add(sums: &mut Moments, weight: f64, moments: &Moments) {
    for (sum, moment) in sums.iter_mut().zip(moments) {
        *sum += weight * moment;
    }
}

/// Equation 13 of the paper.
fn similarity_of_window([a, b, aa, bb, ab]: Moments) -> f64 {
    let (squares, product) = (a * a + b * b, a * b);
    let (variances, covariance) = (aa - a * a + (bb - b * b), ab - product);
    (2.0 * product + C1) * (2.0 * covariance + C2) / ((squares + C1) * (variances + C2))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::ToneMap;

    const SIZE: [usize; 2] = [16, 13];

    fn picture(value: impl Fn(usize, usize) -> f64) -> Vec<f64> {
        (0..SIZE[0] * SIZE[1]).map(|p| value(p % SIZE[0], p / SIZE[0])).collect()
    }

    fn similarity(a: &[f64], b: &[f64]) -> f64 {
        structural_similarity(a, b, SIZE[0]).unwrap()
    }

    /// Without structure, but always the same, in 0..1.
    fn noise(x: usize, y: usize) -> f64 {
        ((x * 37 + y * 101 + x * y * 13) % 97) as f64 / 96.0
    }

    fn waves(x: usize, y: usize) -> f64 {
        ((x * 7 + y * 3) % 32) as f64 / 31.0
    }

    /// The definition: a window after the other, means first, then what deviates from them.
    fn by_definition(a: &[f64], b: &[f64]) -> f64 {
        let [width, height] = SIZE;
        let gaussian = |i: usize, j: usize| {
            let squared = (i as f64 - 5.0).powi(2) + (j as f64 - 5.0).powi(2);
            (-squared / (2.0 * 1.5 * 1.5)).exp()
        };
        let window: Vec<_> = (0..121).map(|k| (k % 11, k / 11)).collect();
        let whole: f64 = window.iter().map(|&(i, j)| gaussian(i, j)).sum();
        let mut values = Vec::new();
        for (x, y) in (0..height - 10).flat_map(|y| (0..width - 10).map(move |x| (x, y))) {
            let mean = |value: &dyn Fn(usize) -> f64| {
                let weighted = |&(i, j): &(usize, usize)| {
                    gaussian(i, j) / whole * value((y + j) * width + x + i)
                };
                window.iter().map(weighted).sum::<f64>()
            };
            let (mean_a, mean_b) = (mean(&|p| a[p]), mean(&|p| b[p]));
            let variance_a = mean(&|p| (a[p] - mean_a).powi(2));
            let variance_b = mean(&|p| (b[p] - mean_b).powi(2));
            let covariance = mean(&|p| (a[p] - mean_a) * (b[p] - mean_b));
            let luminance =
                (2.0 * mean_a * mean_b + 1e-4) / (mean_a.powi(2) + mean_b.powi(2) + 1e-4);
            values.push(luminance * (2.0 * covariance + 9e-4) / (variance_a + variance_b + 9e-4));
        }
        values.iter().sum::<f64>() / values.len() as f64
    }

    #[test]
    fn what_is_the_same_has_exactly_one() {
        for picture in [picture(noise), picture(waves), picture(|_, _| 0.0), picture(|_, _| 1.0)] {
            assert_eq!(similarity(&picture, &picture), 1.0);
        }
    }

    /// The numbers are those of scikit-image 0.26 (`structural_similarity` with Gaussian weights of
    /// sigma 1.5, a range of 1 and no sample covariance), another implementation of the paper.
    #[test]
    fn known_values() {
        let (noise, waves) = (picture(noise), picture(waves));
        let brighter: Vec<_> = waves.iter().map(|v| 0.5 + 0.5 * v).collect();
        for (a, b, known) in [
            (&noise, &waves, -0.114_910_087_559_550_01),
            (&waves, &brighter, 0.742_176_595_640_153_9),
        ] {
            let value = similarity(a, b);
            assert!((value - known).abs() < 1e-12, "{value} is not {known}");
            assert!((value - by_definition(a, b)).abs() < 1e-12, "{value}");
            assert_eq!(value, similarity(b, a), "it is symmetric");
        }
        // Without structure what is left is the comparison of means.
        let value = similarity(&picture(|_, _| 0.25), &picture(|_, _| 0.75));
        let known = (2.0 * 0.25 * 0.75 + 1e-4) / (0.25 * 0.25 + 0.75 * 0.75 + 1e-4);
        assert!((value - known).abs() < 1e-12, "{value} is not {known}");
    }

    #[test]
    fn it_falls_with_noise_and_below_zero_where_structure_is_inverted() {
        let truth = picture(waves);
        let mut before = 1.0;
        for strength in [0.05, 0.1, 0.2, 0.4, 0.8] {
            let noisy = picture(|x, y| waves(x, y) + strength * (noise(x, y) - 0.5));
            let value = similarity(&truth, &noisy);
            assert!(value < before, "{value} at {strength}, {before} before");
            before = value;
        }
        let inverted: Vec<_> = truth.iter().map(|v| 1.0 - v).collect();
        let value = similarity(&truth, &inverted);
        assert!((-1.0..-0.5).contains(&value), "{value}");
    }

    #[test]
    fn a_window_must_fit() {
        for (width, height, fits) in
            [(11, 11, true), (10, 40, false), (40, 10, false), (0, 0, false), (12, 0, false)]
        {
            let picture = vec![0.5; width * height];
            let value = structural_similarity(&picture, &picture, width);
            assert_eq!(value, fits.then_some(1.0), "{width}x{height}");
        }
    }

    #[test]
    fn a_screen_shows_luminance_up_to_white() {
        let pixels = [DVec3::ZERO, DVec3::ONE, DVec3::splat(0.18), DVec3::Y, DVec3::splat(1e30)];
        let clip = Display { exposure: 0.0, tone_map: ToneMap::Clip };
        let shown = shown_luminance(&pixels, &clip);
        for (value, known) in shown.iter().zip([0.0, 1.0, 0.461_356, 0.862_481, 1.0]) {
            assert!((value - known).abs() < 1e-5, "{shown:?}");
        }
        let soft = shown_luminance(&[DVec3::splat(2.0), DVec3::splat(4.0)], &Display::default());
        assert!(0.9 < soft[0] && soft[0] < soft[1] && soft[1] < 1.0, "{soft:?}");
    }
}
