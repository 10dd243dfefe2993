//! The triangles of a scene, with their corners' attributes.

use super::scene_triangle::SceneTriangle;
use super::triangles::Functions;
use crate::scene::mesh::has_area;
use crate::scene::{Mesh, Scene};
use glam::{Vec2, Vec3};
use rayon::slice::ParallelSliceMut;
use raystream_shaders::math::packed::{NO_TANGENT, Tangent};
use raystream_shaders::scene::triangle::{Attributes, NO_ATTRIBUTES};

/// The triangles of a scene: of its meshes in order, then two of each quad light.
#[derive(Default)]
pub struct Geometry {
    /// Those with an area.
    pub triangles: Vec<SceneTriangle>,
    /// What [`SceneTriangle::attributes`] points to.
    pub attributes: Vec<Attributes>,
    /// How many had no area, or were thinner than the roundings of their own corners, and are left
    /// out.
    pub degenerate: usize,
    /// How many have the corners of an earlier one, in the same order, and are left out: no ray
    /// hits them, since it hits the first. Where paths must know what they are in, boundaries of
    /// different bodies are not copies.
    pub copies: usize,
}

/// Gathers the triangles of a scene that was checked. The material of the `n`-th quad light follows
/// those of the scene, `n` after them.
pub fn gather(scene: &Scene) -> Geometry {
    let mut geometry = Geometry::default();
    for mesh in &scene.meshes {
        geometry.add_mesh(mesh);
    }
    for (material, light) in (scene.materials.len() as u32..).zip(&scene.quad_lights) {
        for corners in light.triangles() {
            geometry.add_triangle(corners, material, None);
        }
    }
    geometry.leave_out_copies(&bodies_apart(scene));
    geometry
}

/// For each material the number of the body that it bounds, above 0, where paths count boundaries:
/// those of two bodies may be in one place.
fn bodies_apart(scene: &Scene) -> Vec<u32> {
    if !scene.has_media() {
        return Vec::new();
    }
    (1..).zip(&scene.materials).map(|(n, m)| m.body().map_or(0, |_| n)).collect()
}

impl Geometry {
    fn add_mesh(&mut self, mesh: &Mesh) {
        for index in 0..mesh.triangles.len() {
            let normals = mesh.normals.as_ref().map(|normals| normals[index]);
            let coordinates = mesh.texture_coordinates.as_ref().map(|uvs| uvs[index]);
            let wanted = normals.is_some() || coordinates.is_some();
            let corners = mesh.corners(index);
            let attributes = wanted.then(|| Attributes {
                tangent: coordinates.map_or(NO_TANGENT, |uvs| tangent(corners, uvs)),
                ..attributes(normals.unwrap_or_default(), coordinates.unwrap_or_default())
            });
            self.add_triangle(corners, mesh.material.0, attributes);
        }
    }

    fn add_triangle(&mut self, corners: [Vec3; 3], material: u32, attributes: Option<Attributes>) {
        if !has_area(corners) || Functions::of(corners).is_thin() {
            self.degenerate += 1;
            return;
        }
        let index = match attributes {
            Some(_) => self.attributes.len() as u32,
            None => NO_ATTRIBUTES,
        };
        self.attributes.extend(attributes);
        self.triangles.push(SceneTriangle { corners, material, attributes: index });
    }
}

impl Geometry {
    fn leave_out_copies(&mut self, bodies: &[u32]) {
        let bits = |index: &u32| {
            let triangle = &self.triangles[*index as usize];
            let corners = triangle.corners.map(|corner| corner.to_array().map(f32::to_bits));
            (corners, bodies.get(triangle.material as usize).copied().unwrap_or(0))
        };
        let mut order: Vec<u32> = (0..self.triangles.len() as u32).collect();
        order.par_sort_unstable_by(|a, b| bits(a).cmp(&bits(b)).then(a.cmp(b)));
        let mut is_copy = vec![false; order.len()];
        for pair in order.windows(2) {
            is_copy[pair[1] as usize] = bits(&pair[0]) == bits(&pair[1]);
        }
        self.copies = is_copy.iter().filter(|&&is_copy| is_copy).count();
        let mut is_copy = is_copy.into_iter();
        self.triangles.retain(|_| is_copy.next() == Some(false));
    }
}

fn attributes([normal0, normal1, normal2]: [Vec3; 3], coordinates: [Vec2; 3]) -> Attributes {
    let [[u0, v0], [u1, v1], [u2, v2]] = coordinates.map(|uv| uv.to_array());
    Attributes { normal0, u0, normal1, v0, normal2, u1, v1, u2, v2, tangent: NO_TANGENT }
}

/// The direction along a triangle in which the first texture coordinate grows and the second does
/// not.
fn tangent([a, b, c]: [Vec3; 3], [uv_a, uv_b, uv_c]: [Vec2; 3]) -> u32 {
    let (edge1, edge2) = ((b - a).as_dvec3(), (c - a).as_dvec3());
    let (along1, along2) = ((uv_b - uv_a).as_dvec2(), (uv_c - uv_a).as_dvec2());
    let area = along1.perp_dot(along2);
    let direction = (edge1 * along2.y - edge2 * along1.y) * area.signum();
    match direction.try_normalize() {
        Some(direction) if area != 0.0 => {
            Tangent { direction: direction.as_vec3(), is_mirrored: area < 0.0 }.pack()
        }
        _ => NO_TANGENT,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Camera, FilmSize, Material, QuadLight};

    #[test]
    fn triangles_come_in_order_and_without_those_that_are_never_hit() {
        let camera = Camera::new(Vec3::Z, Vec3::ZERO, 40.0);
        let mut scene = Scene::new(camera, FilmSize { width: 4, height: 3 });
        let material = scene.add_material(Material::diffuse(Vec3::ONE));
        let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
        let mut mesh = Mesh::new(material, positions, vec![[0, 1, 2], [0, 1, 1], [2, 1, 0]]);
        scene.add_mesh(mesh.clone());
        scene.add_mesh(mesh.clone());
        mesh.positions[0].z = -1.0;
        mesh.normals = Some(vec![[Vec3::Z; 3], [Vec3::X; 3], [Vec3::NEG_Z; 3]]);
        scene.add_mesh(mesh);
        scene.add_quad_light(QuadLight::new(Vec3::Z, Vec3::X, Vec3::Y, Vec3::ONE));
        let Geometry { triangles, attributes, degenerate, copies } = gather(&scene);
        assert_eq!((degenerate, copies), (3, 2));
        let names: Vec<_> = triangles.iter().map(|t| (t.material, t.attributes)).collect();
        let flat = NO_ATTRIBUTES;
        assert_eq!(names, [(0, flat), (0, flat), (0, 0), (0, 1), (1, flat), (1, flat)]);
        assert_eq!(attributes.iter().map(|a| a.normal2).collect::<Vec<_>>(), [Vec3::Z, -Vec3::Z]);
    }
}
