//! Triangles in a space of their own.

use crate::scene::material::MaterialId;
use crate::scene::mesh::Mesh;
use glam::{DMat3, DMat4, Vec2, Vec3};

/// Triangles of one material, with vertices that they share.
#[derive(Clone, Debug, Default)]
pub(super) struct Geometry {
    pub positions: Vec<Vec3>,
    /// One for each position; zero where there is none.
    pub normals: Option<Vec<Vec3>>,
    /// One for each position, with (0, 0) at the lower left.
    pub texture_coordinates: Option<Vec<Vec2>>,
    /// Indices of positions.
    pub triangles: Vec<[u32; 3]>,
    /// Whether triangles come of strips.
    pub is_joined: bool,
}

impl Geometry {
    /// The mesh of it where its positions are these; `transform` is what has moved them.
    pub(super) fn mesh(
        &self,
        material: MaterialId,
        positions: Vec<Vec3>,
        transform: &DMat4,
    ) -> Mesh {
        let linear = DMat3::from_mat4(*transform);
        let flips = linear.determinant() < 0.0;
        let seen = |[a, b, c]: [u32; 3]| if flips { [a, c, b] } else { [a, b, c] };
        let normals = self.normals.as_ref().map(|normals| turned(normals, &linear));
        Mesh {
            material,
            positions,
            triangles: self.triangles.iter().copied().map(seen).collect(),
            normals: self.of_corners(normals.as_deref(), seen),
            texture_coordinates: self.of_corners(self.texture_coordinates.as_deref(), seen),
        }
    }

    fn of_corners<T: Copy>(
        &self,
        of_vertices: Option<&[T]>,
        seen: impl Fn([u32; 3]) -> [u32; 3],
    ) -> Option<Vec<[T; 3]>> {
        let of_vertices = of_vertices?;
        let corners = |&triangle: &[u32; 3]| seen(triangle).map(|at| of_vertices[at as usize]);
        Some(self.triangles.iter().map(corners).collect())
    }
}

/// Normals of a surface that a linear map has changed, of unit length.
pub(super) fn turned(normals: &[Vec3], linear: &DMat3) -> Vec<Vec3> {
    let map = normal_map(linear);
    normals.iter().map(|normal| (map * normal.as_dvec3()).normalize_or_zero().as_vec3()).collect()
}

/// What normals are multiplied by: the matrix of cofactors, which is the inverse of the transpose
/// times the determinant, also where there is no inverse. The sign is that of the surface's front,
/// which a mirrored one keeps by its other winding.
pub(super) fn normal_map(linear: &DMat3) -> DMat3 {
    let [x, y, z] = [linear.x_axis, linear.y_axis, linear.z_axis];
    let cofactors = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
    // Lengths do not matter, but are not to vanish.
    let largest = cofactors.to_cols_array().into_iter().map(f64::abs).fold(0.0, f64::max);
    let scale = if largest > 0.0 && largest.is_finite() { 1.0 / largest } else { 1.0 };
    if linear.determinant() < 0.0 { cofactors * -scale } else { cofactors * scale }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn a_mirrored_surface_keeps_its_front_outside() {
        // A triangle of the plane z = 0 whose front is +z.
        let shape = Geometry {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            normals: Some(vec![Vec3::Z; 3]),
            triangles: vec![[0, 1, 2]],
            ..Geometry::default()
        };
        for scale in [
            DVec3::new(-1.0, 1.0, 1.0),
            DVec3::new(1.0, 1.0, -3.0),
            DVec3::new(-2.0, -1e-9, 1.0),
            DVec3::new(-1.0, -1.0, -1.0),
        ] {
            let transform = DMat4::from_scale(scale);
            let moved = |p: &Vec3| transform.transform_point3(p.as_dvec3()).as_vec3();
            let positions = shape.positions.iter().map(moved).collect();
            let mesh = shape.mesh(MaterialId(0), positions, &transform);
            let [a, b, c] = mesh.corners(0).map(Vec3::as_dvec3);
            let front = (b - a).cross(c - a).normalize();
            // What lies outside stays outside.
            let outside = transform.transform_vector3(DVec3::Z).normalize();
            assert!(front.dot(outside) > 0.9, "{scale}");
            let normal = mesh.normals.unwrap()[0][0].as_dvec3();
            assert!(front.dot(normal) > 0.999, "{scale}: {normal}");
        }
    }
}
