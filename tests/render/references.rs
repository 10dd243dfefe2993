//! The large scenes against pictures that another renderer made: Mitsuba 3.9.1, 800x600, 8192
//! independent samples a pixel.

use glam::Vec3;
use raystream::image::{ColorImage, agreement, read_color};
use raystream::render::Settings;
use raystream::scene::{self, FilmSize};
use raystream_tests::{prepare, render, settings};

/// Samples of the references.
const REFERENCE_SAMPLES: f64 = 8192.0;
/// The references' pixels that make one of ours, along each side: with a box filter one of ours is
/// their mean.
const REDUCTION: u32 = 5;
/// Blocks of 40x30 of the references' pixels.
const BLOCK: [u32; 2] = [40 / REDUCTION, 30 / REDUCTION];

/// The reference at our size, and the variance of one sample of each of our pixels as the reference
/// knows it: from the differences among the pixels that make one.
///
/// A caustic of rare, bright paths has a variance that a short render does not know of before it
/// finds one; the reference has found them. Where the picture itself varies within a pixel this is
/// too large, which makes the test weaker there, not wrong.
fn reduce(image: &ColorImage) -> (ColorImage, Vec<Vec3>) {
    let (width, height) = (image.width / REDUCTION, image.height / REDUCTION);
    let count = (REDUCTION * REDUCTION) as f32;
    let mut pixels = Vec::new();
    let mut variance = Vec::new();
    for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
        let parts = || {
            (0..REDUCTION * REDUCTION).map(|k| {
                let (dx, dy) = (k % REDUCTION, k / REDUCTION);
                image.pixels[((y * REDUCTION + dy) * image.width + x * REDUCTION + dx) as usize]
            })
        };
        let mean = parts().sum::<Vec3>() / count;
        let spread =
            parts().map(|part| (part - mean) * (part - mean)).sum::<Vec3>() / (count - 1.0);
        pixels.push(mean);
        variance.push(spread * REFERENCE_SAMPLES as f32);
    }
    (ColorImage { width, height, pixels }, variance)
}

/// The standard error of the mean of all pixels and components, by the variances of the pixels. The
/// components of a pixel are taken to err together.
fn error_of_mean(variance: &[Vec3]) -> f64 {
    let squares = variance.iter().map(|v| {
        let deviation = v.to_array().map(|c| f64::from(c).sqrt()).iter().sum::<f64>() / 3.0;
        deviation * deviation
    });
    squares.sum::<f64>().sqrt() / variance.len() as f64
}

/// Asserts that the mean and every block are within 4 standard errors of both pictures.
fn assert_agrees(name: &str, samples: u32) {
    let Some(folder) = raystream_tests::large_scenes() else { return };
    let scene = scene::load(&folder.join(name).join(name).with_extension("json")).unwrap();
    let (reference, variance_of_sample) =
        reduce(&read_color(&folder.join(name).join("reference.exr")).unwrap());
    let size = FilmSize { width: reference.width, height: reference.height };
    let film = render(&prepare(&scene), &Settings { size, seed: 11, ..settings(&scene) }, samples);
    let samples_ratio = f64::from(samples) / (REFERENCE_SAMPLES * f64::from(REDUCTION * REDUCTION));
    let variance: Vec<Vec3> = film
        .variance()
        .iter()
        .zip(variance_of_sample)
        .map(|(own, v)| own.max(v / samples as f32))
        .collect();
    let result =
        agreement(&ColorImage::from_film(&film), &variance, samples_ratio, &reference, BLOCK)
            .unwrap();
    let reference_mean = reference.pixels.iter().map(|p| f64::from(p.element_sum())).sum::<f64>()
        / (3 * reference.pixels.len()) as f64;
    let error = error_of_mean(&variance) * (1.0 + samples_ratio).sqrt() / reference_mean;
    assert!((result.mean_ratio - 1.0).abs() < 4.0 * error, "{name}, {error}: {result:?}");
    assert!(result.worst_block < 4.0, "{name}: {result:?}");
}

#[test]
fn cornell_ball_agrees_with_its_reference() {
    assert_agrees("cornell_ball", 1024);
}

#[test]
fn sibenik_agrees_with_its_reference() {
    assert_agrees("sibenik", 128);
}

#[test]
fn conference_agrees_with_its_reference() {
    assert_agrees("conference", 192);
}
