//! How far one picture is from another, as a picture.

use super::compare::check_sizes;
use super::{ColorImage, ImageError};
use glam::{Mat3, Vec3};

/// A picture of where `test` is brighter than `reference` (red), darker (blue), and equal (white),
/// with the scale as a bar below it: its ends stand for -1 and +1, its ticks for -1/2, 0 and +1/2.
///
/// The scale measures the mean over the components of `test - reference`, relative to the mean of
/// the reference plus 0.1, times `gain`: at a gain of 4 the full colour stands for a quarter too
/// much or too little. Equal errors of either sign are equally dark, so no sign looks worse. A
/// pixel that is not finite in either picture is green. The result is linear and made for
/// [`ToneMap::Clip`](super::ToneMap::Clip) at exposure 0.
///
/// # Errors
/// [`ImageError::SizesDiffer`] if they are not of one size.
pub fn difference(
    test: &ColorImage,
    reference: &ColorImage,
    gain: f32,
) -> Result<ColorImage, ImageError> {
    check_sizes(test, reference)?;
    let mut pixels: Vec<Vec3> = test
        .pixels
        .iter()
        .zip(&reference.pixels)
        .map(|(&t, &r)| {
            if !t.is_finite() || !r.is_finite() {
                return Vec3::Y;
            }
            diverging((t - r).element_sum() / 3.0 / (r.element_sum() / 3.0 + 0.1) * gain)
        })
        .collect();
    let bar = legend_height(test.height);
    for y in 0..bar {
        pixels.extend((0..test.width).map(|x| legend(x, y, test.width, bar)));
    }
    Ok(ColorImage { width: test.width, height: test.height + bar, pixels })
}

/// Height of the bar, its dark upper edge included, under a picture of so many rows.
fn legend_height(height: u32) -> u32 {
    (height / 30).clamp(4, 40)
}

fn legend(x: u32, y: u32, width: u32, height: u32) -> Vec3 {
    let last = width.saturating_sub(1).max(1);
    let tick = (1..4).any(|quarter| x == quarter * last / 4);
    if y == 0 || tick && y <= height / 3 {
        return Vec3::ZERO;
    }
    diverging(2.0 * x as f32 / last as f32 - 1.0)
}

/// Blue at -1 (and below), white at 0, red at +1: a straight line in Oklab on either side, both of
/// one lightness and one chroma at their ends.
fn diverging(value: f32) -> Vec3 {
    const WHITE: f32 = 0.97;
    const END: f32 = 0.45;
    const CHROMA: f32 = 0.17;
    // sRGB's own red and blue.
    const RED_HUE: f32 = 29.2;
    const BLUE_HUE: f32 = 264.1;
    // A NaN can only come of a gain that is none.
    let amount = value.abs().min(1.0);
    let hue = if value > 0.0 { RED_HUE } else { BLUE_HUE };
    let (sin, cos) = hue.to_radians().sin_cos();
    let chroma = CHROMA * amount;
    oklab(Vec3::new(WHITE + (END - WHITE) * amount, chroma * cos, chroma * sin))
        .clamp(Vec3::ZERO, Vec3::ONE)
}

/// Linear Rec.709 of an Oklab colour.
fn oklab(lab: Vec3) -> Vec3 {
    const TO_LMS: Mat3 = Mat3::from_cols(
        Vec3::ONE,
        Vec3::new(0.396_337_78, -0.105_561_346, -0.089_484_18),
        Vec3::new(0.215_803_76, -0.063_854_17, -1.291_485_5),
    );
    const TO_RGB: Mat3 = Mat3::from_cols(
        Vec3::new(4.076_741_7, -1.268_438, -0.004_196_086_3),
        Vec3::new(-3.307_711_6, 2.609_757_4, -0.703_418_6),
        Vec3::new(0.230_969_94, -0.341_319_4, 1.707_614_7),
    );
    TO_RGB * (TO_LMS * lab).map(|c| c * c * c)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flat(width: u32, height: u32, value: f32) -> ColorImage {
        ColorImage { width, height, pixels: vec![Vec3::splat(value); (width * height) as usize] }
    }

    #[test]
    fn sign_shows_as_hue() {
        let [brighter, equal, darker] =
            [1.5, 1.0, 0.5].map(|v| difference(&flat(1, 1, v), &flat(1, 1, 1.0), 4.0));
        let first = |image: Result<ColorImage, ImageError>| image.unwrap().pixels[0];
        let (red, white, blue) = (first(brighter), first(equal), first(darker));
        assert!(red.x > 0.3 && red.x > 5.0 * red.y.max(red.z), "{red}");
        assert!(blue.z > 0.3 && blue.z > 3.0 * blue.x.max(blue.y), "{blue}");
        assert!(
            white.min_element() > 0.85 && white.max_element() - white.min_element() < 1e-3,
            "{white}"
        );
    }

    #[test]
    fn scale_is_relative_and_saturates() {
        let at = |t: f32, r: f32, gain: f32| {
            difference(&flat(1, 1, t), &flat(1, 1, r), gain).unwrap().pixels[0]
        };
        // 0.22 / (0.9 + 0.1) * 2 = 0.44
        assert!(at(1.12, 0.9, 2.0).abs_diff_eq(diverging(0.44), 1e-5));
        assert_eq!(at(100.0, 1.0, 4.0), diverging(1.0));
        assert_ne!(diverging(0.9), diverging(1.0));
    }

    #[test]
    fn both_ends_are_equally_dark() {
        // Oklab lightness is what the map holds equal; no end may have been cut by the range of
        // sRGB.
        for value in [-1.0_f32, -0.5, 0.5, 1.0] {
            let amount = value.abs();
            let (sin, cos) = (if value > 0.0 { 29.2_f32 } else { 264.1 }).to_radians().sin_cos();
            let chroma = 0.17 * amount;
            let unclamped = oklab(Vec3::new(0.97 - 0.52 * amount, chroma * cos, chroma * sin));
            assert!(
                unclamped.min_element() >= 0.0 && unclamped.max_element() <= 1.0,
                "{value}: {unclamped}"
            );
        }
    }

    #[test]
    fn legend_lies_below_and_strange_pixels_are_green() {
        let mut test = flat(65, 60, 1.0);
        test.pixels[3].y = f32::NAN;
        let image = difference(&test, &flat(65, 60, 1.0), 4.0).unwrap();
        assert_eq!((image.width, image.height), (65, 64));
        assert_eq!(image.pixels.len(), 65 * 64);
        assert_eq!(image.pixels[3], Vec3::Y);
        let last_row = &image.pixels[65 * 63..];
        assert_eq!(
            (last_row[0], last_row[32], last_row[64]),
            (diverging(-1.0), diverging(0.0), diverging(1.0))
        );
        assert_eq!(image.pixels[65 * 61 + 32], Vec3::ZERO, "a tick at 0");
        assert!(difference(&flat(1, 2, 1.0), &flat(2, 1, 1.0), 4.0).is_err());
        difference(&flat(1, 1, 1.0), &flat(1, 1, 1.0), 4.0).unwrap();
    }
}
