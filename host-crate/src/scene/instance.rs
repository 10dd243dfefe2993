//! Shapes that stand in the scene at several places, and once in memory.

use super::material::Material;
use super::mesh::Mesh;
use glam::{DAffine3, DMat3, DVec3, Vec3, Vec4};

/// Which of a [`Scene`](super::Scene)'s shapes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ShapeId(pub u32);

/// A shape at a place in the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instance {
    /// The shape; [`Scene::shapes`](super::Scene::shapes) has it.
    pub shape: ShapeId,
    /// From the space of the shape to the world. A mirrored shape keeps its fronts outside.
    pub transform: DAffine3,
}

/// By how much a transform may change proportions, as the product of the maximum norms of its
/// linear part and of the inverse of that. A rotation has up to 3. Rays are so many times as wide
/// outside of instances.
const MAX_CONDITION: f64 = 256.0;

impl Instance {
    /// Its triangles in the world.
    pub fn mesh(&self, shape: &Mesh) -> Mesh {
        shape.moved(&self.transform)
    }

    /// Whether rays can be brought to the space of its shape without losing too many digits. What
    /// flattens its shape, or makes it much longer than wide, is repeated in memory instead.
    pub(crate) fn is_well_conditioned(&self) -> bool {
        is_well_conditioned(&self.transform)
    }
}

/// See [`Instance::is_well_conditioned`].
pub(crate) fn is_well_conditioned(transform: &DAffine3) -> bool {
    let inverse = transform.matrix3.inverse();
    // Not a number is not below.
    inverse.is_finite() && norm(&transform.matrix3) * norm(&inverse) <= MAX_CONDITION
}

/// Whether a shape of a material may stand in the scene several times without being repeated in
/// memory: light is sampled on the triangles of lamps one by one.
pub(crate) fn may_have_instances(material: &Material) -> bool {
    material.radiance() == Vec3::ZERO
}

/// The maximum norm of a matrix: the largest sum of magnitudes in a row.
pub(crate) fn norm(matrix: &DMat3) -> f64 {
    let [x, y, z] = [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(DVec3::abs);
    (x + y + z).max_element()
}

impl Mesh {
    /// The mesh in another place. A mirrored one keeps its fronts outside.
    pub fn moved(&self, transform: &DAffine3) -> Self {
        let linear = transform.matrix3;
        let flips = linear.determinant() < 0.0;
        let map = normal_map(&linear);
        let turned = |normal: Vec3| (map * normal.as_dvec3()).normalize_or_zero().as_vec3();
        let place = |p: &Vec3| transform.transform_point3(p.as_dvec3()).as_vec3();
        let mut moved = Self {
            material: self.material,
            positions: self.positions.iter().map(place).collect(),
            triangles: self.triangles.clone(),
            normals: self
                .normals
                .as_ref()
                .map(|normals| normals.iter().map(|corners| corners.map(turned)).collect()),
            texture_coordinates: self.texture_coordinates.clone(),
            second_coordinates: self.second_coordinates.clone(),
            colours: self.colours.clone(),
            tangents: self.tangents.as_ref().map(|tangents| {
                let turned = |corners: &[Vec4; 3]| moved_tangents(*corners, &linear);
                tangents.iter().map(turned).collect()
            }),
        };
        if flips {
            moved.triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
            moved.normals.iter_mut().flatten().for_each(|corners| corners.swap(1, 2));
            let both = [&mut moved.texture_coordinates, &mut moved.second_coordinates];
            let coordinates = both.into_iter().flatten().flatten();
            coordinates.for_each(|corners| corners.swap(1, 2));
            moved.colours.iter_mut().flatten().for_each(|corners| corners.swap(1, 2));
            moved.tangents.iter_mut().flatten().for_each(|corners| corners.swap(1, 2));
        }
        moved
    }
}

/// Tangents of a surface that a linear map has changed: zero at all corners if one vanishes.
pub(super) fn moved_tangents(corners: [Vec4; 3], linear: &DMat3) -> [Vec4; 3] {
    let side = if linear.determinant() < 0.0 { -1.0 } else { 1.0 };
    let moved = corners.map(|tangent| {
        let along = (*linear * tangent.truncate().as_dvec3()).normalize_or_zero();
        along.as_vec3().extend(tangent.w * side)
    });
    let is_there = |tangent: &Vec4| tangent.truncate() != Vec3::ZERO;
    if moved.iter().all(is_there) { moved } else { [Vec4::ZERO; 3] }
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
    use crate::scene::MaterialId;

    #[test]
    fn a_mirrored_mesh_keeps_its_front_outside() {
        // A triangle of the plane z = 0 whose front is +z.
        let mut mesh =
            Mesh::new(MaterialId(0), vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]);
        mesh.normals = Some(vec![[Vec3::Z; 3]]);
        mesh.tangents = Some(vec![[Vec4::new(1.0, 0.0, 0.0, 1.0); 3]]);
        for scale in [
            DVec3::new(-1.0, 1.0, 1.0),
            DVec3::new(1.0, 1.0, -3.0),
            DVec3::new(-2.0, -1e-9, 1.0),
            DVec3::new(-1.0, -1.0, -1.0),
        ] {
            let transform = DAffine3::from_scale(scale);
            let moved = mesh.moved(&transform);
            let [a, b, c] = moved.corners(0).map(Vec3::as_dvec3);
            let front = (b - a).cross(c - a).normalize();
            // What lies outside stays outside.
            let outside = transform.transform_vector3(DVec3::Z).normalize();
            assert!(front.dot(outside) > 0.9, "{scale}");
            let normal = moved.normals.unwrap()[0][0].as_dvec3();
            assert!(front.dot(normal) > 0.999, "{scale}: {normal}");
            // What runs along x and y on the surface runs along them still.
            let tangent = moved.tangents.unwrap()[0][0].as_dvec4();
            let across = normal.cross(tangent.truncate()) * tangent.w;
            let [x, y] = [DVec3::X, DVec3::Y].map(|a| transform.transform_vector3(a).normalize());
            assert!(tangent.truncate().dot(x) > 0.999 && across.dot(y) > 0.999, "{scale}");
        }
    }

    #[test]
    fn what_is_flattened_is_no_instance() {
        let is_fine = |scale: DVec3| is_well_conditioned(&DAffine3::from_scale(scale));
        assert!(is_fine(DVec3::ONE) && is_fine(DVec3::new(-1e-3, 1e-3, 1e-2)));
        assert!(!is_fine(DVec3::new(1.0, 1.0, 0.0)) && !is_fine(DVec3::new(1.0, 1.0, 1e-3)));
        assert!(!is_fine(DVec3::ZERO) && !is_fine(DVec3::splat(f64::NAN)));
    }
}
