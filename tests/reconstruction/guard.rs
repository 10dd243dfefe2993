//! What the guard and the mean do for any filter.

use super::films::denoise_on;
use crate::estimator::walls::{SAMPLES, camera, random, wall};
use glam::{DVec3, Vec3};
use raystream::exec::cpu::CpuExecutor;
use raystream::exec::{Array, Launch};
use raystream::render::reconstruction::{
    Filter, FilterInputs, FilterView, FilteredPicture, Reconstruction,
};
use raystream::render::{FilmBuffers, FilterKind};
use raystream::scene::FilmSize;
use raystream_shaders::estimator::filtered::FilteredPixel;

/// A filter that makes every picture black.
pub struct Blackout;

impl<B> Filter<B> for Blackout {
    fn launches<'a>(
        &'a self,
        _: &'a FilterInputs<B>,
        _: &FilterView,
        _: &'a Array<B, FilteredPixel>,
    ) -> Vec<Launch<'a, B>> {
        Vec::new()
    }
}

#[test]
fn the_worst_of_filters_converges() {
    let size = FilmSize { width: 24, height: 16 };
    let executor = &CpuExecutor;
    for (samples, largest) in [(64, 0.05), (4096, 0.001)] {
        let film = wall(size.width, size.height, samples, |x, y, sample| {
            let number = random(1, (y * size.width + x) as usize, sample);
            Vec3::splat(0.5 + number)
        });
        let picture =
            FilteredPicture::with_filter(executor, size, Box::new(Blackout)).expect("it fits");
        let reconstruction = Reconstruction::new(executor, picture).expect("it fits");
        let buffers = FilmBuffers::from_film(executor, &film).expect("it fits");
        let camera = camera(size.width, size.height);
        let view = FilterView { camera, mean_radiance: 1.0 };
        reconstruction.run(executor, &buffers, &view, false).expect("the device works");
        let guarded = reconstruction.guarded().read(executor).expect("the device works");
        // The variance of a sample is 1/12: of the way back, twice that by the number of samples
        // is missing, some 3e-3 and 4e-5; and noise, of which five deviations are 0.2 and 0.02.
        let mean = guarded.iter().map(|e| e.filtered.x).sum::<f32>() / guarded.len() as f32;
        assert!((mean - 1.0).abs() < largest, "{samples} samples: {mean}");
        // The mean is put right.
        let picture = reconstruction.read(executor).expect("the device works");
        let sum: DVec3 = picture.iter().map(|e| e.filtered.as_dvec3()).sum();
        let expected: DVec3 = film.color().iter().map(|c| c.as_dvec3()).sum();
        assert!(((sum - expected) / expected).abs().max_element() < 1e-4, "{sum}, {expected}");
    }
}

#[test]
fn with_a_control_film_the_mean_is_that_of_the_control_film() {
    // The second half is too dark: the bias of adaptive sampling, much exaggerated.
    let film = wall(32, 24, SAMPLES, |x, y, sample| {
        let number = random(2, (y * 32 + x) as usize, sample);
        Vec3::splat(if sample % 2 == 0 { 0.5 + number } else { 0.4 + number })
    });
    for kind in FilterKind::built_in() {
        let picture = denoise_on(&CpuExecutor, &film, kind, true);
        let sum: DVec3 = picture.iter().map(|e| e.filtered.as_dvec3()).sum();
        let control = film.halves().expect("it has two").into_iter().next().unwrap_or_default();
        let expected: DVec3 = control.iter().map(|c| c.as_dvec3()).sum();
        assert!(((sum - expected) / expected).abs().max_element() < 1e-4, "{kind}: {sum}");
    }
}
