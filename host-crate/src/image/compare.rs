//! How far one picture is from another, in numbers.

use super::similarity::{shown_luminance, structural_similarity};
use super::{ColorImage, Display, ImageError};
use glam::DVec3;
use serde::Serialize;

/// What [`compare()`] leaves to choose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ComparisonSettings {
    /// Added to the squared reference in relative errors, above 0: below its root, errors count as
    /// absolute ones.
    pub epsilon: f64,
    /// Share of the pixels, the worst ones, that the trimmed error leaves out, in 0..1.
    pub trim: f64,
    /// Side of a block in pixels; 0 counts as 1.
    pub block: u32,
    /// How the picture and the reference are shown where it is compared how alike they look.
    pub displays: [Display; 2],
}

impl Default for ComparisonSettings {
    /// 0.01, a thousandth, 16 pixels, both by the default display.
    fn default() -> Self {
        Self { epsilon: 0.01, trim: 0.001, block: 16, displays: [Display::default(); 2] }
    }
}

/// The errors of a picture `t` against a reference `r`. Not finite components count as 0, in either
/// picture.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// Root of the mean of `(t - r)^2` over pixels and components.
    pub rmse: f64,
    /// Mean of `(t - r)^2 / (r^2 + epsilon)` over pixels and components.
    pub relative_mse: f64,
    /// The same without the worst pixels (fireflies): what noise remains elsewhere.
    pub trimmed_relative_mse: f64,
    /// Structural similarity (SSIM) of what a screen shows of the luminance, by the windows of
    /// 11x11 pixels of Wang et al. 2004: 1 where the pictures look the same, at least -1; nothing
    /// if not one window fits into the picture.
    pub ssim: Option<f64>,
    /// Mean of `t` over pixels and components.
    pub mean_test: f64,
    /// Mean of `r` over pixels and components.
    pub mean_reference: f64,
    /// Ratio of the means, test by reference; nothing if the reference is black.
    pub ratio: Option<f64>,
    /// The same of red, green and blue alone.
    pub ratio_rgb: [Option<f64>; 3],
    /// Pixels of `t` that are not finite.
    pub non_finite_test: usize,
    /// Pixels of `r` that are not finite.
    pub non_finite_reference: usize,
    /// The errors of blocks; nothing if not one whole block fits into the picture or the reference
    /// is black.
    pub blocks: Option<BlockComparison>,
}

/// The errors of the averages over blocks of pixels: noise shrinks there, bias does not. Blocks
/// that the right and lower edges cut are left out. Errors are relative to the reference's mean.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BlockComparison {
    /// Side of a block in pixels.
    pub size: u32,
    /// Root of the mean squared error over blocks and components.
    pub rms: f64,
    /// The worst block's mean absolute error over its components.
    pub worst: f64,
    /// The worst block's top left pixel, x and y.
    pub worst_at: [u32; 2],
}

/// Compares `test` with `reference`.
///
/// # Errors
/// [`ImageError::SizesDiffer`] if they are not of one size.
pub fn compare(
    test: &ColorImage,
    reference: &ColorImage,
    settings: &ComparisonSettings,
) -> Result<Comparison, ImageError> {
    check_sizes(test, reference)?;
    let (non_finite_test, non_finite_reference) = (non_finite(test), non_finite(reference));
    let (width, height) = (reference.width as usize, reference.height as usize);
    let (test, reference) = (finite_pixels(test), finite_pixels(reference));
    let pixels = test.len().max(1) as f64;

    let (mut squares, mut sum_test, mut sum_reference) = (DVec3::ZERO, DVec3::ZERO, DVec3::ZERO);
    let mut relative = Vec::with_capacity(test.len());
    for (&t, &r) in test.iter().zip(&reference) {
        let square = (t - r) * (t - r);
        squares += square;
        relative.push(mean(square / (r * r + settings.epsilon)));
        sum_test += t;
        sum_reference += r;
    }
    let relative_mse = relative.iter().sum::<f64>() / pixels;
    let (mean_test, mean_reference) = (mean(sum_test) / pixels, mean(sum_reference) / pixels);
    Ok(Comparison {
        rmse: (mean(squares) / pixels).sqrt(),
        relative_mse,
        trimmed_relative_mse: trimmed_mean(&mut relative, settings.trim),
        ssim: structural_similarity(
            &shown_luminance(&test, &settings.displays[0]),
            &shown_luminance(&reference, &settings.displays[1]),
            width,
        ),
        mean_test,
        mean_reference,
        ratio: ratio(mean_test, mean_reference),
        ratio_rgb: std::array::from_fn(|i| ratio(sum_test[i], sum_reference[i])),
        non_finite_test,
        non_finite_reference,
        blocks: compare_blocks(
            &test,
            &reference,
            width,
            height,
            settings.block.max(1),
            mean_reference,
        ),
    })
}

/// The mean of `values` without the largest share `trim` of them, at least one being kept; 0 if
/// there are none. Sorts them.
pub fn trimmed_mean(values: &mut [f64], trim: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    let kept = (values.len() as f64 * (1.0 - trim)).round_ties_even() as usize;
    let kept = &values[..kept.clamp(values.len().min(1), values.len())];
    kept.iter().sum::<f64>() / kept.len().max(1) as f64
}

pub(super) fn check_sizes(test: &ColorImage, reference: &ColorImage) -> Result<(), ImageError> {
    let sizes = [(test.width, test.height), (reference.width, reference.height)];
    if sizes[0] != sizes[1] || test.pixels.len() != reference.pixels.len() {
        return Err(ImageError::SizesDiffer { test: sizes[0], reference: sizes[1] });
    }
    Ok(())
}

fn compare_blocks(
    test: &[DVec3],
    reference: &[DVec3],
    width: usize,
    height: usize,
    size: u32,
    mean_reference: f64,
) -> Option<BlockComparison> {
    let side = size as usize;
    let (columns, rows) = (width / side, height / side);
    if columns == 0 || rows == 0 || mean_reference == 0.0 {
        return None;
    }
    // Every whole block's mean difference.
    let mut errors = vec![DVec3::ZERO; columns * rows];
    let lines = test.chunks_exact(width).zip(reference.chunks_exact(width));
    for (y, (test, reference)) in lines.take(rows * side).enumerate() {
        for (x, (t, r)) in test.iter().zip(reference).take(columns * side).enumerate() {
            errors[y / side * columns + x / side] += t - r;
        }
    }
    let area = (side * side) as f64;
    let (mut squares, mut worst, mut worst_at) = (0.0, -1.0, 0);
    for (i, sum) in errors.iter().enumerate() {
        let error = *sum / area;
        squares += mean(error * error);
        if mean(error.abs()) > worst {
            (worst, worst_at) = (mean(error.abs()), i);
        }
    }
    Some(BlockComparison {
        size,
        rms: (squares / errors.len() as f64).sqrt() / mean_reference,
        worst: worst / mean_reference,
        worst_at: [(worst_at % columns * side) as u32, (worst_at / columns * side) as u32],
    })
}

fn non_finite(image: &ColorImage) -> usize {
    image.pixels.iter().filter(|p| !p.is_finite()).count()
}

fn finite_pixels(image: &ColorImage) -> Vec<DVec3> {
    image.pixels.iter().map(|p| p.as_dvec3().map(|c| if c.is_finite() { c } else { 0.0 })).collect()
}

fn mean(v: DVec3) -> f64 {
    v.element_sum() / 3.0
}

fn ratio(test: f64, reference: f64) -> Option<f64> {
    (reference != 0.0).then(|| test / reference)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::ToneMap;
    use glam::Vec3;

    fn image(width: u32, height: u32, pixel: impl Fn(u32, u32) -> Vec3) -> ColorImage {
        let pixels = (0..height)
            .flat_map(|y| (0..width).map(move |x| (x, y)))
            .map(|(x, y)| pixel(x, y))
            .collect();
        ColorImage { width, height, pixels }
    }

    fn close(a: f64, b: f64) {
        assert!((a - b).abs() <= 1e-12 * b.abs().max(1.0), "{a} is not {b}");
    }

    #[test]
    fn errors_by_hand() {
        // Two pixels: one right, one off by (1, 0, -2) from (1, 2, 4).
        let reference =
            image(2, 1, |x, _| if x == 0 { Vec3::ONE } else { Vec3::new(1.0, 2.0, 4.0) });
        let test = image(2, 1, |x, _| if x == 0 { Vec3::ONE } else { Vec3::new(2.0, 2.0, 2.0) });
        let settings =
            ComparisonSettings { epsilon: 1.0, trim: 0.5, block: 1, ..Default::default() };
        let c = compare(&test, &reference, &settings).unwrap();
        close(c.rmse, (5.0_f64 / 6.0).sqrt());
        close(c.relative_mse, (1.0 / 2.0 + 4.0 / 17.0) / 6.0);
        close(c.trimmed_relative_mse, 0.0);
        close(c.mean_test, 1.5);
        close(c.mean_reference, 10.0 / 6.0);
        close(c.ratio.unwrap(), 0.9);
        for (got, want) in c.ratio_rgb.iter().zip([3.0 / 2.0, 1.0, 3.0 / 5.0]) {
            close(got.unwrap(), want);
        }
        let blocks = c.blocks.unwrap();
        close(blocks.rms, (5.0_f64 / 6.0).sqrt() / (10.0 / 6.0));
        close(blocks.worst, 1.0 / (10.0 / 6.0));
        assert_eq!(blocks.worst_at, [1, 0]);
    }

    #[test]
    fn blocks_cancel_noise_and_skip_cut_ones() {
        let reference = image(9, 5, |_, _| Vec3::ONE);
        let noisy = |x: u32, y: u32| Vec3::splat(if (x + y).is_multiple_of(2) { 1.5 } else { 0.5 });
        // Biased in the block at (4, 0); wildly wrong where no whole block is.
        let test = image(9, 5, |x, y| match (x, y) {
            (8, _) | (_, 4) => Vec3::splat(100.0),
            (4..8, _) => noisy(x, y) + 0.25,
            _ => noisy(x, y),
        });
        let settings = ComparisonSettings { block: 4, ..Default::default() };
        let blocks = compare(&test, &reference, &settings).unwrap().blocks.unwrap();
        close(blocks.worst, 0.25);
        close(blocks.rms, 0.25 / 2.0_f64.sqrt());
        assert_eq!(blocks.worst_at, [4, 0]);
        let settings = ComparisonSettings { block: 6, ..Default::default() };
        assert_eq!(compare(&test, &reference, &settings).unwrap().blocks, None);
    }

    #[test]
    fn one_value_is_always_kept() {
        assert_eq!(trimmed_mean(&mut [4.0], 0.999), 4.0);
        assert_eq!(trimmed_mean(&mut [3.0, 1.0], 0.5), 1.0);
        assert_eq!(trimmed_mean(&mut [], 0.5), 0.0);
    }

    #[test]
    fn trimming_leaves_out_a_thousandth() {
        let reference = image(100, 20, |_, _| Vec3::ONE);
        let test = image(100, 20, |x, y| {
            Vec3::splat(if (x, y) == (7, 3) || (x, y) == (8, 9) { 1e4 } else { 2.0 })
        });
        let c = compare(&test, &reference, &ComparisonSettings::default()).unwrap();
        close(c.trimmed_relative_mse, 1.0 / 1.01);
        assert!(c.relative_mse > 1e4);
    }

    #[test]
    fn similarity_is_of_what_a_screen_shows() {
        let stripes =
            |x: u32, bright: f32| Vec3::splat(if x.is_multiple_of(4) { bright } else { 0.1 });
        let reference = image(20, 12, |x, _| stripes(x, 2.0));
        let brighter = image(20, 12, |x, _| stripes(x, 4.0));
        let clip = Display { exposure: 0.0, tone_map: ToneMap::Clip };
        let cut_off = ComparisonSettings { displays: [clip; 2], ..Default::default() };
        let ssim = |test: &ColorImage, settings: &ComparisonSettings| {
            compare(test, &reference, settings).unwrap().ssim.unwrap()
        };
        assert_eq!(ssim(&brighter, &cut_off), 1.0, "both are white");
        let soft = ssim(&brighter, &ComparisonSettings::default());
        assert!(0.9 < soft && soft < 1.0, "{soft}");
        // What is not finite is black, as everywhere.
        let broken = image(20, 12, |x, _| stripes(x, f32::INFINITY));
        let black = image(20, 12, |x, _| stripes(x, 0.0));
        assert_eq!(ssim(&broken, &cut_off), ssim(&black, &cut_off));
        let small = image(9, 20, |_, _| Vec3::ONE);
        assert_eq!(compare(&small, &small, &cut_off).unwrap().ssim, None);
    }

    #[test]
    fn what_is_not_finite_is_counted_and_black() {
        let reference = image(2, 2, |x, y| {
            if (x, y) == (1, 1) { Vec3::new(f32::INFINITY, 1.0, 1.0) } else { Vec3::ONE }
        });
        let test =
            image(2, 2, |x, _| if x == 0 { Vec3::new(1.0, f32::NAN, 1.0) } else { Vec3::ONE });
        let c = compare(&test, &reference, &ComparisonSettings::default()).unwrap();
        assert_eq!((c.non_finite_test, c.non_finite_reference), (2, 1));
        close(c.rmse, (3.0_f64 / 12.0).sqrt());
    }

    #[test]
    fn black_reference_has_no_ratio() {
        let c = compare(
            &image(1, 1, |_, _| Vec3::ONE),
            &image(1, 1, |_, _| Vec3::ZERO),
            &Default::default(),
        )
        .unwrap();
        assert_eq!((c.ratio, c.ratio_rgb, c.blocks), (None, [None; 3], None));
        close(c.relative_mse, 100.0);
    }

    #[test]
    fn sizes_must_agree() {
        let error = compare(
            &image(2, 3, |_, _| Vec3::ONE),
            &image(3, 2, |_, _| Vec3::ONE),
            &Default::default(),
        );
        let message = error.unwrap_err().to_string();
        assert!(message.contains("2x3") && message.contains("3x2"), "{message}");
    }
}
