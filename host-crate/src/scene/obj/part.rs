//! The triangles of one material.

use super::polygon::Cutter;
use super::texture_map::TextureMap;
use crate::scene::bounds::MAX_COORDINATE;
use crate::scene::material::MaterialId;
use crate::scene::mesh::Mesh;
use crate::scene::text::Name;
use glam::{DVec2, DVec3, Vec2, Vec3};

/// All faces of one material that have the same of texture coordinates and normals.
#[derive(Debug)]
pub(in crate::scene) struct Part {
    /// The material's name.
    pub material: Name,
    /// How many faces there are.
    pub faces: usize,
    /// The line of the first one.
    pub first_line: usize,
    /// Whether every corner has a texture coordinate; else none has.
    pub has_texture_coordinates: bool,
    /// Whether every corner has a normal; else none has.
    pub has_normals: bool,
    /// The lines of a vertex, a texture coordinate and a normal that are unusable, if any corner
    /// has one.
    pub unusable: [Option<usize>; 3],
    /// How many faces name a texture coordinate that is not there, and the first such line; the same
    /// of normals.
    pub dangling: [(usize, usize); 2],
    /// Positions, texture coordinates and normals, each with indices.
    pub(in crate::scene) mesh: tobj::Mesh,
}

impl Part {
    /// Its positions as the file has them.
    pub(in crate::scene) fn positions(&self) -> impl ExactSizeIterator<Item = DVec3> {
        self.mesh.positions.chunks_exact(3).map(DVec3::from_slice)
    }

    /// Its triangles, with `origin` taken off their positions, with its normals if there are any,
    /// and with the texture coordinates that `map` makes of its own, if wanted.
    pub(in crate::scene) fn mesh(
        &self,
        material: MaterialId,
        origin: DVec3,
        map: Option<&TextureMap>,
    ) -> Mesh {
        let triangles = self.triangles();
        let tobj::Mesh { indices, normal_indices, texcoord_indices, .. } = &self.mesh;
        let normal =
            |corner: usize| unit(&self.mesh.normals[3 * normal_indices[corner] as usize..]);
        let uv = |corner: usize| {
            DVec2::from_slice(&self.mesh.texcoords[2 * texcoord_indices[corner] as usize..])
        };
        Mesh {
            material,
            positions: self.positions().map(|position| (position - origin).as_vec3()).collect(),
            triangles: triangles.iter().map(|corners| corners.map(|at| indices[at])).collect(),
            normals: self
                .has_normals
                .then(|| triangles.iter().map(|corners| corners.map(normal)).collect()),
            texture_coordinates: map.filter(|_| self.has_texture_coordinates).map(|map| {
                triangles
                    .iter()
                    .map(|corners| near_zero(corners.map(uv).map(|uv| map.of(uv))))
                    .collect()
            }),
        }
    }

    /// The triangles of its faces, as places in the lists of indices.
    fn triangles(&self) -> Vec<[usize; 3]> {
        let tobj::Mesh { positions, indices, face_arities, .. } = &self.mesh;
        // tobj leaves them out where all faces are triangles.
        if face_arities.is_empty() {
            return (0..indices.len() / 3).map(|face| [0, 1, 2].map(|at| 3 * face + at)).collect();
        }
        let mut cutter = Cutter::new();
        let mut corners = Vec::new();
        let mut triangles = Vec::with_capacity(indices.len());
        let mut first = 0;
        for arity in face_arities.iter().map(|&arity| arity as usize) {
            let face = &indices[first..first + arity];
            corners.clear();
            corners.extend(face.iter().map(|&at| DVec3::from_slice(&positions[3 * at as usize..])));
            cutter.cut(&corners, |triangle| triangles.push(triangle.map(|at| first + at)));
            first += arity;
        }
        triangles
    }
}

/// The unit vector; zero stays zero.
fn unit(normal: &[f64]) -> Vec3 {
    DVec3::from_slice(normal).normalize_or_zero().as_vec3()
}

/// Textures repeat: whole numbers taken off all corners of a triangle change nothing but how many
/// digits an f32 has left.
fn near_zero(corners: [DVec2; 3]) -> [Vec2; 3] {
    let whole = corners[0].min(corners[1]).min(corners[2]).floor();
    corners.map(|corner| (corner - whole).min(DVec2::splat(MAX_COORDINATE)).as_vec2())
}
