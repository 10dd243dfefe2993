//! Offsets that are drawn from the filters of pixels, and pixels that are drawn for splats.

use raystream::render::PixelFilterShape;
use raystream_shaders::film::pixel_filter::{
    BLACKMAN_HARRIS, BOX, Chosen, GAUSSIAN, PixelFilter, TENT,
};
use raystream_shaders::math::random::{PIXEL, hash, unit_float};
use raystream_tests::histogram::{SAMPLERS, cell, histogram, points};
use raystream_tests::statistics::{assert_chi_square, normal_quantile};

const RADIUS: f32 = 1.7;
/// Cells along each side of the square that a filter reaches.
const CELLS: usize = 24;

fn filters() -> Vec<(&'static str, PixelFilter)> {
    let kinds = [BOX, TENT, GAUSSIAN, BLACKMAN_HARRIS];
    PixelFilterShape::ALL
        .iter()
        .zip(kinds)
        .map(|(shape, kind)| (shape.name(), PixelFilter { kind, radius: RADIUS }))
        .collect()
}

/// The integral of the filter over each cell.
fn integrals(filter: &PixelFilter) -> Vec<f64> {
    const FINE: usize = 40;
    let width = 2.0 * f64::from(RADIUS) / (CELLS * FINE) as f64;
    let place = |k: usize| ((k as f64 + 0.5) * width - f64::from(RADIUS)) as f32;
    let mut sums = vec![0.0; CELLS * CELLS];
    for row in 0..CELLS * FINE {
        for column in 0..CELLS * FINE {
            let density = f64::from(filter.density([place(column), place(row)]));
            sums[row / FINE * CELLS + column / FINE] += density * width * width;
        }
    }
    sums
}

#[test]
fn offsets_have_the_density_of_the_filter() {
    const COUNT: u32 = 1 << 18;
    for (name, filter) in filters() {
        let shares = integrals(&filter);
        let whole: f64 = shares.iter().sum();
        assert!((whole - 1.0).abs() < 1e-3, "{name}: integrates to {whole}");
        let expected: Vec<f64> = shares.iter().map(|s| s / whole * f64::from(COUNT)).collect();
        for (kind, sampler) in SAMPLERS {
            let cells = points(kind, PIXEL, COUNT).map(|u| {
                let [x, y] = filter.offset(u).map(|offset| {
                    assert!(offset.abs() <= RADIUS, "{name}: {offset}");
                    cell(f64::from(0.5 * (offset / RADIUS + 1.0)), CELLS)
                });
                y * CELLS + x
            });
            let counts = histogram(CELLS * CELLS, cells);
            assert_chi_square(&counts, &expected, &format!("{name}, {sampler}"));
        }
    }
}

/// The test can fail: filters of two widths differ.
#[test]
#[should_panic(expected = "chi-square")]
fn another_width_is_rejected() {
    let (_, filter) = filters()[1];
    let expected: Vec<f64> =
        integrals(&filter).iter().map(|share| share * f64::from(1 << 18)).collect();
    let narrower = PixelFilter { radius: 0.95 * RADIUS, ..filter };
    let cells = points(SAMPLERS[1].0, PIXEL, 1 << 18).map(|u| {
        let [x, y] =
            narrower.offset(u).map(|offset| cell(f64::from(0.5 * (offset / RADIUS + 1.0)), CELLS));
        y * CELLS + x
    });
    assert_chi_square(&histogram(CELLS * CELLS, cells), &expected, "narrower");
}

/// In the mean a splat adds to each pixel what the filter says of its distance.
#[test]
fn splats_count_for_every_pixel_by_its_filter() {
    const COUNT: u32 = 1 << 16;
    const PLACES: u32 = 20;
    // Of this many comparisons one fails by chance in 1 of 10^4 runs.
    let limit = normal_quantile(1.0 - 0.5e-4 / f64::from(4 * PLACES * 49));
    for (name, filter) in filters() {
        for k in 0..PLACES {
            let place = [0, 1].map(|axis| 20.0 * unit_float(hash(2 * k + axis)) - 3.0);
            let mut sums = std::collections::BTreeMap::<[i32; 2], f64>::new();
            for n in 0..COUNT {
                let u = unit_float(hash(n ^ hash(k)));
                let Chosen { pixel, weight } = filter.choose(place, u);
                *sums.entry(pixel).or_default() += f64::from(weight) / f64::from(COUNT);
            }
            let whole: f64 = sums.values().sum();
            assert!(whole > 0.5 && whole < 2.0, "{name}: {whole}");
            let middle = place.map(|place| place.floor() as i32);
            for row in middle[1] - 3..=middle[1] + 3 {
                for column in middle[0] - 3..=middle[0] + 3 {
                    let offset = [place[0] - column as f32 - 0.5, place[1] - row as f32 - 0.5];
                    let expected = f64::from(filter.density(offset));
                    let found = sums.get(&[column, row]).copied().unwrap_or(0.0);
                    // All pixels have one weight, and chances that are shares of it.
                    let chance = expected / whole;
                    let error = whole * (chance * (1.0 - chance) / f64::from(COUNT)).sqrt();
                    let off = (found - expected).abs();
                    assert!(off <= limit * error + 1e-6, "{name}, {place:?}: {found} {expected}");
                }
            }
        }
    }
}
