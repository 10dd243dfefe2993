//! Uniformity of the random numbers, along everything that they are drawn for.

use raystream_shaders::math::random::{
    BSDF, CHOICES, INDEPENDENT, PIXEL, RandomNumbers, SOBOL, of_vertex,
};
use raystream_tests::histogram::{
    SAMPLERS, assert_uniform, assert_uniform_over_square, cell, histogram, points,
};
use raystream_tests::statistics::assert_chi_square;

const COUNT: u32 = 1 << 18;

#[test]
fn pairs_are_uniform_over_the_samples_of_a_pixel() {
    for (kind, name) in SAMPLERS {
        for pixel in [0, 1, 640 * 480 - 1, u32::MAX] {
            for dimension in [PIXEL, BSDF, of_vertex(5, CHOICES)] {
                // Not a power of 2, so that Sobol's points do not simply fill the cells evenly.
                let points =
                    (0..COUNT - 777).map(|i| RandomNumbers::new(kind, 1, pixel, i).pair(dimension));
                assert_uniform_over_square(
                    points,
                    &format!("{name}: pixel {pixel}, dimension {dimension}"),
                );
            }
        }
    }
}

#[test]
fn pairs_are_uniform_over_the_pixels() {
    for (kind, name) in SAMPLERS {
        for index in [0, 1, 2, 1000, u32::MAX] {
            for dimension in [PIXEL, BSDF, of_vertex(5, CHOICES)] {
                let points = (0..COUNT)
                    .map(|pixel| RandomNumbers::new(kind, 1, pixel, index).pair(dimension));
                assert_uniform_over_square(
                    points,
                    &format!("{name}: sample {index}, dimension {dimension}"),
                );
            }
        }
    }
}

#[test]
fn pairs_are_uniform_over_the_dimensions() {
    for (kind, name) in SAMPLERS {
        for (pixel, index) in [(0, 0), (0, 1), (77, 3), (1 << 20, 4095)] {
            let stream = RandomNumbers::new(kind, 1, pixel, index);
            let points = (0..COUNT).map(|dimension| stream.pair(dimension));
            assert_uniform_over_square(points, &format!("{name}: pixel {pixel}, sample {index}"));
        }
    }
}

#[test]
fn pairs_are_uniform_over_the_seeds() {
    for (kind, name) in SAMPLERS {
        for (pixel, index, dimension) in
            [(0, 0, PIXEL), (5, 9, BSDF), (640 * 480 - 1, 64, of_vertex(2, CHOICES))]
        {
            let points =
                (0..COUNT).map(|seed| RandomNumbers::new(kind, seed, pixel, index).pair(dimension));
            assert_uniform_over_square(points, &format!("{name}: pixel {pixel}, sample {index}"));
        }
    }
}

/// Byte by byte, since choices among many lights use the lower ones too.
#[test]
fn all_bits_are_uniform() {
    for (kind, name) in SAMPLERS {
        let over_pixels: Vec<_> =
            (0..COUNT).map(|p| RandomNumbers::new(kind, 1, p, 3).bits(CHOICES)).collect();
        let over_samples: Vec<_> =
            (0..COUNT).map(|i| RandomNumbers::new(kind, 1, 99, i).bits(CHOICES)).collect();
        for (along, numbers) in [("pixels", over_pixels), ("samples", over_samples)] {
            for axis in 0..2 {
                for byte in 0..4 {
                    let counts = histogram(
                        256,
                        numbers.iter().map(|n| usize::from(n[axis].to_le_bytes()[byte])),
                    );
                    assert_uniform(
                        &counts,
                        &format!("{name}: byte {byte} of axis {axis} over the {along}"),
                    );
                }
            }
        }
    }
}

/// As many points as cells: how many cells hold 0, 1, 2 ... points. Sobol's hold one each,
/// independent numbers follow Poisson's law.
#[test]
fn sobol_points_are_even_and_independent_ones_are_not() {
    const SIDE: usize = 32;
    let occupancy = |kind| {
        let mut cells_by_points = vec![0_u32; 9];
        for pixel in 0..64 {
            let points =
                (0..SIDE * SIDE).map(|i| RandomNumbers::new(kind, 1, pixel, i as u32).pair(BSDF));
            let cells = points.map(|[x, y]| cell(x.into(), SIDE) * SIDE + cell(y.into(), SIDE));
            for points_in_cell in histogram(SIDE * SIDE, cells) {
                cells_by_points[points_in_cell.min(8) as usize] += 1;
            }
        }
        cells_by_points
    };
    let cells = (64 * SIDE * SIDE) as f64;
    assert_eq!(occupancy(SOBOL)[1], cells as u32);

    // The binomial law by its recurrence; the last class takes the rest.
    let trials = (SIDE * SIDE) as f64;
    let (mut probability, mut expected) = ((1.0 - 1.0 / trials).powf(trials), Vec::new());
    for k in 0..8 {
        expected.push(cells * probability);
        probability *= (trials - f64::from(k)) / f64::from(k + 1) / (trials - 1.0);
    }
    expected.push(cells - expected.iter().sum::<f64>());
    assert_chi_square(&occupancy(INDEPENDENT), &expected, "points in a cell");
}

/// The test can fail: 52.5 % of the numbers in the lower half are too many. (It finds deviations
/// from some 4 % of the density on.)
#[test]
#[should_panic(expected = "chi-square")]
fn a_biased_sampler_is_rejected() {
    let bias =
        |x: f32| if x < 0.525 { x * (0.5 / 0.525) } else { 0.5 + (x - 0.525) * (0.5 / 0.475) };
    assert_uniform_over_square(
        points(INDEPENDENT, BSDF, COUNT).map(|[x, y]| [bias(x), y]),
        "biased",
    );
}

/// The test can fail: a sampler that reaches only every 16th number is uniform by mean and
/// variance, but not by cell.
#[test]
#[should_panic(expected = "chi-square")]
fn a_coarse_sampler_is_rejected() {
    let coarse = |x: f32| (x * 16.0).floor() / 16.0;
    assert_uniform_over_square(
        points(INDEPENDENT, BSDF, COUNT).map(|[x, y]| [coarse(x), y]),
        "coarse",
    );
}
