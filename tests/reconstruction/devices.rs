//! The GPU against the CPU, on the film of a real scene.

use super::films::denoise_on;
use glam::Vec3;
use raystream::exec::cpu::CpuExecutor;
use raystream::render::{FilterKind, Sampling, Settings};
use raystream::scene::FilmSize;
use raystream_tests::{prepare, render, scenes, settings, with_gpu};

/// Largest difference of a filtered colour, by the brightest of the picture.
///
/// Weights are exponentials of squared differences over variances. A mean is off by some 4
/// roundings of 2^-24, a difference `d` of two by 6, and so `d^2 / v` by `12 |x| d / v` of them:
/// where noise is a hundredth of the brightness `x`, and `d` three deviations, by 4000, which is
/// 2.4e-4. Over k^2 of 0.2 and patches, whose distances have no common sign, that is the size of a
/// weight's error, and of the picture's where neighbours differ by as much as they are bright. The
/// guard multiplies it by at most 2, for it is the ratio of a variance and such a difference.
const RELATIVE: f32 = 1e-3;

#[test]
fn pictures_are_equal_but_for_rounding() {
    let mut scene = scenes::room(scenes::diffuse(0.8), 1.0);
    scene.film = FilmSize { width: 45, height: 37 };
    let prepared = prepare(&scene);
    let settings = settings(&scene);
    let sampling = Sampling { halves: true, ..settings.sampling };
    let mut film = render(&prepared, &Settings { sampling, ..settings }, 6);
    film.radiance[700].first_sum.x = f32::NAN;
    film.radiance[701].sum_of_squares.x = f32::INFINITY;
    let brightest = film.color().into_iter().map(Vec3::max_element).filter(|c| c.is_finite());
    let brightest = brightest.fold(0.0, f32::max);
    with_gpu(|gpu| {
        for kind in FilterKind::built_in() {
            let a = denoise_on(&CpuExecutor, &film, kind, false);
            let b = denoise_on(gpu, &film, kind, false);
            for (p, (a, b)) in a.iter().zip(&b).enumerate() {
                let off = (a.filtered - b.filtered).abs().max_element();
                assert!(off <= RELATIVE * brightest, "{kind}, pixel {p}: {a:?} and {b:?}");
                let off = (a.squared_error - b.squared_error).abs();
                let squared = RELATIVE * brightest * brightest;
                assert!(off <= squared, "{kind}, pixel {p}: {a:?} and {b:?}");
            }
        }
    });
}
