//! The GPU against the CPU, on films of a real scene.

use super::walls::{Estimates, absolute, estimate_on};
use raystream::exec::Executor;
use raystream::exec::cpu::CpuExecutor;
use raystream::film::Film;
use raystream::render::estimator::ComingRound;
use raystream::render::{EstimationSettings, Estimator, Sampling};
use raystream::scene::FilmSize;
use raystream_shaders::scene::camera::Camera;
use raystream_tests::{prepare, render, scenes, settings, with_gpu};

/// Largest relative difference of a squared error, and of a filtered colour, from rounding.
///
/// Vulkan lets exp(x) be off by 3 + 2|x| units in the last place of 2^-24, 35 for the largest
/// exponents that count (16), and a division by 2.5. An exponent is a sum of five terms of some ten
/// roundings each, so it is off by up to 10 * 2^-24 of itself: 160 units in a weight. The mean of
/// up to 121 colours by such weights adds 121 roundings, and colours are means themselves: 2^-24 *
/// (35 + 160 + 121 + 4) = 2e-5.
const RELATIVE: f32 = 2e-5;

fn estimates<E: Executor>(
    executor: &E,
    film: &Film,
    camera: &Camera,
    estimator: Estimator,
    settings: &EstimationSettings,
) -> Estimates {
    let round = ComingRound { samples: 2.0, mean_radiance: 0.5 };
    let sampling = Sampling { relative: true, ..absolute(estimator) };
    estimate_on(executor, film, camera, &sampling, settings, round).expect("the device works")
}

#[test]
fn estimates_are_equal_but_for_rounding() {
    let mut scene = scenes::room(scenes::diffuse(0.8), 1.0);
    scene.film = FilmSize { width: 45, height: 37 };
    let prepared = prepare(&scene);
    let settings = settings(&scene);
    let mut film = render(&prepared, &settings, 6);
    film.radiance[700].first_sum.x = f32::NAN;
    film.radiance[701].sum_of_squares.x = f32::INFINITY;
    let camera = prepared.parameters(&settings).camera;
    let variances: Vec<f32> = film.variance().iter().map(|v| v.element_sum() / 3.0).collect();
    with_gpu(|gpu| {
        for estimator in [Estimator::Bilateral, Estimator::Halves, Estimator::Variance] {
            for color in [false, true] {
                let mut settings = EstimationSettings::default();
                settings.filter.color = color;
                settings.smooth = color;
                let a = estimates(&CpuExecutor, &film, &camera, estimator, &settings);
                let b = estimates(gpu, &film, &camera, estimator, &settings);
                let mut different = 0;
                let colors = film.color();
                for p in 0..film.radiance.len() {
                    let (ea, eb) = (a.estimates[p], b.estimates[p]);
                    // The brightest that may be in the sums: what is rounded is measured by them.
                    let (x, y) = (p as i32 % 45, p as i32 / 45);
                    let near = (-5..=5).flat_map(|dy| (-5..=5).map(move |dx| (x + dx, y + dy)));
                    let near = near.filter(|&(x, y)| (0..45).contains(&x) && (0..37).contains(&y));
                    let pixels: Vec<usize> = near.map(|(x, y)| (y * 45 + x) as usize).collect();
                    let brightest =
                        pixels.iter().map(|&p| colors[p].max_element()).filter(|c| c.is_finite());
                    let brightest = brightest.fold(0.0, f32::max);
                    let noisiest = pixels
                        .iter()
                        .map(|&p| variances[p])
                        .filter(|v| v.is_finite())
                        .fold(0.0, f32::max);
                    let what =
                        format!("{estimator:?}, color {color}, pixel {p}: {ea:?} and {eb:?}");
                    let off = RELATIVE * brightest;
                    assert!((ea.filtered - eb.filtered).abs().max_element() <= off, "{what}");
                    // (d + off)^2 - d^2, and the variances, which are differences of squares
                    // themselves.
                    let d = ea.squared_error.sqrt();
                    let squared =
                        2.0 * d * off + off * off + RELATIVE * (noisiest + brightest * brightest);
                    assert!((ea.squared_error - eb.squared_error).abs() <= squared, "{what}");
                    different += u32::from(ea.squared_error == 0.0 && eb.squared_error != 0.0);
                    assert_eq!(a.errors[p] == 0.0, b.errors[p] == 0.0, "{what}");
                }
                assert!(different == 0 && a.errors.iter().any(|&e| e > 0.0));
                let [x, y] = [&a, &b].map(|e| e.noise.relative_error);
                assert!((x / y - 1.0).abs() < 1e-3, "{estimator:?}: {x} and {y}");
            }
        }
    });
}
