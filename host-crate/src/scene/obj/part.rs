//! The triangles of one material.

use super::polygon::Cutter;
use super::texture_map::Laid;
use crate::color::srgb_decode;
use crate::scene::bounds::MAX_COORDINATE;
use crate::scene::material::MaterialId;
use crate::scene::mesh::Mesh;
use crate::scene::text::Name;
use glam::{DAffine3, DMat3, DVec2, DVec3, Vec2, Vec3, Vec4};

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
    /// Second texture coordinates of the vertices, where there are first ones.
    pub second_coordinates: Option<Vec<DVec2>>,
    /// Whether every corner has a normal; else none has.
    pub has_normals: bool,
    /// The lines of a vertex, a texture coordinate and a normal that are unusable, if any corner
    /// has one.
    pub unusable: [Option<usize>; 3],
    /// How many faces name a texture coordinate that is not there, and the first such line; the
    /// same of normals.
    pub dangling: [(usize, usize); 2],
    /// Positions, texture coordinates and normals, each with indices.
    pub(in crate::scene) mesh: tobj::Mesh,
}

impl Part {
    /// How many triangles its faces are cut into, at most: some may have no area.
    pub(in crate::scene) fn triangle_count(&self) -> usize {
        let tobj::Mesh { indices, face_arities, .. } = &self.mesh;
        if face_arities.is_empty() {
            return indices.len() / 3;
        }
        face_arities.iter().map(|&arity| arity.saturating_sub(2) as usize).sum()
    }

    /// Its positions as the file has them.
    pub(in crate::scene) fn positions(&self) -> impl ExactSizeIterator<Item = DVec3> + Clone {
        self.mesh.positions.chunks_exact(3).map(DVec3::from_slice)
    }

    /// Its triangles where `placement` has them, with its normals and colours if there are any, and
    /// with the texture coordinates that are wanted, `laid` as textures lie.
    pub(in crate::scene) fn mesh(
        &self,
        material: MaterialId,
        placement: &Placement,
        laid: Option<&Laid>,
    ) -> Mesh {
        let mut triangles = self.triangles();
        if placement.mirrors() {
            // Their fronts stay outside.
            triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
        }
        let tobj::Mesh { indices, normal_indices, texcoord_indices, .. } = &self.mesh;
        let turned = placement.of_normals();
        let normal = |corner: usize| {
            unit(&self.mesh.normals[3 * normal_indices[corner] as usize..], &turned)
        };
        let uv = |corner: usize| {
            DVec2::from_slice(&self.mesh.texcoords[2 * texcoord_indices[corner] as usize..])
        };
        let colour = |corner: usize| self.colour(indices[corner] as usize);
        let second = laid.filter(|laid| laid.takes_second).and(self.second_coordinates.as_ref());
        Mesh {
            material,
            tangents: None,
            second_coordinates: second.map(|second| {
                let at = |corner: usize| second[indices[corner] as usize];
                triangles.iter().map(|corners| near_zero(corners.map(at))).collect()
            }),
            colours: self
                .has_colours()
                .then(|| triangles.iter().map(|corners| corners.map(colour)).collect()),
            positions: placement.positions(self).map(DVec3::as_vec3).collect(),
            triangles: triangles.iter().map(|corners| corners.map(|at| indices[at])).collect(),
            normals: self
                .has_normals
                .then(|| triangles.iter().map(|corners| corners.map(normal)).collect()),
            texture_coordinates: laid.filter(|_| self.has_texture_coordinates).map(|laid| {
                triangles
                    .iter()
                    .map(|corners| near_zero(corners.map(uv).map(|uv| laid.map.of(uv))))
                    .collect()
            }),
        }
    }

    /// Whether its vertices have colours.
    pub(in crate::scene) fn has_colours(&self) -> bool {
        !self.mesh.vertex_color.is_empty()
    }

    /// The colour of a vertex, which the file has as sRGB: so programs write them.
    fn colour(&self, vertex: usize) -> Vec4 {
        let code = DVec3::from_slice(&self.mesh.vertex_color[3 * vertex..]);
        DVec3::from(code.to_array().map(srgb_decode)).as_vec3().extend(1.0)
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

/// Where the vertices of an OBJ go.
#[derive(Clone, Copy, Debug)]
pub(in crate::scene) struct Placement {
    /// How they are moved first, by what can be undone; none where they stay.
    pub transform: Option<DAffine3>,
    /// What is then taken off.
    pub origin: DVec3,
}

impl Placement {
    /// The positions of a part.
    pub(in crate::scene) fn positions(
        self,
        part: &Part,
    ) -> impl ExactSizeIterator<Item = DVec3> + Clone + use<'_> {
        part.positions().map(move |position| {
            let moved = self.transform.map_or(position, |t| t.transform_point3(position));
            moved - self.origin
        })
    }

    /// Whether left becomes right.
    fn mirrors(&self) -> bool {
        self.transform.is_some_and(|transform| transform.matrix3.determinant() < 0.0)
    }

    /// What normals are multiplied by, if by anything.
    fn of_normals(&self) -> Option<DMat3> {
        self.transform.map(|transform| transform.matrix3.inverse().transpose())
    }
}

/// The unit vector, turned; zero stays zero.
fn unit(normal: &[f64], turned: &Option<DMat3>) -> Vec3 {
    let normal = DVec3::from_slice(normal).normalize_or_zero();
    let turned = turned.map_or(normal, |turned| (turned * normal).normalize_or_zero());
    turned.as_vec3()
}

/// Textures repeat: whole numbers taken off all corners of a triangle change nothing but how many
/// digits an f32 has left.
fn near_zero(corners: [DVec2; 3]) -> [Vec2; 3] {
    let whole = corners[0].min(corners[1]).min(corners[2]).floor();
    corners.map(|corner| (corner - whole).min(DVec2::splat(MAX_COORDINATE)).as_vec2())
}
