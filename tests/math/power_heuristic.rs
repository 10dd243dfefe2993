//! The weights that two techniques of the same estimate get.

use raystream_shaders::math::power_heuristic;

/// Densities from the smallest number to infinity.
const DENSITIES: [f32; 12] =
    [f32::MIN_POSITIVE, 1e-30, 1e-12, 1e-3, 0.3, 1.0, 2.0, 77.0, 1e6, 1e19, 1e30, f32::MAX];

#[test]
fn the_weights_of_two_techniques_sum_to_1() {
    for a in DENSITIES {
        for b in DENSITIES {
            let (of_a, of_b) = (power_heuristic(a, b), power_heuristic(b, a));
            assert!((0.0..=1.0).contains(&of_a), "{a}, {b}: {of_a}");
            assert!((of_a + of_b - 1.0).abs() < 1e-6, "{a}, {b}: {of_a} + {of_b}");
        }
    }
}

#[test]
fn the_weights_are_squares_over_their_sum() {
    for (a, b) in [(1.0, 1.0), (1.0, 2.0), (0.3, 0.01), (1e15, 3e15), (1e-15, 2e-15)] {
        let (a64, b64) = (f64::from(a), f64::from(b));
        let expected = a64 * a64 / (a64 * a64 + b64 * b64);
        assert!((f64::from(power_heuristic(a, b)) - expected).abs() < 1e-6, "{a}, {b}");
    }
}

/// What cannot be drawn has no weight, and what cannot be drawn otherwise has all of it.
#[test]
fn impossible_and_infinite_densities_are_safe() {
    for pdf in DENSITIES {
        assert_eq!(power_heuristic(pdf, 0.0), 1.0, "{pdf}");
        assert_eq!(power_heuristic(0.0, pdf), 0.0, "{pdf}");
        assert_eq!(power_heuristic(pdf, f32::INFINITY), 0.0, "{pdf}");
        assert_eq!(power_heuristic(f32::INFINITY, pdf), 1.0, "{pdf}");
    }
    assert_eq!(power_heuristic(0.0, 0.0), 0.0);
    assert_eq!(power_heuristic(0.0, f32::INFINITY), 0.0);
    assert_eq!(power_heuristic(f32::INFINITY, 0.0), 1.0);
}
