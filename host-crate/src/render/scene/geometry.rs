//! The triangles of a scene, with their corners' attributes.

use super::scene_triangle::SceneTriangle;
use super::triangles::Functions;
use crate::scene::instance::may_have_instances;
use crate::scene::mesh::has_area;
use crate::scene::{CoordinateSet, Material, Mesh, Placement, Scene, TextureId};
use glam::{DAffine3, DVec3, Vec2, Vec3, Vec4};
use obvhs::aabb::Aabb;
use rayon::slice::ParallelSliceMut;
use raystream_shaders::math::packed::{NO_TANGENT, Tangent};
use raystream_shaders::scene::triangle::{
    Attributes, NO_ATTRIBUTES, SecondCoordinates, Tangents, VertexColours,
};
use std::collections::HashSet;

/// The triangles of a scene.
#[derive(Default)]
pub struct Geometry {
    /// Those of its meshes in order, of what of its instances is repeated, and two of each quad
    /// light. The numbers count those that are left out, and those of shapes in each instance.
    pub world: Triangles,
    /// Those of shapes that have instances.
    pub shapes: Vec<Shape>,
    /// The instances of these.
    pub placed: Vec<Placed>,
    /// What [`SceneTriangle::attributes`] points to.
    pub corners: Corners,
    /// How many triangles are in instances that stand where an earlier one of the same shape does,
    /// and are left out.
    pub copies: usize,
}

/// What triangles have at their corners.
#[derive(Default)]
pub struct Corners {
    /// Normals and texture coordinates.
    pub attributes: Vec<Attributes>,
    /// Colours, of all of them; none where no mesh has any.
    pub colours: Vec<VertexColours>,
    /// Tangents, of all of them; none where no mesh has any.
    pub tangents: Vec<Tangents>,
    /// Second texture coordinates, of all of them; none where no mesh has any.
    pub second: Vec<SecondCoordinates>,
    /// Where the texture of each material lies in whose tangent space its normals and grain are.
    tangent_spaces: Vec<Placement>,
    /// Whether any mesh has second texture coordinates.
    has_second: bool,
    /// Whether any mesh has colours.
    has_colours: bool,
    /// Whether any mesh has tangents.
    has_tangents: bool,
}

impl Corners {
    /// The texture coordinates of a triangle with attributes of this number, if it has any.
    pub fn coordinates(&self, attributes: u32, set: CoordinateSet) -> Option<[[f32; 2]; 3]> {
        let first = self.attributes.get(attributes as usize)?;
        let Attributes { u0, v0, u1, v1, u2, v2, .. } = *first;
        Some(match set {
            CoordinateSet::First => [[u0, v0], [u1, v1], [u2, v2]],
            CoordinateSet::Second => self.second.get(attributes as usize)?.corners,
        })
    }
}

/// Triangles in one space, those with an area.
#[derive(Default)]
pub struct Triangles {
    /// In the order of their numbers.
    pub triangles: Vec<SceneTriangle>,
    /// How many had no area, or were thinner than the roundings of their own corners, and are left
    /// out.
    pub degenerate: usize,
    /// How many have the corners of an earlier one, in the same order, and are left out: no ray
    /// hits them, since it hits the first. Where paths must know what they are in, boundaries of
    /// different bodies are not copies.
    pub copies: usize,
}

/// The triangles of a shape.
pub struct Shape {
    /// With the shape's middle at the origin if it is far from there.
    pub own: Triangles,
    /// What was taken off the corners.
    pub middle: DVec3,
}

/// An instance of a shape that is not repeated.
pub struct Placed {
    /// Index into [`Geometry::shapes`].
    pub shape: usize,
    /// From there to the world.
    pub transform: DAffine3,
    /// The number in the scene of its first triangle.
    pub first_in_scene: u32,
}

/// A shape may be so many times its own extent from the origin of its space. Farther away, an f32
/// would lose digits that it has near it.
const MAX_DISTANCE: f32 = 2.0;

/// Gathers the triangles of a scene that was checked. The material of the `n`-th quad light follows
/// those of the scene, `n` after them.
pub fn gather(scene: &Scene) -> Geometry {
    let mut geometry = Geometry::default();
    let any = |has: fn(&Mesh) -> bool| scene.meshes.iter().chain(&scene.shapes).any(has);
    geometry.corners.has_colours = any(|mesh| mesh.colours.is_some());
    geometry.corners.has_tangents = any(|mesh| mesh.tangents.is_some());
    geometry.corners.has_second = any(|mesh| mesh.second_coordinates.is_some());
    geometry.corners.tangent_spaces =
        scene.materials.iter().map(|material| tangent_space(scene, material)).collect();
    let bodies = bodies_apart(scene);
    let mut number = 0;
    for mesh in &scene.meshes {
        number = geometry.world.add_mesh(mesh, number, &mut geometry.corners);
    }
    number = geometry.add_instances(scene, number, &bodies);
    for (material, light) in (scene.materials.len() as u32..).zip(&scene.quad_lights) {
        for corners in light.triangles() {
            let attributes = NO_ATTRIBUTES;
            geometry.world.add(SceneTriangle { corners, material, attributes, number });
            number += 1;
        }
    }
    geometry.world.leave_out_copies(&bodies);
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

/// Where the texture lies in whose tangent space the normals and the grain of a material are.
fn tangent_space(scene: &Scene, material: &Material) -> Placement {
    let texture = material.principled().and_then(|principled| principled.maps.tangent_space());
    texture.map_or_else(Placement::default, |TextureId(it)| scene.textures[it as usize].placement)
}

impl Geometry {
    /// How many triangles are left out because they have no area.
    pub fn degenerate(&self) -> usize {
        self.all().map(|triangles| triangles.degenerate).sum()
    }

    /// How many triangles are left out because they are where others are.
    pub fn copies(&self) -> usize {
        self.all().map(|triangles| triangles.copies).sum::<usize>() + self.copies
    }

    /// The corners of the box around all, if there are instances; nothing else.
    pub fn corners_of_instances(&self, bounds: Aabb) -> impl Iterator<Item = Vec3> {
        let corners = [bounds.min, bounds.max].map(Vec3::from);
        corners.into_iter().filter(|_| !self.placed.is_empty())
    }

    fn all(&self) -> impl Iterator<Item = &Triangles> {
        self.shapes.iter().map(|shape| &shape.own).chain([&self.world])
    }

    /// Adds the instances of a scene, from this number on; the number after them.
    fn add_instances(&mut self, scene: &Scene, mut number: u32, bodies: &[u32]) -> u32 {
        let mut shapes: Vec<Option<usize>> = vec![None; scene.shapes.len()];
        let mut seen = HashSet::new();
        for instance in &scene.instances {
            let index = instance.shape.0 as usize;
            let shape = &scene.shapes[index];
            let material = &scene.materials[shape.material.0 as usize];
            let first = number;
            number += shape.triangles.len() as u32;
            if !may_have_instances(material) || !instance.is_well_conditioned() {
                let mesh = instance.mesh(shape);
                self.world.add_mesh(&mesh, first, &mut self.corners);
                continue;
            }
            let columns = instance.transform.to_cols_array().map(f64::to_bits);
            if !seen.insert((index, columns)) {
                self.copies += shape.triangles.len();
                continue;
            }
            let corners = &mut self.corners;
            let place = *shapes[index].get_or_insert_with(|| {
                self.shapes.push(Shape::of(shape, corners, bodies));
                self.shapes.len() - 1
            });
            let found = &self.shapes[place];
            if !found.own.triangles.is_empty() {
                let transform = instance.transform * DAffine3::from_translation(found.middle);
                self.placed.push(Placed { shape: place, transform, first_in_scene: first });
            }
        }
        number
    }
}

impl Shape {
    fn of(mesh: &Mesh, of_corners: &mut Corners, bodies: &[u32]) -> Self {
        let mut own = Triangles::default();
        own.add_mesh(mesh, 0, of_corners);
        own.leave_out_copies(bodies);
        let corners = || own.triangles.iter().flat_map(|triangle| triangle.corners);
        let low = corners().fold(Vec3::INFINITY, Vec3::min);
        let high = corners().fold(Vec3::NEG_INFINITY, Vec3::max);
        let (middle, extent) = (0.5 * (low + high), (high - low).max_element());
        // Of nothing these are no numbers.
        let is_far = middle.abs().max_element() > MAX_DISTANCE * extent;
        if !is_far {
            return Self { own, middle: DVec3::ZERO };
        }
        let middle = middle.as_dvec3();
        for corner in own.triangles.iter_mut().flat_map(|triangle| &mut triangle.corners) {
            *corner = (corner.as_dvec3() - middle).as_vec3();
        }
        Self { own, middle }
    }
}

impl Triangles {
    /// Adds those of a mesh, numbered from `first` on; the number after them.
    fn add_mesh(&mut self, mesh: &Mesh, first: u32, of_corners: &mut Corners) -> u32 {
        for (index, number) in (0..mesh.triangles.len()).zip(first..) {
            let normals = mesh.normals.as_ref().map(|normals| normals[index]);
            let coordinates = mesh.texture_coordinates.as_ref().map(|uvs| uvs[index]);
            let corners = mesh.corners(index);
            let mut triangle = SceneTriangle {
                corners,
                material: mesh.material.0,
                attributes: NO_ATTRIBUTES,
                number,
            };
            let second = mesh.second_coordinates.as_ref().map(|uvs| uvs[index]);
            let colours = mesh.colours.as_ref().map(|colours| colours[index]);
            let tangents = mesh.tangents.as_ref().map(|tangents| tangents[index]);
            let has_more = colours.is_some() || tangents.is_some();
            if normals.is_some() || coordinates.is_some() || has_more {
                triangle.attributes = of_corners.attributes.len() as u32;
            }
            if self.add(triangle) && triangle.attributes != NO_ATTRIBUTES {
                let space = of_corners.tangent_spaces[mesh.material.0 as usize];
                let along = match space.set {
                    CoordinateSet::First => coordinates,
                    CoordinateSet::Second => second,
                };
                let along = along.map(|uvs| tangent(corners, uvs.map(|uv| space.of(uv))));
                of_corners.attributes.push(Attributes {
                    tangent: along.unwrap_or(NO_TANGENT),
                    ..attributes(normals.unwrap_or_default(), coordinates.unwrap_or_default())
                });
                if of_corners.has_second {
                    let corners = second.unwrap_or_default().map(|uv| uv.to_array());
                    of_corners.second.push(SecondCoordinates { corners, pad: [0; 2] });
                }
                if of_corners.has_colours {
                    of_corners.colours.push(packed(colours.unwrap_or([Vec4::ONE; 3])));
                }
                if of_corners.has_tangents {
                    of_corners.tangents.push(packed_tangents(tangents.unwrap_or_default()));
                }
            }
        }
        first + mesh.triangles.len() as u32
    }

    /// Adds a triangle if it has an area; whether it has.
    fn add(&mut self, triangle: SceneTriangle) -> bool {
        let SceneTriangle { corners, .. } = triangle;
        let is_there = has_area(corners) && !Functions::of(corners).is_thin();
        if is_there {
            self.triangles.push(triangle);
        } else {
            self.degenerate += 1;
        }
        is_there
    }

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

fn packed(colours: [Vec4; 3]) -> VertexColours {
    let code = |share: f32| (share * 65_535.0).round() as u32;
    let corners = colours.map(|colour| {
        let [red, green, blue, alpha] = colour.to_array().map(code);
        [red | green << 16, blue | alpha << 16]
    });
    VertexColours { corners, pad: [0; 2] }
}

fn packed_tangents(tangents: [Vec4; 3]) -> Tangents {
    let word = |tangent: Vec4| {
        if tangent == Vec4::ZERO {
            return NO_TANGENT;
        }
        Tangent { direction: tangent.truncate(), is_mirrored: tangent.w < 0.0 }.pack()
    };
    Tangents { corners: tangents.map(word), pad: 0 }
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
    use crate::scene::{Camera, FilmSize, QuadLight};

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
        let geometry = gather(&scene);
        assert_eq!((geometry.degenerate(), geometry.copies()), (3, 2));
        let Geometry { world: Triangles { triangles, .. }, corners, .. } = geometry;
        let numbers: Vec<u32> = triangles.iter().map(|triangle| triangle.number).collect();
        assert_eq!(numbers, [0, 2, 6, 8, 9, 10]);
        let names: Vec<_> = triangles.iter().map(|t| (t.material, t.attributes)).collect();
        let flat = NO_ATTRIBUTES;
        assert_eq!(names, [(0, flat), (0, flat), (0, 0), (0, 1), (1, flat), (1, flat)]);
        assert_eq!(
            corners.attributes.iter().map(|a| a.normal2).collect::<Vec<_>>(),
            [Vec3::Z, -Vec3::Z]
        );
    }
}
