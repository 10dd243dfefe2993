//! The large scenes against pictures that another renderer made: Mitsuba 3.9.1, 800x600, 8192 independent samples a pixel.

mod common;

use common::{prepare, render, settings};
use glam::Vec3;
use raystream::image::{ColorImage, agreement, read_color};
use raystream::render::Settings;
use raystream::scene::{self, FilmSize};

/// Samples of the references.
const REFERENCE_SAMPLES: f64 = 8192.0;
/// The references' pixels that make one of ours, along each side: with a box filter one of ours is their mean.
const REDUCTION: u32 = 5;
/// Blocks of 40x30 of the references' pixels.
const BLOCK: [u32; 2] = [40 / REDUCTION, 30 / REDUCTION];

fn reduce(image: &ColorImage) -> ColorImage {
    let (width, height) = (image.width / REDUCTION, image.height / REDUCTION);
    let mean = |x: u32, y: u32| {
        let pixels = (0..REDUCTION * REDUCTION).map(|k| {
            let (dx, dy) = (k % REDUCTION, k / REDUCTION);
            image.pixels[((y * REDUCTION + dy) * image.width + x * REDUCTION + dx) as usize]
        });
        pixels.sum::<Vec3>() / (REDUCTION * REDUCTION) as f32
    };
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| mean(x, y)).collect();
    ColorImage { width, height, pixels }
}

/// The mean within 0.3 %, every block within 4 standard errors of both pictures.
fn assert_agrees(name: &str, samples: u32) {
    let Some(folder) = common::large_scenes() else { return };
    let scene = scene::load(&folder.join(name).join(name).with_extension("json")).unwrap();
    let reference = reduce(&read_color(&folder.join(name).join("reference.exr")).unwrap());
    let size = FilmSize { width: reference.width, height: reference.height };
    let film = render(&prepare(&scene), &Settings { size, seed: 11, ..settings(&scene) }, samples);
    let samples_ratio = f64::from(samples) / (REFERENCE_SAMPLES * f64::from(REDUCTION * REDUCTION));
    let result = agreement(&ColorImage::from_film(&film), &film.variance(), samples_ratio, &reference, BLOCK).unwrap();
    assert!((result.mean_ratio - 1.0).abs() < 0.003, "{name}: {result:?}");
    assert!(result.worst_block < 4.0, "{name}: {result:?}");
}

#[test]
fn cornell_ball_agrees_with_its_reference() {
    assert_agrees("cornell_ball", 512);
}

#[test]
fn sibenik_agrees_with_its_reference() {
    assert_agrees("sibenik", 128);
}

#[test]
fn conference_agrees_with_its_reference() {
    assert_agrees("conference", 192);
}
