//! What geometry shows that is not so: faces of glass in one place, coarse meshes with smooth
//! normals.

use crate::scene::description::Scene;
use crate::scene::material::Material;
use crate::scene::mesh::Mesh;
use glam::{DVec2, DVec3};
use std::collections::BTreeSet;

/// Pairs of triangles that are looked at, at most: a matter of a second.
const MAX_PAIRS: usize = 1 << 24;
/// Planes that are nearer, in units of the largest coordinate, are one: about what rays start from
/// surfaces.
const ONE_PLACE: f64 = 4e-6;
/// Triangles overlap if they have more of the smaller one's area in common.
const OVERLAP: f64 = 1e-3;
/// Normals that turn by a larger angle from corner to corner, in degrees, show steps.
const COARSE: f32 = 15.0;

/// The materials, as indices, of dielectrics without a priority that have faces in one place, in
/// whole or in part.
pub(super) fn glass_in_one_place(scene: &Scene) -> BTreeSet<usize> {
    let mut found = BTreeSet::new();
    let mut faces: Vec<Face> = Vec::new();
    for mesh in &scene.meshes {
        let material = mesh.material.0 as usize;
        if matches!(scene.materials[material], Material::Dielectric { priority: None, .. }) {
            faces.extend(mesh.triangles.iter().filter_map(|&at| Face::new(mesh, at, material)));
        }
    }
    faces.sort_by(|a, b| a.low.x.total_cmp(&b.low.x));
    let mut pairs = 0;
    for (index, face) in faces.iter().enumerate() {
        for other in faces[index + 1..].iter().take_while(|other| other.low.x <= face.high.x) {
            pairs += 1;
            if pairs > MAX_PAIRS {
                return found;
            }
            if face.is_in_place_of(other) {
                found.extend([face.material, other.material]);
            }
        }
    }
    found
}

/// The materials, as indices, of meshes that are smooth by their normals, but a quarter of whose
/// triangles, or more, are so large that steps show where light grazes them.
pub(super) fn coarse_and_smooth(scene: &Scene) -> BTreeSet<usize> {
    let is_coarse = |mesh: &&Mesh| {
        let normals = mesh.normals.as_deref().unwrap_or_default();
        let limit = COARSE.to_radians().cos();
        let turns = |[a, b, c]: &&[glam::Vec3; 3]| a.dot(*b).min(b.dot(*c)).min(c.dot(*a)) < limit;
        let coarse = normals.iter().filter(turns).count();
        coarse > 0 && 4 * coarse >= normals.len()
    };
    let meshes = scene.meshes.iter().chain(&scene.shapes);
    let coarse = meshes.filter(is_coarse).map(|mesh| mesh.material.0 as usize);
    let scatters =
        |material: &usize| matches!(scene.materials[*material], Material::Diffuse { .. });
    coarse.filter(scatters).collect()
}

/// A triangle of glass.
struct Face {
    corners: [DVec3; 3],
    normal: DVec3,
    low: DVec3,
    high: DVec3,
    /// Below this distance two planes are one.
    near: f64,
    material: usize,
}

impl Face {
    /// None where it has no area.
    fn new(mesh: &Mesh, at: [u32; 3], material: usize) -> Option<Self> {
        let corners = at.map(|corner| mesh.positions[corner as usize].as_dvec3());
        let [a, b, c] = corners;
        let normal = (b - a).cross(c - a).try_normalize()?;
        let largest = corners.iter().map(|corner| corner.abs().max_element()).fold(0.0, f64::max);
        let near = ONE_PLACE * largest;
        let (low, high) = (a.min(b).min(c) - near, a.max(b).max(c) + near);
        Some(Self { corners, normal, low, high, near, material })
    }

    fn is_in_place_of(&self, other: &Self) -> bool {
        let are_apart = self.low.cmpgt(other.high).any() || other.low.cmpgt(self.high).any();
        // Parallel up to an angle that moves a corner by no more than is near.
        if are_apart || self.normal.dot(other.normal).abs() < 1.0 - 1e-6 {
            return false;
        }
        let distance = |corner: &DVec3| (*corner - self.corners[0]).dot(self.normal).abs();
        if other.corners.iter().any(|corner| distance(corner) > self.near.max(other.near)) {
            return false;
        }
        let across = self.normal.any_orthonormal_vector();
        let axes = [across, self.normal.cross(across)];
        let flat = |corner: DVec3| {
            let from = corner - self.corners[0];
            DVec2::new(from.dot(axes[0]), from.dot(axes[1]))
        };
        let [one, two] = [self.corners.map(flat), other.corners.map(flat)];
        let smaller = area(&one).abs().min(area(&two).abs());
        area(&clipped(one.to_vec(), two)).abs() > OVERLAP * smaller
    }
}

/// The area of a polygon, below 0 if it runs clockwise.
fn area(corners: &[DVec2]) -> f64 {
    let next = corners.iter().cycle().skip(1);
    corners.iter().zip(next).map(|(a, b)| a.perp_dot(*b)).sum::<f64>() / 2.0
}

/// What of a convex polygon lies in a triangle (Sutherland and Hodgman).
fn clipped(mut polygon: Vec<DVec2>, mut triangle: [DVec2; 3]) -> Vec<DVec2> {
    if area(&triangle) < 0.0 {
        triangle.reverse();
    }
    for side in 0..3 {
        let (from, to) = (triangle[side], triangle[(side + 1) % 3]);
        let inside = |point: DVec2| (to - from).perp_dot(point - from);
        let mut kept = Vec::with_capacity(polygon.len() + 1);
        for (index, &point) in polygon.iter().enumerate() {
            let next = polygon[(index + 1) % polygon.len()];
            let (here, there) = (inside(point), inside(next));
            if here >= 0.0 {
                kept.push(point);
            }
            if (here >= 0.0) != (there >= 0.0) {
                kept.push(point + (next - point) * (here / (here - there)));
            }
        }
        polygon = kept;
    }
    polygon
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::camera::Camera;
    use crate::scene::film::FilmSize;
    use glam::Vec3;

    fn scene() -> Scene {
        let camera = Camera::new(Vec3::Z * 5.0, Vec3::ZERO, 40.0);
        Scene::new(camera, FilmSize { width: 8, height: 6 })
    }

    /// A square of two triangles that faces x, with a corner at `at`.
    fn square(at: Vec3, side: f32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
        let corners = corners.map(|(y, z)| at + Vec3::new(0.0, y, z) * side);
        (corners.to_vec(), vec![[0, 1, 2], [0, 2, 3]])
    }

    #[test]
    fn faces_of_glass_in_one_place_are_found() {
        let glass = |second: (Vec<Vec3>, Vec<[u32; 3]>), reflectance: Option<Vec3>| {
            let mut scene = scene();
            let clear = Material::glass(1.5);
            let other = reflectance.map_or(clear, Material::diffuse);
            let ids = [clear, other].map(|material| scene.add_material(material));
            for (id, (positions, triangles)) in ids.into_iter().zip([square(Vec3::X, 1.0), second])
            {
                scene.add_mesh(Mesh::new(id, positions, triangles));
            }
            glass_in_one_place(&scene).len()
        };
        let inner = |x: f32| square(Vec3::new(x, 0.2, 0.3), 0.5);
        assert_eq!(glass(inner(1.0), None), 2, "a part of the face");
        assert_eq!(glass(inner(1.000_001), None), 2, "nearer than rays can tell");
        assert_eq!(glass(inner(1.01), None), 0, "beside it");
        assert_eq!(glass(square(Vec3::new(1.0, 1.0, 0.0), 1.0), None), 0, "an edge in common");
        assert_eq!(glass(square(Vec3::new(1.0, 0.99, 0.0), 1.0), None), 2);
        assert_eq!(glass(inner(1.0), Some(Vec3::ONE)), 0, "glass on what is opaque");
        let (positions, mut triangles) = inner(1.0);
        triangles.iter_mut().for_each(|triangle| triangle.reverse());
        assert_eq!(glass((positions, triangles), None), 2, "facing the other way");
    }

    #[test]
    fn coarse_meshes_with_smooth_normals_are_found() {
        let coarse = |degrees: f32, material: Material| {
            let mut scene = scene();
            let id = scene.add_material(material);
            let (positions, triangles) = square(Vec3::ZERO, 1.0);
            let turned =
                |angle: f32| Vec3::new(angle.to_radians().cos(), angle.to_radians().sin(), 0.0);
            let normals = [[turned(0.0), turned(degrees), turned(0.0)], [turned(0.0); 3]];
            let mesh = Mesh::new(id, positions, triangles);
            scene.add_mesh(Mesh { normals: Some(normals.to_vec()), ..mesh });
            coarse_and_smooth(&scene).len()
        };
        let white = Material::diffuse(Vec3::ONE);
        assert_eq!([coarse(20.0, white), coarse(10.0, white)], [1, 0]);
        assert_eq!(coarse(20.0, Material::glass(1.5)), 0, "no light is sampled there");
    }
}
