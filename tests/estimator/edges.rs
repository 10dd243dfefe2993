//! What the filter must not blur.

use super::walls::{Estimates, SAMPLES, absolute, estimate, plain, random, wall};
use glam::Vec3;
use raystream::film::Film;
use raystream::render::{EstimationSettings, Estimator};
use raystream_shaders::integrator::first_hits::FeaturePixel;

const WIDTH: u32 = 24;
const HEIGHT: u32 = 16;

/// An alteration of a pixel's features.
type Change = &'static dyn Fn(&mut FeaturePixel);

/// A wall without noise, bright on the right half, where `change` alters the features.
fn step(change: impl Fn(&mut FeaturePixel)) -> Film {
    let mut film =
        wall(WIDTH, HEIGHT, SAMPLES, |x, _, _| Vec3::splat(if x < WIDTH / 2 { 1.0 } else { 2.0 }));
    for (p, features) in film.features.iter_mut().enumerate() {
        if p as u32 % WIDTH >= WIDTH / 2 {
            change(features);
        }
    }
    film
}

fn largest_error(estimates: &Estimates) -> f32 {
    estimates.estimates.iter().map(|e| e.squared_error).fold(0.0, f32::max)
}

#[test]
fn edges_of_features_are_not_blurred() {
    const SUM: f32 = SAMPLES as f32;
    let edges: [(&str, Change); 4] = [
        ("albedo", &|f| f.albedo = Vec3::new(0.5, 0.9, 0.5) * SUM),
        ("normal", &|f| f.normal = Vec3::X * SUM),
        ("position", &|f| f.position *= 2.0),
        ("background", &|f| *f = FeaturePixel { samples: f.samples, ..FeaturePixel::default() }),
    ];
    for (name, change) in edges {
        let error =
            largest_error(&estimate(&step(change), &absolute(Estimator::Bilateral), &plain()));
        // exp(-8) is what is left of a weight at 4 standard deviations; all these edges are farther
        // than that.
        assert!(error < 3e-4_f32.powi(2), "{name}: {error}");
    }
}

#[test]
fn without_the_color_term_shadows_are_blurred_and_with_it_they_survive() {
    let film = step(|_| ());
    let blurred = estimate(&film, &absolute(Estimator::Bilateral), &plain());
    // Beside the edge, all but half of the weight is on the other side.
    let beside = blurred.estimates[(HEIGHT / 2 * WIDTH + WIDTH / 2) as usize].squared_error;
    assert!(beside > 0.3_f32.powi(2) && beside < 0.5_f32.powi(2), "{beside}");
    let kept = estimate(&film, &absolute(Estimator::Bilateral), &EstimationSettings::default());
    // Sums of up to 121 colours round. Beside the edge, samples may have missed a part of what is
    // beyond it, whose contrast is 1.
    let rounding = (2.0 * 121.0 * f32::EPSILON).powi(2);
    let unseen = 1.0 / (3.0 * (SAMPLES as f32).powi(3));
    for (estimate, p) in kept.estimates.iter().zip(0..) {
        let is_beside = [WIDTH / 2 - 1, WIDTH / 2].contains(&(p % WIDTH));
        let expected = if is_beside { unseen } else { 0.0 };
        let difference = (estimate.squared_error - expected).abs();
        assert!(difference < rounding + 1e-6 * unseen, "{p}: {}", estimate.squared_error);
    }
}

/// Where all samples of a pixel at an edge agree, the edge may cover a part of it that they have
/// missed. Over pixels whose part is anything, the squared errors of such are at most what is
/// estimated; a quarter of it where the edge runs along the strips that samples lie in, one in
/// each.
#[test]
fn what_samples_at_an_edge_have_missed_is_estimated() {
    let mut sums = [0.0_f64; 2];
    let (pixels, n) = (1 << 16, SAMPLES);
    for pixel in 0..pixels {
        // The edge covers this part of the pixel; samples lie one in each of its n strips.
        let part = f64::from(random(5, pixel, 0));
        let beyond = (0..n)
            .filter(|&k| (f64::from(k) + f64::from(random(6, pixel, k))) / f64::from(n) < part)
            .count();
        if beyond == 0 {
            sums[0] += part * part;
        }
        sums[1] += 1.0 / (3.0 * f64::from(n).powi(3));
    }
    let [happened, estimated] = sums.map(|sum| sum / pixels as f64);
    // Some 2000 pixels are such, whose squares have a relative standard deviation of about 1.5:
    // 0.25 has a standard error of 0.01.
    let share = happened / estimated;
    assert!((share - 0.25).abs() < 0.05, "{happened:e}, by {estimated:e} {share}");
}

/// A shadow under noise: as long as noise hides it, it is blurred, and what that costs is less than
/// the noise.
#[test]
fn shadows_survive_when_noise_is_below_them() {
    let mean_difference_at_edge = |noise: f32| {
        let film = wall(WIDTH, HEIGHT, SAMPLES, |x, y, sample| {
            let level = if x < WIDTH / 2 { 1.0 } else { 2.0 };
            // Uniform numbers have the variance 1/12.
            let deviation = noise * (12.0 * SAMPLES as f32).sqrt();
            Vec3::splat(level + deviation * (random(7, (y * WIDTH + x) as usize, sample) - 0.5))
        });
        let estimates =
            estimate(&film, &absolute(Estimator::Bilateral), &EstimationSettings::default())
                .estimates;
        let column = |x: u32| {
            (0..HEIGHT).map(|y| estimates[(y * WIDTH + x) as usize].filtered.x).sum::<f32>()
        };
        (column(WIDTH / 2) - column(WIDTH / 2 - 1)) / HEIGHT as f32
    };
    // The means over 16 pixels differ by 5 % * sqrt(2 / 16) = 1.8 % if nothing were filtered; this
    // is 5 times that.
    assert!((mean_difference_at_edge(0.05) - 1.0).abs() < 0.09);
    assert!(mean_difference_at_edge(1.0) < 0.5);
}

#[test]
fn constant_pictures_have_no_error() {
    let color = Vec3::new(0.25, 3.0, 0.5);
    for (width, height) in [(1, 1), (1, 9), (17, 3), (24, 16)] {
        let film = wall(width, height, SAMPLES, |_, _, _| color);
        for estimator in [Estimator::Bilateral, Estimator::Halves, Estimator::Variance] {
            for settings in [plain(), EstimationSettings::default()] {
                let estimates = estimate(&film, &absolute(estimator), &settings);
                for (estimate, error) in estimates.estimates.iter().zip(&estimates.errors) {
                    // Rounding of sums of up to 121 equal numbers.
                    assert!(
                        (estimate.filtered - color).abs().max_element()
                            < 121.0 * 3.0 * f32::EPSILON
                    );
                    let rounding = (121.0 * 3.0 * f32::EPSILON).powi(2);
                    assert!(
                        estimate.squared_error <= rounding && (0.0..=rounding).contains(error),
                        "{estimator:?}"
                    );
                }
            }
        }
    }
}

/// Seen at a grazing angle, neighbours are far from each other; a flat floor is a flat floor all
/// the same.
#[test]
fn slanted_surfaces_are_filtered_like_upright_ones() {
    let mut film = wall(WIDTH, HEIGHT, SAMPLES, |x, y, sample| {
        Vec3::splat(random(3, (y * WIDTH + x) as usize, sample))
    });
    let share = |film: &Film| {
        let estimates = estimate(film, &absolute(Estimator::Bilateral), &plain()).estimates;
        estimates.iter().map(|e| e.squared_error).sum::<f32>()
    };
    let upright = share(&film);
    // The plane through (0, 0, -1) that falls off at 75 degrees to the picture plane.
    let normal = Vec3::new(75_f32.to_radians().sin(), 0.0, 75_f32.to_radians().cos());
    for features in &mut film.features {
        let direction = (features.position / features.hits as f32).normalize();
        let t = Vec3::NEG_Z.dot(normal) / direction.dot(normal);
        features.position = direction * t * features.hits as f32;
        features.normal = normal * features.hits as f32;
    }
    let slanted = share(&film);
    assert!((slanted / upright - 1.0).abs() < 0.1, "{slanted} and {upright}");
}
