//! Triangles in a space of their own.

use crate::scene::instance::{moved_tangents, normal_map};
use crate::scene::material::MaterialId;
use crate::scene::mesh::Mesh;
use glam::{DMat3, DMat4, Vec2, Vec3, Vec4};

/// Triangles of one material, with vertices that they share.
#[derive(Clone, Debug, Default)]
pub(super) struct Geometry {
    pub positions: Vec<Vec3>,
    /// One for each position; zero where there is none.
    pub normals: Option<Vec<Vec3>>,
    /// One for each position, with (0, 0) at the lower left.
    pub texture_coordinates: Option<Vec<Vec2>>,
    /// The same of a second set.
    pub second_coordinates: Option<Vec<Vec2>>,
    /// One for each position, linear, with alpha, each component in [0, 1].
    pub colours: Option<Vec<Vec4>>,
    /// One for each position: a unit vector along which `u` grows, and 1, or -1 where the texture is
    /// mirrored; zero where there is none.
    pub tangents: Option<Vec<Vec4>>,
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
            second_coordinates: self.of_corners(self.second_coordinates.as_deref(), seen),
            colours: self.of_corners(self.colours.as_deref(), seen),
            tangents: self.of_corners(self.tangents.as_deref(), seen).map(|tangents| {
                tangents.into_iter().map(|corners| moved_tangents(corners, &linear)).collect()
            }),
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
