//! Pictures as luminance, and chroma at fewer places.

use glam::{DVec3, Vec3};
use std::f32::consts::PI;

/// Chroma samples to each side that an interpolated one is made of.
const LOBES: usize = 5;

/// The colour of a luminance `y` with the chroma channels RY, (R - Y) / Y, and BY, (B - Y) / Y.
/// `weights` is what red, green and blue add to the luminance.
pub(super) fn color(y: f32, [ry, by]: [f32; 2], weights: DVec3) -> Vec3 {
    if ry == 0.0 && by == 0.0 {
        return Vec3::splat(y);
    }
    let (red, blue) = ((f64::from(ry) + 1.0) * f64::from(y), (f64::from(by) + 1.0) * f64::from(y));
    let green = (f64::from(y) - red * weights.x - blue * weights.z) / weights.y;
    DVec3::new(red, green, blue).as_vec3()
}

/// A plane of `width` values a row at twice as many places in each direction that `doubled` (x, y)
/// names: between the values by Lanczos's filter, at the edges as if the last went on.
pub(super) fn interpolate(values: Vec<f32>, width: usize, doubled: [bool; 2]) -> Vec<f32> {
    let height = values.len() / width.max(1);
    let wide = if doubled[0] {
        values.chunks_exact(width).flat_map(|row| double(width, |x| row[x])).collect()
    } else {
        values
    };
    if !doubled[1] {
        return wide;
    }
    let width = wide.len() / height;
    let columns: Vec<Vec<f32>> =
        (0..width).map(|x| double(height, |y| wide[y * width + x]).collect()).collect();
    (0..2 * height).flat_map(|y| columns.iter().map(move |column| column[y])).collect()
}

/// `count` values, each followed by the one between it and the next.
fn double(count: usize, value: impl Fn(usize) -> f32) -> impl Iterator<Item = f32> {
    let taps = taps();
    (0..2 * count).map(move |place| {
        let before = place / 2;
        if place.is_multiple_of(2) {
            return value(before);
        }
        let last = count - 1;
        let pairs = taps.iter().enumerate().map(|(distance, tap)| {
            tap * (value(before.saturating_sub(distance)) + value(last.min(before + 1 + distance)))
        });
        pairs.sum()
    })
}

/// The weights of the values at 1/2, 3/2 ... to either side of a place, which add up to 1/2.
fn taps() -> [f32; LOBES] {
    let sinc = |x: f32| (PI * x).sin() / (PI * x);
    let taps: [f32; LOBES] = std::array::from_fn(|distance| {
        let x = distance as f32 + 0.5;
        sinc(x) * sinc(x / LOBES as f32)
    });
    let sum: f32 = taps.iter().sum();
    taps.map(|tap| 0.5 * tap / sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chroma_is_undone() {
        let weights = DVec3::new(0.2126, 0.7152, 0.0722);
        for rgb in [Vec3::new(0.2, 0.7, 0.1), Vec3::new(3.0, 0.0, 0.5), Vec3::splat(0.3)] {
            let y = rgb.as_dvec3().dot(weights) as f32;
            let back = color(y, [(rgb.x - y) / y, (rgb.z - y) / y], weights);
            assert!(back.abs_diff_eq(rgb, 1e-5), "{back} is not {rgb}");
        }
        assert_eq!(color(0.25, [0.0, 0.0], weights), Vec3::splat(0.25));
    }

    /// A wave that is much longer than the distance of the samples comes back everywhere.
    #[test]
    fn slow_waves_are_interpolated() {
        let wave = |x: f32, y: f32| (0.2 * x).sin() + (0.15 * y).cos();
        for doubled in [[false, false], [true, false], [false, true], [true, true]] {
            let step = doubled.map(|doubled| if doubled { 2 } else { 1 });
            let (width, height) = (80 / step[0], 60 / step[1]);
            let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
            let samples =
                places.map(|(x, y)| wave((x * step[0]) as f32, (y * step[1]) as f32)).collect();
            let all = interpolate(samples, width, doubled);
            assert_eq!(all.len(), 80 * 60);
            for (index, value) in all.iter().enumerate() {
                let (x, y) = (index % 80, index / 80);
                // Beyond the edges the wave is not what the filter takes it to be.
                if (10..70).contains(&x) && (10..50).contains(&y) {
                    let expected = wave(x as f32, y as f32);
                    assert!((value - expected).abs() < 5e-3, "({x}, {y}): {value}, {expected}");
                }
            }
        }
        assert_eq!(interpolate(vec![7.0], 1, [true, true]), [7.0; 4]);
    }
}
