//! The noise of a picture of which nothing is known but its colours.

use glam::Vec3;
use rayon::prelude::*;

/// Pixels to each side over which noise is alike.
const RADIUS: i64 = 3;
/// The median of a squared normal deviate.
const MEDIAN_OF_SQUARE: f32 = 0.4549;

/// The variance of each pixel, the mean over the components.
///
/// A plane through a pixel and its neighbours explains what is not noise but curves and edges
/// (Immerkær, "Fast Noise Variance Estimation", 1996): what is left, by the mask 1 -2 1 along both
/// axes, has 36 times the variance. Edges leave more, so the median over 7x7 pixels counts.
pub fn estimate_variance(width: u32, height: u32, color: &[Vec3]) -> Vec<f32> {
    let (w, h) = (i64::from(width), i64::from(height));
    let at = |x: i64, y: i64| color[(y.clamp(0, h - 1) * w + x.clamp(0, w - 1)) as usize];
    let residue = |p: usize| {
        let (x, y) = (p as i64 % w, p as i64 / w);
        let along = |y: i64| at(x - 1, y) - 2.0 * at(x, y) + at(x + 1, y);
        let rest = along(y - 1) - 2.0 * along(y) + along(y + 1);
        let square = rest.length_squared() / (3.0 * 36.0);
        if square.is_finite() { square } else { 0.0 }
    };
    let squares: Vec<f32> = (0..color.len()).into_par_iter().map(residue).collect();
    let median = |p: usize| {
        let (x, y) = (p as i64 % w, p as i64 / w);
        let rows = (y - RADIUS).max(0)..(y + RADIUS + 1).min(h);
        let columns = (x - RADIUS).max(0)..(x + RADIUS + 1).min(w);
        let mut near: Vec<f32> = rows
            .flat_map(|row| columns.clone().map(move |column| (row * w + column) as usize))
            .map(|p| squares[p])
            .collect();
        let middle = near.len() / 2;
        let (_, median, _) = near.select_nth_unstable_by(middle, f32::total_cmp);
        *median / MEDIAN_OF_SQUARE
    };
    (0..color.len()).into_par_iter().map(median).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A normal deviate, nearly: the sum of twelve uniform ones.
    fn deviate(seed: &mut u32) -> f32 {
        let mut next = || {
            *seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (*seed >> 8) as f32 / (1 << 24) as f32
        };
        (0..12).map(|_| next()).sum::<f32>() - 6.0
    }

    #[test]
    fn noise_is_told_from_ramps_and_edges() {
        let (width, height) = (64_u32, 48_u32);
        let mut seed = 1;
        let color: Vec<Vec3> = (0..width * height)
            .map(|p| {
                let (x, y) = (p % width, p / width);
                let edge = if x > 30 { 5.0 } else { 0.0 };
                Vec3::splat(0.1 * (x + y) as f32 + edge + 0.2 * deviate(&mut seed))
            })
            .collect();
        let variances = estimate_variance(width, height, &color);
        let mean = variances.iter().sum::<f32>() / variances.len() as f32;
        // Some 3000 pixels by 49, whose medians scatter by a fourth: 3 %, and the edge and the
        // border.
        assert!((mean / 0.04 - 1.0).abs() < 0.2, "{mean}");
    }

    #[test]
    fn pictures_without_noise_have_none() {
        for (width, height) in [(1, 1), (1, 9), (7, 2), (16, 16)] {
            let color: Vec<Vec3> =
                (0..width * height).map(|p| Vec3::splat((p % width) as f32)).collect();
            let variances = estimate_variance(width, height, &color);
            assert!(variances.iter().skip(1).all(|&v| v < 0.1), "{width}x{height}: {variances:?}");
        }
    }
}
