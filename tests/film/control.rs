//! The corrections by the control film, against their definition.

use crate::estimator::walls::random;
use bytemuck::Zeroable;
use glam::{DVec3, Vec3};
use raystream::exec::Executor;
use raystream::exec::cpu::CpuExecutor;
use raystream::film::Film;
use raystream::render::FilmBuffers;
use raystream::render::film::control::ControlFilm;
use raystream::scene::FilmSize;
use raystream_shaders::film::FilmPixel;
use raystream_shaders::integrator::first_hits::FeaturePixel;
use raystream_tests::with_gpu;

const SIZE: FilmSize = FilmSize { width: 53, height: 31 };
/// Samples of the control film in each pixel.
const CONTROL: u32 = 4;
/// Roundings of sums over a thousand pixels in single precision, of terms of both signs, relative
/// to the largest correction.
const ROUNDING: f64 = 1e-4;

/// Of so many pixels one has a difference that no noise around would hide.
const GLINTS: usize = 101;
/// That many times as large as others.
const GLINT: f64 = 200.0;

/// Pixels with 4 to 300 samples: of all levels, all over the picture, and some without the second
/// half; some so bright in the first half that they keep most of their difference.
fn film() -> Film {
    let pixel = |p: usize| {
        let draw = |k: u32| f64::from(random(3, p, k));
        let second = if p.is_multiple_of(17) { 0 } else { (300.0 * draw(0).powi(4)) as u32 + 1 };
        let scale = 1.0 + 5.0 * draw(1);
        let sum = |n: u32, k: u32| Vec3::splat((f64::from(n) * scale * (0.5 + draw(k))) as f32);
        let glint = if p % GLINTS == GLINTS / 2 { GLINT as f32 } else { 1.0 };
        FilmPixel {
            first_sum: sum(CONTROL, 2) * glint,
            first_samples: CONTROL,
            second_sum: sum(second, 3),
            second_samples: second,
            sum_of_squares: Vec3::splat((3.0 * scale * scale) as f32 * (CONTROL + second) as f32),
            ..FilmPixel::zeroed()
        }
    };
    let pixels = (SIZE.width * SIZE.height) as usize;
    let radiance = (0..pixels).map(pixel).collect();
    Film::new(SIZE.width, SIZE.height, radiance, vec![FeaturePixel::zeroed(); pixels])
}

/// Columns and rows between two pixels.
fn apart(p: usize, q: usize) -> [u32; 2] {
    let place = |p: usize| (p as u32 % SIZE.width, p as u32 / SIZE.width);
    let ((px, py), (qx, qy)) = (place(p), place(q));
    [px.abs_diff(qx), py.abs_diff(qy)]
}

/// A Gaussian of their distance, cut off at three deviations along each axis.
fn gaussian(p: usize, q: usize, sigma: f64) -> f64 {
    let [x, y] = apart(p, q).map(f64::from);
    let sees = x.max(y) <= 3.0 * sigma;
    if sees { (-(x * x + y * y) / (2.0 * sigma * sigma)).exp() } else { 0.0 }
}

/// docs/ADAPTIVE.md, word by word, in double precision.
fn by_definition(film: &Film) -> Vec<DVec3> {
    let pixels = &film.radiance;
    let has_both = |p: &FilmPixel| p.second_samples > 0;
    let deviations: Vec<f64> = pixels
        .iter()
        .map(|p| {
            let n = f64::from(p.samples());
            let variance = p.sum_of_squares.as_dvec3() / n - (p.sum().as_dvec3() / n).powf(2.0);
            if has_both(p) { (variance.element_sum() / 3.0).max(0.0).sqrt() } else { 0.0 }
        })
        .collect();
    let all = 0..pixels.len();
    let guides: Vec<f64> = all
        .clone()
        .map(|p| {
            let weight = |q: usize| gaussian(p, q, 4.0);
            let sum: f64 = all.clone().map(|q| weight(q) * deviations[q]).sum();
            let mean = sum / all.clone().map(weight).sum::<f64>();
            (mean / f64::from(pixels[p].samples()).sqrt()).sqrt()
        })
        .collect();
    // The mean standard error around a pixel, without it and those that touch it.
    let around = |q: usize| {
        let touches = |p: usize| apart(p, q).into_iter().max() <= Some(1);
        let others: Vec<usize> = all.clone().filter(|&p| !touches(p)).collect();
        let error = |p: usize| deviations[p] / f64::from(pixels[p].samples()).sqrt();
        let sum: f64 = others.iter().map(|&p| gaussian(p, q, 4.0) * error(p)).sum();
        sum / others.iter().map(|&p| gaussian(p, q, 4.0)).sum::<f64>()
    };
    let mut corrections = vec![DVec3::ZERO; pixels.len()];
    for (q, pixel) in pixels.iter().enumerate().filter(|(_, pixel)| has_both(pixel)) {
        let n = f64::from(pixel.samples());
        let control = pixel.first_sum.as_dvec3() / f64::from(CONTROL);
        let difference = control - pixel.sum().as_dvec3() / n;
        let ratio = n / f64::from(CONTROL);
        let sigma = if ratio < 6.0 {
            2.0
        } else if ratio < 24.0 {
            4.0
        } else {
            8.0
        };
        let total: f64 = all.clone().map(|r| guides[r] * gaussian(r, q, sigma)).sum();
        let bound = 2.0 * around(q) * total / guides[q];
        let given = difference * (bound / difference.abs().max_element()).min(1.0);
        corrections[q] += difference - given;
        for p in all.clone() {
            corrections[p] += given * (guides[p] * gaussian(p, q, sigma) / total);
        }
    }
    corrections
}

fn corrections<E: Executor>(executor: &E, film: &Film) -> Vec<Vec3> {
    let control = ControlFilm::new(executor, SIZE).unwrap();
    let buffers = FilmBuffers::from_film(executor, film).unwrap();
    // Twice: what the first time left behind must not matter.
    for _ in 0..2 {
        executor.run(&control.launches(&buffers)).unwrap();
    }
    control.read(executor).unwrap()
}

#[test]
fn corrections_are_what_they_are_defined_as() {
    let film = film();
    let expected = by_definition(&film);
    let size = |c: &DVec3| c.abs().max_element();
    let is_glint = |p: usize| p % GLINTS == GLINTS / 2;
    let of_others = expected.iter().enumerate().filter(|&(p, _)| !is_glint(p));
    let largest = of_others.map(|(_, c)| size(c)).fold(0.0, f64::max);
    let check = |found: Vec<Vec3>, device: &str| {
        for (p, (found, expected)) in found.iter().zip(&expected).enumerate() {
            let off = size(&(found.as_dvec3() - expected));
            assert!(
                off <= ROUNDING * (largest + size(expected)),
                "{device}, pixel {p}: {found}, not {expected}"
            );
        }
    };
    check(corrections(&CpuExecutor, &film), "CPU");
    with_gpu(|gpu| check(corrections(gpu, &film), "GPU"));
    // Glints keep what would be a stain around them.
    let kept = (0..expected.len()).filter(|&p| is_glint(p) && size(&expected[p]) > 2.0 * largest);
    assert!(kept.count() > 10, "{largest}");
    // All levels are there, and the limit is far below what each does.
    let of_level = |low: u32, end: u32| {
        film.radiance.iter().filter(|p| (low..end).contains(&(p.samples() / CONTROL))).count()
    };
    assert!([of_level(0, 6), of_level(6, 24), of_level(24, 99)].iter().all(|&n| n > 50));
}

/// A pixel in which the sun glints, on a wall whose noise is known: the differences of both are of
/// one seed.
#[test]
fn a_glint_leaves_no_stain_on_the_wall_around_it() {
    let glint = (SIZE.height / 2 * SIZE.width + SIZE.width / 2) as usize;
    let wall = |sun: f32| {
        let (control, others) = (CONTROL, 60);
        let pixel = |p: usize| {
            let value = |k: u32| 1.0 + 0.2 * (random(7, p, k) - 0.5);
            let sun = if p == glint { sun } else { 0.0 };
            FilmPixel {
                first_sum: Vec3::splat(control as f32 * (value(0) + sun)),
                first_samples: control,
                second_sum: Vec3::splat(others as f32 * value(1)),
                second_samples: others,
                sum_of_squares: Vec3::splat((control + others) as f32 * (1.02 + sun * sun)),
                ..FilmPixel::zeroed()
            }
        };
        let radiance: Vec<_> = (0..(SIZE.width * SIZE.height) as usize).map(pixel).collect();
        let features = vec![FeaturePixel::zeroed(); radiance.len()];
        Film::new(SIZE.width, SIZE.height, radiance, features)
    };
    // A sample has the deviation 0.141 on the wall: the means of 64 have an error of 0.018.
    let error = (0.02_f32 / 64.0).sqrt();
    let check = |of: &dyn Fn(&Film) -> Vec<Vec3>, device: &str| {
        let (with, without) = (of(&wall(1e4)), of(&wall(0.0)));
        let stain = |p: usize| (with[p] - without[p]).abs().max_element();
        let around = (0..with.len()).filter(|&p| p != glint).map(stain).fold(0.0, f32::max);
        // Two errors by the definition, and what the wall's own noise adds to these.
        assert!(around < 2.5 * error, "{device}: {around}");
        // Nothing is lost.
        let sum: f64 = (0..with.len()).map(|p| f64::from(with[p].x - without[p].x)).sum();
        let missing = 1e4 * (1.0 - f64::from(CONTROL) / 64.0);
        assert!((sum / missing - 1.0).abs() < 1e-3, "{device}: {sum}, not {missing}");
    };
    check(&|film| corrections(&CpuExecutor, film), "CPU");
    with_gpu(|gpu| check(&|film| corrections(gpu, film), "GPU"));
}
