//! Independence of random numbers of each other: joint histograms of two of them.
//!
//! Sobol points of one pixel depend on each other by design; over the pixels they do not.

use raystream_shaders::math::random::{
    BSDF, CHOICES, DIMENSIONS_PER_VERTEX, INDEPENDENT, LIGHT_POINT, PIXEL, RandomNumbers, SOBOL,
    hash, of_vertex, scrambled_sobol, unit_float,
};
use raystream_tests::histogram::{SAMPLERS, assert_uniform_over_square, histogram};
use raystream_tests::statistics::assert_chi_square;

const COUNT: u32 = 1 << 18;

/// Asserts that each axis of `a` is independent of each axis of `b`, over 0..[`COUNT`].
fn assert_independent(a: impl Fn(u32) -> [f32; 2], b: impl Fn(u32) -> [f32; 2], what: &str) {
    for axis_a in 0..2 {
        for axis_b in 0..2 {
            let joint = (0..COUNT).map(|i| [a(i)[axis_a], b(i)[axis_b]]);
            assert_uniform_over_square(joint, &format!("{what}: axes {axis_a} and {axis_b}"));
        }
    }
}

/// Dimensions that a path draws one after the other, or for the same thing at two vertices.
const DIMENSIONS: [(u32, u32); 5] = [
    (PIXEL, BSDF),
    (BSDF, LIGHT_POINT),
    (LIGHT_POINT, CHOICES),
    (BSDF, DIMENSIONS_PER_VERTEX + BSDF),
    (PIXEL, 23),
];

#[test]
fn dimensions_are_independent_over_the_pixels() {
    assert_eq!(of_vertex(1, BSDF), DIMENSIONS_PER_VERTEX + BSDF);
    for (kind, name) in SAMPLERS {
        for index in [0, 1, 13] {
            for (a, b) in DIMENSIONS {
                let draw = |dimension| {
                    move |pixel| RandomNumbers::new(kind, 1, pixel, index).pair(dimension)
                };
                assert_independent(
                    draw(a),
                    draw(b),
                    &format!("{name}: sample {index}, dimensions {a} and {b}"),
                );
            }
        }
    }
}

#[test]
fn dimensions_are_independent_over_the_samples() {
    for (a, b) in DIMENSIONS {
        let draw = |dimension| {
            move |index| RandomNumbers::new(INDEPENDENT, 1, 4711, index).pair(dimension)
        };
        assert_independent(draw(a), draw(b), &format!("dimensions {a} and {b}"));
    }
}

#[test]
fn successive_samples_are_independent() {
    let draw = |step| move |i| RandomNumbers::new(INDEPENDENT, 1, 4711, 2 * i + step).pair(BSDF);
    assert_independent(draw(0), draw(1), "samples 2 i and 2 i + 1");
}

#[test]
fn neighbouring_pixels_are_independent() {
    for (kind, name) in SAMPLERS {
        let draw = |step| move |i| RandomNumbers::new(kind, 1, 2 * i + step, 5).pair(BSDF);
        assert_independent(draw(0), draw(1), &format!("{name}: pixels 2 i and 2 i + 1"));
    }
}

#[test]
fn seeds_are_independent() {
    for (kind, name) in SAMPLERS {
        for (seed_a, seed_b) in [(0, 1), (1, 2), (1, 0x8000_0001), (3, u32::MAX)] {
            let stream = |seed, pixel| RandomNumbers::new(kind, seed, pixel, 2);
            let draw = |seed| move |pixel| stream(seed, pixel).pair(BSDF);
            assert_independent(
                draw(seed_a),
                draw(seed_b),
                &format!("{name}: seeds {seed_a} and {seed_b}"),
            );
            for pixel in 0..COUNT {
                assert_ne!(
                    stream(seed_a, pixel).bits(BSDF),
                    stream(seed_b, pixel).bits(BSDF),
                    "{name}: pixel {pixel}"
                );
            }
        }
    }
}

/// How many leading binary digits two numbers share, at most 5.
fn shared_digits(a: f32, b: f32) -> usize {
    (0..5)
        .take_while(|digit| {
            ((a * 2.0_f32.powi(digit + 1)) as u32) == ((b * 2.0_f32.powi(digit + 1)) as u32)
        })
        .count()
}

/// Asserts that how close two samples of a pixel are in one dimension says nothing about how close
/// they are in another.
///
/// Owen scrambling keeps the number of shared digits, so this tells whether the order of the points
/// is shuffled: `draw` gives the first axis of two dimensions, for a pixel and a sample. Samples 0
/// and 32 to 63 share k digits with probability 2^-(k+1) if the shuffle is uniform.
fn assert_order_is_shuffled(draw: impl Fn(u32, u32) -> [f32; 2]) {
    let digits = |k: usize| if k < 5 { 0.5_f64.powi(k as i32 + 1) } else { 0.5_f64.powi(5) };
    let expected: Vec<f64> =
        (0..36).map(|c| digits(c / 6) * digits(c % 6) * f64::from(COUNT)).collect();
    for other in [32, 37, 62, 63] {
        let cells = (0..COUNT).map(|pixel| {
            let ([a, b], [other_a, other_b]) = (draw(pixel, 0), draw(pixel, other));
            shared_digits(a, other_a) * 6 + shared_digits(b, other_b)
        });
        assert_chi_square(&histogram(36, cells), &expected, &format!("samples 0 and {other}"));
    }
}

#[test]
fn sobol_dimensions_are_shuffled_independently() {
    for (a, b) in DIMENSIONS {
        assert_order_is_shuffled(|pixel, index| {
            let stream = RandomNumbers::new(SOBOL, 1, pixel, index);
            [stream.pair(a)[0], stream.pair(b)[0]]
        });
    }
}

/// The test can fail: two mirrored copies of one sequence have one order.
#[test]
#[should_panic(expected = "chi-square")]
fn a_common_order_is_rejected() {
    assert_order_is_shuffled(|pixel, index| {
        let x = unit_float(scrambled_sobol(index, hash(pixel))[0]);
        [x, 1.0 - 1.0 / 16_777_216.0 - x]
    });
}

/// The test can fail: a tenth of the second number is the first.
#[test]
#[should_panic(expected = "chi-square")]
fn dependent_dimensions_are_rejected() {
    let draw =
        |dimension| move |index| RandomNumbers::new(INDEPENDENT, 1, 4711, index).pair(dimension);
    let dependent = |index| {
        let ([ax, ay], [bx, by]) = (draw(BSDF)(index), draw(CHOICES)(index));
        [(bx + 0.1 * ax).fract(), if index % 10 == 0 { ay } else { by }]
    };
    assert_independent(draw(BSDF), dependent, "dependent");
}
