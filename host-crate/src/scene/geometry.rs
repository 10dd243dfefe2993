//! Triangles: from meshes and quads to what the kernels read.

use super::format::Quad;
use super::obj::Part;
use glam::{DVec3, Vec3};
use raystream_shaders::scene::triangle::Attributes;
use raystream_shaders::scene::triangle::{NO_ATTRIBUTES, Triangle};
use std::collections::HashSet;

/// The triangles of a scene as they are gathered.
#[derive(Default)]
pub(super) struct Geometry {
    pub triangles: Vec<Triangle>,
    pub attributes: Vec<Attributes>,
    /// How many triangles had no area.
    pub degenerate: usize,
    /// How many triangles had the corners of an earlier one.
    pub duplicates: usize,
    /// The corners of the triangles so far; `None` when duplicates are kept.
    seen: Option<HashSet<[[u32; 3]; 3]>>,
}

/// Which of the attributes of a part are of use.
#[derive(Clone, Copy)]
pub(super) struct Wanted {
    pub normals: bool,
    pub texture_coordinates: bool,
}

impl Geometry {
    /// No triangles; `dedupe` drops those with the same three corners as an earlier one, in any
    /// order.
    pub(super) fn new(dedupe: bool) -> Self {
        Self { seen: dedupe.then(HashSet::new), ..Self::default() }
    }

    /// Adds the triangles of a part, which must have what is `wanted`.
    pub(super) fn add_part(&mut self, part: &Part, material: u32, wanted: Wanted) {
        let mesh = &part.mesh;
        let position = |corner: usize| vec3(&mesh.positions, mesh.indices[corner]);
        for first in (0..mesh.indices.len()).step_by(3) {
            let corners = [0, 1, 2].map(|k| position(first + k));
            let Some(mut triangle) = with_area(corners, material) else {
                self.degenerate += 1;
                continue;
            };
            if self.seen.as_mut().is_some_and(|seen| !seen.insert(identity(corners))) {
                self.duplicates += 1;
                continue;
            }
            if wanted.normals || wanted.texture_coordinates {
                triangle.attributes = self.attributes.len() as u32;
                self.attributes.push(attributes(mesh, first, wanted));
            }
            self.triangles.push(triangle);
        }
    }

    /// Adds the two triangles of a quad; false when it has no area.
    #[must_use]
    pub(super) fn add_quad(&mut self, quad: &Quad, material: u32) -> bool {
        let (o, u, v) = (quad.corner.0, quad.u.0, quad.v.0);
        let [a, b, c, d] = [o, o + u, o + u + v, o + v].map(|corner| corner.as_vec3());
        let triangles = [[a, b, c], [a, c, d]].map(|corners| with_area(corners, material));
        self.triangles.extend(triangles.iter().flatten());
        triangles.iter().all(Option::is_some)
    }
}

/// The triangle, if it has an area and therefore a normal.
fn with_area(corners: [Vec3; 3], material: u32) -> Option<Triangle> {
    let [a, b, c] = corners;
    let exact = [a, b, c].map(|corner| corner.as_dvec3());
    let area = (exact[1] - exact[0]).cross(exact[2] - exact[0]).length();
    let triangle =
        Triangle { corner: a, edge1: b - a, edge2: c - a, material, attributes: NO_ATTRIBUTES };
    (area > 0.0 && triangle.normal().is_finite()).then_some(triangle)
}

/// The same for every triangle with the same corners, in any order.
fn identity(corners: [Vec3; 3]) -> [[u32; 3]; 3] {
    // Adding zero makes a zero of -0.
    let mut bits = corners.map(|corner| (corner + Vec3::ZERO).to_array().map(f32::to_bits));
    bits.sort_unstable();
    bits
}

fn attributes(mesh: &tobj::Mesh, first: usize, wanted: Wanted) -> Attributes {
    let mut attributes = Attributes::default();
    if wanted.normals {
        let [n0, n1, n2] =
            [0, 1, 2].map(|k| unit(vec3(&mesh.normals, mesh.normal_indices[first + k])));
        attributes = Attributes { normal0: n0, normal1: n1, normal2: n2, ..attributes };
    }
    if wanted.texture_coordinates {
        let [[u0, v0], [u1, v1], [u2, v2]] = [0, 1, 2].map(|k| {
            let at = mesh.texcoord_indices[first + k] as usize * 2;
            [mesh.texcoords[at], mesh.texcoords[at + 1]]
        });
        attributes = Attributes { u0, v0, u1, v1, u2, v2, ..attributes };
    }
    attributes
}

/// The unit vector; zero stays zero.
fn unit(normal: Vec3) -> Vec3 {
    let normal: DVec3 = normal.as_dvec3();
    normal.normalize_or_zero().as_vec3()
}

fn vec3(values: &[f32], index: u32) -> Vec3 {
    let at = index as usize * 3;
    Vec3::new(values[at], values[at + 1], values[at + 2])
}
