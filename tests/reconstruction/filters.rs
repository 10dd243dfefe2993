//! What every filter must do.

use super::films::{denoise, filter, mean_squared_error, noisy_wall, picture_of};
use crate::estimator::walls::{SAMPLES, random, wall};
use glam::{DVec3, Vec3};
use raystream::film::Film;
use raystream::render::FilterKind;
use raystream_tests::statistics::normal_quantile;

/// Largest relative difference by the rounding of sums of up to 441 pixels by weights of a few
/// roundings each, and of the corrections of the mean, sums over 49x49 pixels along two axes,
/// twice.
const ROUNDING: f32 = (441.0 + 4.0 * 49.0 + 16.0) * f32::EPSILON;

/// Asserts that a film without noise comes through the filter as it is.
fn assert_unchanged(film: &Film, kind: FilterKind, what: &str) {
    let (picture, errors) = denoise(film, kind);
    let brightest = film.color().iter().map(|c| c.max_element()).fold(0.0, f32::max);
    for ((a, b), error) in picture.iter().zip(film.color()).zip(errors) {
        let off = (*a - b).abs().max_element();
        assert!(off <= ROUNDING * brightest, "{kind}, {what}: {a} was {b}");
        let bound = (ROUNDING * brightest).powi(2);
        assert!((0.0..=bound).contains(&error), "{kind}, {what}: error {error:e}");
    }
}

#[test]
fn pictures_without_noise_stay_as_they_are() {
    for kind in FilterKind::built_in() {
        for (width, height) in [(1, 1), (1, 9), (17, 3), (24, 16)] {
            let constant = wall(width, height, SAMPLES, |_, _, _| Vec3::new(0.25, 3.0, 0.5));
            assert_unchanged(&constant, kind, "a constant");
            let ramp = wall(width, height, SAMPLES, |x, y, _| {
                Vec3::new(1.0, 2.0, 0.5) * (x + 2 * y) as f32
            });
            assert_unchanged(&ramp, kind, "a ramp");
            let edge = wall(width, height, SAMPLES, |x, y, _| {
                if x > y { Vec3::new(8.0, 0.25, 1.0) } else { Vec3::ZERO }
            });
            assert_unchanged(&edge, kind, "an edge");
        }
    }
}

/// By symmetry: what lies to both sides of a pixel far from the border is as far above it as below.
#[test]
fn ramps_keep_their_slope_under_noise() {
    const SIZE: [u32; 2] = [64, 8];
    const FILMS: u32 = 64;
    /// Windows of the filter that sees farthest: `auto` averages over 10 pixels to each side what a
    /// filter of 7 makes of descriptions of 3.
    const BORDER: usize = 20;
    for kind in FilterKind::built_in() {
        let ramp = |x: u32| 4.0 + 0.01 * x as f32;
        let columns: Vec<[f64; SIZE[0] as usize]> = (0..FILMS)
            .map(|seed| {
                let film = wall(SIZE[0], SIZE[1], SAMPLES, |x, y, sample| {
                    let number = random(seed, (y * SIZE[0] + x) as usize, sample);
                    Vec3::splat(ramp(x) + number - 0.5)
                });
                let filtered = filter(&film, kind);
                std::array::from_fn(|x| {
                    let column = (0..SIZE[1] as usize).map(|y| filtered[y * SIZE[0] as usize + x]);
                    column.map(|c| f64::from(c.x)).sum::<f64>() / f64::from(SIZE[1])
                })
            })
            .collect();
        let inside = BORDER..SIZE[0] as usize - BORDER;
        // A false alarm in one of 10^4 runs.
        let limit =
            normal_quantile(1.0 - 0.5e-4 / (inside.len() * FilterKind::built_in().count()) as f64);
        for x in inside {
            let values: Vec<f64> = columns.iter().map(|column| column[x]).collect();
            let (mean, error) = raystream_tests::statistics::mean_and_error(&values);
            let off = mean - f64::from(ramp(x as u32));
            assert!(off.abs() <= limit * error, "{kind}, column {x}: {off:e} of {error:e}");
        }
    }
}

/// They look at no colours.
const BLIND: [FilterKind; 2] = [FilterKind::AxisAligned, FilterKind::Manifolds];

/// A wall with a soft light and the hard edge of a shadow, which no feature shows.
fn shadowed_wall(x: u32, y: u32) -> Vec3 {
    let soft = 1.0 + 0.5 * (x as f32 * 0.2).sin() + 0.02 * y as f32;
    let shadow = if x + y > 30 { 0.2 } else { 1.0 };
    Vec3::new(1.0, 0.8, 0.5) * (soft * shadow)
}

/// The same with a thin bright line, the hardest of all: it has no neighbours like itself but along
/// it.
fn lit_wall(x: u32, y: u32) -> Vec3 {
    shadowed_wall(x, y) + if x == 12 { Vec3::new(3.0, 2.4, 1.5) } else { Vec3::ZERO }
}

#[test]
fn errors_fall_with_samples_without_a_plateau() {
    const SIZE: [u32; 2] = [32, 32];
    let truth = picture_of(SIZE, lit_wall);
    for kind in FilterKind::built_in() {
        let mut before = f64::INFINITY;
        for samples in [4, 16, 64, 256, 1024, 4096] {
            let film = noisy_wall(SIZE, samples, 3, lit_wall);
            let plain = mean_squared_error(&film.color(), &truth);
            let error = mean_squared_error(&denoise(&film, kind).0, &truth);
            let what = format!("{kind}, {samples} samples: {error:e} of {plain:e}");
            assert!(error < plain, "{what}: it makes the picture better");
            // Four times the samples leave a quarter of the noise, and of what edges cost at most
            // as much as before: half of the sum where both are alike.
            assert!(error < 0.5 * before, "{what}, before {before:e}");
            before = error;
        }
    }
}

/// What the guard is for, and that the test before can fail: filters that see no edge blur it
/// however many samples there are.
#[test]
fn without_the_guard_what_sees_no_edge_has_a_plateau() {
    const SIZE: [u32; 2] = [32, 32];
    let truth = picture_of(SIZE, lit_wall);
    for kind in BLIND {
        let [[before, guarded_before], [after, guarded]] = [64, 1024].map(|samples| {
            let film = noisy_wall(SIZE, samples, 3, lit_wall);
            [filter(&film, kind), denoise(&film, kind).0].map(|p| mean_squared_error(&p, &truth))
        });
        // The blur stays, where the noise of 16 times the samples is a sixteenth.
        let what = format!("{kind}: {before:e}, then {after:e}");
        assert!(after > 0.5 * before, "{what}");
        let what = format!("{kind}: guarded {guarded_before:e}, then {guarded:e}");
        assert!(guarded < 0.25 * guarded_before && guarded < 0.1 * after, "{what}");
    }
}

/// It is to stop renders, so it must not be far below the truth. It is above where a filter leaves
/// little: what squared differences exceed noise by is averaged over a Gaussian of 1 pixel, some 12
/// pixels, so that it has a deviation of `sqrt(2 / 12)` of the noise. What is below 0 does not
/// count, which brings 0.16 of the noise on average, and less where the filter is wrong at all.
///
/// The estimate of so many pixels is itself off, by the root of 2 / 1024 of the noise, of which this
/// allows three deviations.
///
/// Where a filter sees no shadow, the guard undoes nearly all that it does. With two variances for
/// noise the estimate is then the noise itself, whatever little the filter may still gain.
#[test]
fn the_error_that_is_left_is_known() {
    const SIZE: [u32; 2] = [32, 32];
    let truth = picture_of(SIZE, shadowed_wall);
    for kind in FilterKind::built_in() {
        for samples in [16, 64, 256, 1024] {
            let film = noisy_wall(SIZE, samples, 3, shadowed_wall);
            let plain = mean_squared_error(&film.color(), &truth);
            let (picture, errors) = denoise(&film, kind);
            let error = mean_squared_error(&picture, &truth);
            let estimated = errors.iter().map(|&e| f64::from(e)).sum::<f64>() / errors.len() as f64;
            // Three standard errors of a mean of squares, each of which deviates by sqrt(2) of its
            // own mean.
            let off = 3.0 * (2.0 / errors.len() as f64).sqrt() * plain;
            let above = off + if BLIND.contains(&kind) { plain } else { error + 0.16 * plain };
            assert!(
                estimated > 0.5 * error && estimated < above,
                "{kind}, {samples} samples: {error:e} of {plain:e}, by estimate {estimated:e}"
            );
        }
    }
}

#[test]
fn most_of_the_noise_of_a_flat_wall_goes() {
    const SIZE: [u32; 2] = [32, 32];
    let truth = picture_of(SIZE, |_, _| Vec3::ONE);
    for kind in FilterKind::built_in() {
        let film = noisy_wall(SIZE, SAMPLES, 5, |_, _| Vec3::ONE);
        let plain = mean_squared_error(&film.color(), &truth);
        let error = mean_squared_error(&denoise(&film, kind).0, &truth);
        // A mean over at least ten pixels.
        assert!(error < 0.1 * plain, "{kind}: {error:e} of {plain:e}");
    }
}

#[test]
fn the_mean_of_the_picture_is_that_of_the_film() {
    let sum = |picture: &[Vec3]| picture.iter().map(|c| c.as_dvec3()).sum::<DVec3>();
    for kind in FilterKind::built_in() {
        let film = noisy_wall([29, 19], SAMPLES, 7, lit_wall);
        let (a, b) = (sum(&denoise(&film, kind).0), sum(&film.color()));
        let off = ((a - b) / b).abs().max_element();
        assert!(off < f64::from(ROUNDING), "{kind}: {a} and {b}");
    }
}

#[test]
fn pixels_without_a_measurement_stay_black_and_alone() {
    for kind in FilterKind::built_in() {
        let mut film = noisy_wall([24, 24], SAMPLES, 9, |_, _| Vec3::ONE);
        let whole = denoise(&film, kind).0;
        film.radiance[12 * 24 + 12].first_sum.x = f32::NAN;
        film.radiance[7].sum_of_squares.y = f32::INFINITY;
        let (picture, errors) = denoise(&film, kind);
        for p in [12 * 24 + 12, 7] {
            let is_black = picture[p].abs().max_element() < 1e-6;
            assert!(is_black && errors[p] == 0.0, "{kind}: {} and {}", picture[p], errors[p]);
        }
        let truth = picture_of([24, 24], |_, _| Vec3::ONE);
        let others = |picture: &[Vec3]| -> Vec<Vec3> {
            let kept = picture.iter().enumerate().filter(|(p, _)| ![12 * 24 + 12, 7].contains(p));
            kept.map(|(_, c)| *c).collect()
        };
        let [with, without] =
            [&picture, &whole].map(|p| mean_squared_error(&others(p), &others(&truth)));
        assert!(with < 1.5 * without, "{kind}: {with:e} beside holes, {without:e} without");
    }
}
