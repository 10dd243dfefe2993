//! Shapes that are bent: by morph targets with the weights that the file has, and by skins as
//! their joints stand.

use super::geometry::Geometry;
use super::nodes::Nodes;
use super::primitive::Primitive;
use crate::scene::error::SceneError;
use crate::scene::instance::{moved_tangents, normal_map};
use glam::{DMat3, DMat4, Vec3};
use gltf::json::Index;
use gltf::json::mesh::Semantic;
use std::iter::zip;

impl Primitive<'_, '_> {
    /// Whether the `node` that has it bends it.
    pub(super) fn is_bent(&self, node: usize) -> bool {
        self.skin(node).is_some() || self.weights(node).iter().any(|&weight| weight != 0.0)
    }

    fn skin(&self, node: usize) -> Option<usize> {
        let has_joints = self.attribute(Semantic::Joints(0)).is_some()
            && self.attribute(Semantic::Weights(0)).is_some();
        let skin = self.document.root.nodes[node].skin?;
        has_joints.then(|| skin.value())
    }

    /// The weights of morph targets.
    fn weights(&self, node: usize) -> &[f32] {
        let root = &self.document.root;
        let of_mesh = root.meshes[self.mesh].weights.as_deref();
        let weights = root.nodes[node].weights.as_deref().or(of_mesh).unwrap_or_default();
        let targets = self.json().targets.as_ref().map_or(0, Vec::len);
        &weights[..weights.len().min(targets)]
    }

    /// Adds the displacements of morph targets.
    fn morph(&self, node: usize, shape: &mut Geometry) -> Result<(), SceneError> {
        let count = shape.positions.len();
        let targets = self.json().targets.iter().flatten();
        for (number, (target, &weight)) in zip(targets, self.weights(node)).enumerate() {
            if weight == 0.0 {
                continue;
            }
            let place = format!("{}.targets[{number}]", self.place());
            let add = |accessor: usize, name: &str, to: &mut [Vec3]| {
                let place = format!("{place}.{name}");
                let by = self.document.numbers::<3>(accessor, &place)?;
                self.check_count(&format!("targets[{number}].{name}"), by.len(), count)?;
                zip(to, by).for_each(|(to, by)| *to += Vec3::from_array(by) * weight);
                Ok::<(), SceneError>(())
            };
            if let Some(accessor) = target.positions {
                add(accessor.value(), "POSITION", &mut shape.positions)?;
            }
            if let (Some(accessor), Some(normals)) = (target.normals, &mut shape.normals) {
                add(accessor.value(), "NORMAL", normals)?;
            }
            if let (Some(accessor), Some(tangents)) = (target.tangents, &mut shape.tangents) {
                let mut along: Vec<Vec3> = tangents.iter().map(|t| t.truncate()).collect();
                add(accessor.value(), "TANGENT", &mut along)?;
                zip(tangents, along).for_each(|(t, along)| *t = along.extend(t.w));
            }
        }
        Ok(())
    }

    /// For each vertex, from the space of the mesh to the world (glTF 2.0, section 3.7.3).
    fn joints(&self, nodes: &Nodes, skin: usize, count: usize) -> Result<Vec<DMat4>, SceneError> {
        let document = self.document;
        let found = document.get(&document.root.skins, skin, "skins", "a node's skin")?;
        let place = format!("skins[{skin}]");
        let inverse = match found.inverse_bind_matrices {
            Some(accessor) => {
                let place = format!("{place}.inverseBindMatrices");
                document.numbers::<16>(accessor.value(), &place)?
            }
            None => Vec::new(),
        };
        let mut matrices = Vec::with_capacity(found.joints.len());
        for (number, joint) in found.joints.iter().map(Index::value).enumerate() {
            document.get(&document.root.nodes, joint, "nodes", &format!("{place}.joints"))?;
            let bind = match inverse.get(number) {
                Some(columns) => DMat4::from_cols_array(&columns.map(f64::from)),
                None if found.inverse_bind_matrices.is_none() => DMat4::IDENTITY,
                None => {
                    let what = format!("has {} matrices for more joints", inverse.len());
                    return Err(document.wrong(&format!("{place}.inverseBindMatrices"), what));
                }
            };
            matrices.push(nodes.transform(joint) * bind);
        }
        let mut sums = vec![(DMat4::ZERO, 0.0); count];
        // More than four joints a vertex come in further sets.
        for set in 0.. {
            let accessors =
                [Semantic::Joints(set), Semantic::Weights(set)].map(|name| self.attribute(name));
            let [Some(joints), Some(weights)] = accessors else { break };
            let name = format!("JOINTS_{set}");
            let joints = document.indices::<4>(joints, &self.attribute_place(&name))?;
            self.check_count(&name, joints.len(), count)?;
            let weights = self.vectors::<4>(weights, &format!("WEIGHTS_{set}"), count)?;
            for ((sum, whole), (joints, weights)) in zip(&mut sums, zip(joints, weights)) {
                for (joint, weight) in zip(joints, weights) {
                    if weight == 0.0 || !weight.is_finite() {
                        continue;
                    }
                    let Some(matrix) = matrices.get(joint as usize) else {
                        let what = format!("names joint {joint}, but there are {}", matrices.len());
                        return Err(document.wrong(&self.attribute_place(&name), what));
                    };
                    *sum += *matrix * f64::from(weight);
                    *whole += f64::from(weight);
                }
            }
        }
        // Weights of integers do not quite add up to 1.
        let mean = |(sum, whole): (DMat4, f64)| {
            if whole > 0.0 { sum * (1.0 / whole) } else { DMat4::IDENTITY }
        };
        Ok(sums.into_iter().map(mean).collect())
    }
}

/// The shape of a primitive as the `node` that has it bends it, and whether it is in the world's
/// space then, not in the node's: a skin's is.
pub(super) fn bend(
    primitive: &Primitive<'_, '_>,
    nodes: &Nodes,
    node: usize,
    shape: &Geometry,
) -> Result<(Geometry, bool), SceneError> {
    let mut bent = shape.clone();
    primitive.morph(node, &mut bent)?;
    let Some(skin) = primitive.skin(node) else { return Ok((bent, false)) };
    let matrices = primitive.joints(nodes, skin, bent.positions.len())?;
    for (position, matrix) in zip(&mut bent.positions, &matrices) {
        *position = matrix.transform_point3(position.as_dvec3()).as_vec3();
    }
    for (normal, matrix) in zip(bent.normals.iter_mut().flatten(), &matrices) {
        let map = normal_map(&DMat3::from_mat4(*matrix));
        *normal = (map * normal.as_dvec3()).normalize_or_zero().as_vec3();
    }
    for (tangent, matrix) in zip(bent.tangents.iter_mut().flatten(), &matrices) {
        [*tangent, ..] = moved_tangents([*tangent; 3], &DMat3::from_mat4(*matrix));
    }
    let flipped = matrices.iter().filter(|matrix| matrix.determinant() < 0.0).count();
    if 2 * flipped > matrices.len() {
        bent.triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
    }
    Ok((bent, true))
}
