//! Whether meshes, shapes and their instances fit together.

use super::super::bounds::{self, MAX_COORDINATE};
use super::super::description::Scene;
use super::super::instance::Instance;
use super::super::material::Material;
use super::super::mesh::Mesh;
use super::super::texture::{CoordinateSet, TextureId};
use super::{InvalidScene, at, in_range, values};
use glam::{DVec3, Vec2, Vec3, Vec4};

/// How far the length of a unit normal may be from 1: one that was rounded a few times is nearer.
const UNIT_TOLERANCE: f32 = 1e-3;

impl Scene {
    pub(super) fn check_mesh(&self, mesh: &Mesh) -> Result<(), InvalidScene> {
        in_range("material", mesh.material.0, self.materials.len(), "materials")
            .map_err(at("material"))?;
        for (index, position) in mesh.positions.iter().enumerate() {
            if let Err(what) = bounds::coordinates(&values(*position)) {
                return Err(at(&format!("positions[{index}]"))(what));
            }
        }
        for (index, corners) in mesh.triangles.iter().enumerate() {
            for &corner in corners {
                if let Err(what) = in_range("position", corner, mesh.positions.len(), "positions") {
                    return Err(at(&format!("triangles[{index}]"))(what));
                }
            }
        }
        check_normals(mesh)?;
        let coordinates = [
            ("texture_coordinates", &mesh.texture_coordinates, CoordinateSet::First),
            ("second_coordinates", &mesh.second_coordinates, CoordinateSet::Second),
        ];
        let material = &self.materials[mesh.material.0 as usize];
        for (name, coordinates, set) in coordinates {
            check_texture_coordinates(name, coordinates.as_deref(), mesh)?;
            let takes_them = |texture: TextureId| {
                self.textures.get(texture.0 as usize).is_some_and(|t| t.placement.set == set)
            };
            if coordinates.is_none() && material.textures().any(takes_them) {
                let what = "are needed, since the material has a texture".to_owned();
                return Err(at(name)(what));
            }
        }
        if mesh.second_coordinates.is_some() && mesh.texture_coordinates.is_none() {
            let what = "are there, but no first ones".to_owned();
            return Err(at("second_coordinates")(what));
        }
        check_tangents(mesh)?;
        check_colours(mesh, material)
    }

    pub(super) fn check_instances(&self) -> Result<(), InvalidScene> {
        for (index, shape) in self.shapes.iter().enumerate() {
            self.check_mesh(shape).map_err(|InvalidScene { place, what }| InvalidScene {
                place: format!("shapes[{index}].{place}"),
                what,
            })?;
        }
        let boxes: Vec<[DVec3; 2]> = self.shapes.iter().map(Mesh::bounds).collect();
        for (index, Instance { shape, transform }) in self.instances.iter().enumerate() {
            let place = format!("instances[{index}]");
            in_range("shape", shape.0, self.shapes.len(), "shapes").map_err(at(&place))?;
            let [low, high] = boxes[shape.0 as usize];
            // How far the farthest corner of the box goes, or farther.
            let reach = low.abs().max(high.abs());
            let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z]
                .map(|axis| transform.transform_vector3(axis * reach).abs());
            let farthest = (x + y + z + transform.translation.abs()).max_element();
            // Not a number is in no range.
            let is_near = farthest <= MAX_COORDINATE && transform.is_finite();
            if !is_near {
                let what = format!(
                    "places its shape farther than {MAX_COORDINATE:e} from the origin, or nowhere"
                );
                return Err(at(&format!("{place}.transform"))(what));
            }
        }
        let triangles = self.triangle_count();
        if triangles > u32::MAX as usize {
            let what = format!(
                "make {triangles} triangles, repeated ones counted, but a scene has at most {}",
                u32::MAX
            );
            return Err(at("instances")(what));
        }
        Ok(())
    }
}

/// Fails if a list with an element for each triangle has another number of them.
fn check_count(place: &str, count: usize, mesh: &Mesh) -> Result<(), InvalidScene> {
    let triangles = mesh.triangles.len();
    if count == triangles {
        Ok(())
    } else {
        Err(at(place)(format!("are of {count} triangles, but the mesh has {triangles}")))
    }
}

fn check_normals(mesh: &Mesh) -> Result<(), InvalidScene> {
    let Some(normals) = &mesh.normals else { return Ok(()) };
    check_count("normals", normals.len(), mesh)?;
    let is_fine =
        |normal: &Vec3| *normal == Vec3::ZERO || (normal.length() - 1.0).abs() <= UNIT_TOLERANCE;
    match normals.iter().position(|corners| !corners.iter().all(is_fine)) {
        Some(index) => {
            let what = "must have unit length, or be zero".to_owned();
            Err(at(&format!("normals[{index}]"))(what))
        }
        None => Ok(()),
    }
}

fn check_tangents(mesh: &Mesh) -> Result<(), InvalidScene> {
    let Some(tangents) = &mesh.tangents else { return Ok(()) };
    check_count("tangents", tangents.len(), mesh)?;
    let is_fine = |tangent: &Vec4| {
        let is_unit = (tangent.truncate().length() - 1.0).abs() <= UNIT_TOLERANCE;
        is_unit && tangent.w.abs() == 1.0
    };
    let are_fine = |corners: &[Vec4; 3]| *corners == [Vec4::ZERO; 3] || corners.iter().all(is_fine);
    match tangents.iter().position(|corners| !are_fine(corners)) {
        Some(index) => {
            let what = "must have unit length and 1 or -1 besides, or be zero at all three corners";
            Err(at(&format!("tangents[{index}]"))(what.to_owned()))
        }
        None => Ok(()),
    }
}

fn check_colours(mesh: &Mesh, material: &Material) -> Result<(), InvalidScene> {
    let Some(colours) = &mesh.colours else { return Ok(()) };
    check_count("colours", colours.len(), mesh)?;
    if !material.takes_colours() {
        let what = "are there, but the material has no colour that they could multiply".to_owned();
        return Err(at("colours")(what));
    }
    let is_share = |colour: &Vec4| colour.cmpge(Vec4::ZERO).all() && colour.cmple(Vec4::ONE).all();
    if let Some(index) = colours.iter().position(|corners| !corners.iter().all(is_share)) {
        let what = format!("must be from 0 to 1, are {:?}", colours[index]);
        return Err(at(&format!("colours[{index}]"))(what));
    }
    let is_opaque = colours.as_flattened().iter().all(|colour| colour.w == 1.0);
    if material.has_holes() && material.body().is_some() && !is_opaque {
        let what = "have alpha, but the material bounds a body, which has no holes".to_owned();
        return Err(at("colours")(what));
    }
    Ok(())
}

fn check_texture_coordinates(
    name: &str,
    coordinates: Option<&[[Vec2; 3]]>,
    mesh: &Mesh,
) -> Result<(), InvalidScene> {
    let Some(coordinates) = coordinates else { return Ok(()) };
    check_count(name, coordinates.len(), mesh)?;
    // Not a number is in no range.
    let is_fine = |c: &f32| f64::from(c.abs()) <= MAX_COORDINATE;
    let position = coordinates
        .iter()
        .position(|corners| !corners.iter().all(|uv| uv.to_array().iter().all(is_fine)));
    match position {
        Some(index) => Err(at(&format!("{name}[{index}]"))(format!(
            "must be from -{MAX_COORDINATE} to {MAX_COORDINATE}"
        ))),
        None => Ok(()),
    }
}
