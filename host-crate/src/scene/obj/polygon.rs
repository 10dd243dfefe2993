//! Polygons in space, cut into triangles.

use earcut::Earcut;
use glam::{DVec2, DVec3};

/// A triangle of a fan may be turned over by this share of the polygon's area: what rounding does
/// to corners on one line.
const ROUNDING: f64 = 1e-9;

/// Cuts polygons into triangles.
pub(super) struct Cutter {
    earcut: Earcut<f64>,
    flat: Vec<[f64; 2]>,
    triangles: Vec<usize>,
}

impl Cutter {
    pub(super) fn new() -> Self {
        Self { earcut: Earcut::new(), flat: Vec::new(), triangles: Vec::new() }
    }

    /// Hands each triangle of a polygon to `emit`, as indices of three of its `corners`, which run
    /// around it in the same sense.
    ///
    /// What a fan around the first corner fills is filled by a fan; other polygons are cut as seen
    /// along their mean normal.
    pub(super) fn cut(&mut self, corners: &[DVec3], mut emit: impl FnMut([usize; 3])) {
        let fan = (2..corners.len()).map(|last| [0, last - 1, last]);
        if corners.len() <= 3 || !self.flatten(corners) || self.is_fan() {
            fan.for_each(emit);
            return;
        }
        self.earcut.earcut(self.flat.iter().copied(), &[], &mut self.triangles);
        if self.triangles.is_empty() {
            fan.for_each(emit);
            return;
        }
        for triangle in self.triangles.chunks_exact(3) {
            let [a, b, c] = [triangle[0], triangle[1], triangle[2]];
            emit(if self.area([a, b, c]) < 0.0 { [a, c, b] } else { [a, b, c] });
        }
    }

    /// Projects a polygon along its mean normal, so that it runs counter-clockwise; false if it has
    /// no area.
    fn flatten(&mut self, corners: &[DVec3]) -> bool {
        let first = corners[0];
        let normal: DVec3 =
            corners.windows(2).map(|pair| (pair[0] - first).cross(pair[1] - first)).sum();
        let Some(normal) = normal.try_normalize() else { return false };
        let (x, y) = normal.any_orthonormal_pair();
        self.flat.clear();
        let project = |&corner: &DVec3| [(corner - first).dot(x), (corner - first).dot(y)];
        self.flat.extend(corners.iter().map(project));
        true
    }

    /// Whether no triangle of the fan around the first corner is turned over.
    fn is_fan(&self) -> bool {
        let areas = || (2..self.flat.len()).map(|last| self.area([0, last - 1, last]));
        let least = -ROUNDING * areas().sum::<f64>().abs();
        areas().all(|area| area >= least)
    }

    /// Twice the area of a triangle; negative if it runs clockwise.
    fn area(&self, corners: [usize; 3]) -> f64 {
        let [a, b, c] = corners.map(|corner| DVec2::from_array(self.flat[corner]));
        (b - a).perp_dot(c - a)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;

    /// The triangles of a polygon.
    fn cut(corners: &[DVec3]) -> Vec<[usize; 3]> {
        let mut triangles = Vec::new();
        Cutter::new().cut(corners, |triangle| triangles.push(triangle));
        triangles
    }

    fn area_vector([a, b, c]: [DVec3; 3]) -> DVec3 {
        (b - a).cross(c - a) / 2.0
    }

    fn shapes() -> Vec<Vec<(f64, f64)>> {
        let star = (0..10).map(|corner| {
            let (sine, cosine) = (f64::from(corner) * std::f64::consts::PI / 5.0).sin_cos();
            let radius = if corner % 2 == 0 { 1.0 } else { 0.3 };
            (radius * cosine, radius * sine)
        });
        let comb = (0..9).flat_map(|tooth| {
            let x = f64::from(tooth);
            [(x, 0.5), (x + 0.5, 4.0)]
        });
        vec![
            vec![(0., 1.), (-1., 1.), (-1., -1.), (1., -1.), (1., 0.), (0., 0.)],
            vec![(-1., -1.), (0., -0.4), (1., -1.), (0., 1.)],
            vec![
                (1., 1.),
                (0.5, 1.),
                (0.5, -0.5),
                (-0.5, -0.5),
                (-0.5, 1.),
                (-1., 1.),
                (-1., -1.),
                (1., -1.),
            ],
            vec![
                (0., 0.),
                (1., 0.),
                (2., 0.),
                (3., 0.),
                (3., 1.),
                (2., 1.),
                (2., 2.),
                (3., 2.),
                (3., 3.),
                (0., 3.),
            ],
            star.collect(),
            comb.chain([(9.0, 0.0), (0.0, 0.0)]).rev().collect(),
        ]
    }

    /// Triangles that all run as the polygon does, and whose areas add up to its own, cover it
    /// once.
    #[test]
    fn any_simple_polygon_is_covered_once() {
        let turn = DQuat::from_scaled_axis(DVec3::new(0.3, 1.1, -0.7));
        for shape in shapes() {
            for first in 0..shape.len() {
                for reversed in [false, true] {
                    let mut corners: Vec<DVec3> = shape
                        .iter()
                        .map(|&(x, y)| turn * DVec3::new(x, y, 0.0) + DVec3::new(4e5, 90.0, 5e6))
                        .collect();
                    corners.rotate_left(first);
                    if reversed {
                        corners.reverse();
                    }
                    let whole: DVec3 = (2..corners.len())
                        .map(|last| area_vector([corners[0], corners[last - 1], corners[last]]))
                        .sum();
                    let areas = cut(&corners)
                        .iter()
                        .map(|triangle| {
                            area_vector(triangle.map(|corner| corners[corner]))
                                .dot(whole.normalize())
                        })
                        .collect::<Vec<_>>();
                    assert!(areas.iter().all(|&area| area > -1e-7), "{areas:?} {shape:?} {first}");
                    let sum: f64 = areas.iter().sum();
                    assert!((sum - whole.length()).abs() < 1e-6, "{sum} {whole} {shape:?} {first}");
                }
            }
        }
    }

    #[test]
    fn convex_polygons_are_fans() {
        let corners = [(0., 0.), (1., 0.), (1., 1.), (0., 1.), (-1., 0.5)];
        let corners = corners.map(|(x, y)| DVec3::new(x, 2.0, y));
        assert_eq!(cut(&corners), [[0, 1, 2], [0, 2, 3], [0, 3, 4]]);
        assert_eq!(cut(&[DVec3::ZERO; 4]), [[0, 1, 2], [0, 2, 3]], "no area");
    }

    #[test]
    fn a_polygon_that_is_not_flat_is_cut_as_seen_from_its_front() {
        // An arrow whose notch is lifted.
        let corners = [(-1., -1., 0.), (0., -0.4, 0.3), (1., -1., 0.), (0., 1., -0.2)];
        let corners = corners.map(|(x, y, z)| DVec3::new(x, y, z));
        let triangles = cut(&corners);
        assert_eq!(triangles.len(), 2);
        for triangle in triangles {
            assert!(triangle.contains(&1) && triangle.contains(&3), "{triangle:?}");
            assert!(area_vector(triangle.map(|corner| corners[corner])).z > 0.0);
        }
    }
}
