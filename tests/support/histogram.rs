//! Counting of random numbers.

use crate::statistics::assert_chi_square;
use raystream_shaders::math::random::{INDEPENDENT, RandomNumbers, SOBOL};

/// Both kinds of random numbers, with their names.
pub const SAMPLERS: [(u32, &str); 2] = [(SOBOL, "Sobol"), (INDEPENDENT, "independent")];

/// Cells along each side of the unit square.
const SIDE: usize = 32;

/// The points that one pixel draws in `dimension`.
pub fn points(kind: u32, dimension: u32, count: u32) -> impl Iterator<Item = [f32; 2]> {
    (0..count).map(move |index| RandomNumbers::new(kind, 7, 1234, index).pair(dimension))
}

/// The cell, of `cells` along [0, 1], that holds `u`; what rounding took outside belongs to the
/// end.
pub fn cell(u: f64, cells: usize) -> usize {
    ((u * cells as f64) as usize).min(cells - 1)
}

/// How often each of 0..`cells` is among `values`.
pub fn histogram(cells: usize, values: impl IntoIterator<Item = usize>) -> Vec<u32> {
    let mut counts = vec![0; cells];
    for value in values {
        counts[value] += 1;
    }
    counts
}

/// Asserts that all cells have the same probability.
pub fn assert_uniform(counts: &[u32], what: &str) {
    let total: u32 = counts.iter().sum();
    assert_chi_square(counts, &vec![f64::from(total) / counts.len() as f64; counts.len()], what);
}

/// Asserts that the points are in [0, 1) and uniform over the unit square.
pub fn assert_uniform_over_square(points: impl IntoIterator<Item = [f32; 2]>, what: &str) {
    let cells = points.into_iter().map(|[x, y]| {
        assert!((0.0..1.0).contains(&x) && (0.0..1.0).contains(&y), "{what}: ({x}, {y})");
        cell(x.into(), SIDE) * SIDE + cell(y.into(), SIDE)
    });
    assert_uniform(&histogram(SIDE * SIDE, cells), what);
}
