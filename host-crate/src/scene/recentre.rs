//! Scenes far from the origin.
//!
//! An f32 has 24 bits: of a house at map coordinates it keeps half a metre. Files have all digits,
//! so their numbers are read as f64, and a place in the middle of the geometry becomes the origin
//! before they are rounded.

use super::description::Scene;
use glam::DVec3;
use std::path::Path;

/// So many times its own extent may geometry be from the origin. Farther away, details below a
/// millionth of the extent would be lost.
const MAX_DISTANCE: f64 = 16.0;
/// So many positions are looked at, to find the middle.
const SAMPLED: usize = 1 << 16;

/// Says so where the positions of the scene of a file count from elsewhere than the file's do.
pub(super) fn warn_if_moved(file: &Path, origin: DVec3, scene: &mut Scene) {
    if origin != DVec3::ZERO {
        let (file, DVec3 { x, y, z }) = (file.display(), origin);
        scene.warnings.push(format!(
            "{file}: the scene is far from the origin; all positions count from ({x}, {y}, {z}), \
             so that none loses its digits."
        ));
    }
}

/// What to take off all positions: round numbers near the middle of most of them, or zero if they
/// are near the origin. A few that lie elsewhere do not count.
pub(super) fn origin_of<P>(parts: impl Iterator<Item = P> + Clone) -> DVec3
where
    P: ExactSizeIterator<Item = DVec3>,
{
    let count: usize = parts.clone().map(|positions| positions.len()).sum();
    let step = count.div_ceil(SAMPLED).max(1);
    let sampled: Vec<DVec3> = parts.flatten().step_by(step).collect();
    if sampled.is_empty() {
        return DVec3::ZERO;
    }
    let mut middle = [0.0; 3];
    let mut extent: f64 = 0.0;
    for (axis, middle) in middle.iter_mut().enumerate() {
        let mut values: Vec<f64> = sampled.iter().map(|position| position[axis]).collect();
        values.sort_by(f64::total_cmp);
        let at = |share: f64| values[((values.len() - 1) as f64 * share) as usize];
        *middle = at(0.5);
        extent = extent.max(at(0.95) - at(0.05));
    }
    let middle = DVec3::from_array(middle);
    if middle.abs().max_element() <= MAX_DISTANCE * extent {
        return DVec3::ZERO;
    }
    // Round numbers are easy to add again.
    let step = extent.log2().floor().exp2();
    if step > 0.0 { (middle / step).round() * step } else { middle }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn one(positions: Vec<DVec3>) -> impl Iterator<Item = std::vec::IntoIter<DVec3>> + Clone {
        std::iter::once(positions.into_iter())
    }

    fn cube(at: DVec3, size: f64) -> Vec<DVec3> {
        let corner = |bits: u32| {
            DVec3::new(f64::from(bits & 1), f64::from(bits >> 1 & 1), f64::from(bits >> 2))
        };
        (0..8).map(|bits| at + corner(bits) * size).collect()
    }

    #[test]
    fn what_is_far_away_is_brought_near() {
        let utm = DVec3::new(448_250.5, 95.25, 5_411_780.75);
        let origin = origin_of(one(cube(utm, 10.0)));
        assert!(
            (origin - utm).abs().max_element() < 20.0 && origin * 8.0 == (origin * 8.0).round(),
            "{origin}"
        );
        let mut stray = cube(utm, 10.0).repeat(20);
        stray.push(DVec3::ZERO);
        assert!((origin_of(one(stray)) - utm).abs().max_element() < 20.0);
        let many = cube(utm, 10.0).repeat(100_000);
        assert!((origin_of(one(many)) - utm).abs().max_element() < 20.0);
    }

    #[test]
    fn what_is_near_stays() {
        assert_eq!(origin_of(one(cube(DVec3::splat(-5.0), 10.0))), DVec3::ZERO);
        assert_eq!(origin_of(one(cube(DVec3::splat(100.0), 10.0))), DVec3::ZERO);
        assert_eq!(origin_of(one(vec![])), DVec3::ZERO);
    }
}
