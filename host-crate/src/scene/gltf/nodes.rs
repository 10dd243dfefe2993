//! The tree of nodes.

use super::document::Document;
use crate::scene::error::SceneError;
use glam::{DMat4, DQuat, DVec3};
use gltf::json::{Index, Node};

/// Where each node is, and whether it is in the scene that is shown.
pub(super) struct Nodes {
    /// From a node's space to the world's.
    transforms: Vec<DMat4>,
    is_shown: Vec<bool>,
}

impl Nodes {
    /// The nodes of a file.
    pub(super) fn of(document: &Document<'_>) -> Result<Self, SceneError> {
        let nodes = &document.root.nodes;
        let parents = parents(document)?;
        let mut is_shown = vec![false; nodes.len()];
        for root in roots(document, &parents)? {
            is_shown[root] = true;
        }
        let mut transforms = vec![DMat4::IDENTITY; nodes.len()];
        let mut order: Vec<usize> =
            (0..nodes.len()).filter(|&node| parents[node].is_none()).collect();
        let mut next = 0;
        while let Some(&node) = order.get(next) {
            next += 1;
            let above = parents[node].map_or(DMat4::IDENTITY, |parent| transforms[parent]);
            let transform = above * local(&nodes[node]);
            if !transform.is_finite() {
                let what = "places it where no number goes";
                return Err(document.wrong(&format!("nodes[{node}]"), what));
            }
            transforms[node] = transform;
            is_shown[node] |= parents[node].is_some_and(|parent| is_shown[parent]);
            order.extend(children(&nodes[node]));
        }
        if order.len() < nodes.len() {
            let is_in_circle = |node: &usize| !order.contains(node);
            let node = (0..nodes.len()).find(is_in_circle).unwrap_or_default();
            let what = "is below itself: nodes make a tree";
            return Err(document.wrong(&format!("nodes[{node}]"), what));
        }
        Ok(Self { transforms, is_shown })
    }

    /// The nodes of the scene, in the order of the file.
    pub(super) fn shown(&self) -> impl Iterator<Item = usize> {
        (0..self.is_shown.len()).filter(|&node| self.is_shown[node])
    }

    /// From a node's space to the world's.
    pub(super) fn transform(&self, node: usize) -> DMat4 {
        self.transforms[node]
    }
}

fn children(node: &Node) -> impl Iterator<Item = usize> {
    node.children.iter().flatten().map(Index::value)
}

/// The node above each node.
fn parents(document: &Document<'_>) -> Result<Vec<Option<usize>>, SceneError> {
    let nodes = &document.root.nodes;
    let mut parents = vec![None; nodes.len()];
    for (index, node) in nodes.iter().enumerate() {
        for child in children(node) {
            let place = format!("nodes[{index}].children");
            document.get(nodes, child, "nodes", &place)?;
            if let Some(other) = parents[child].replace(index) {
                let what = format!("is below nodes[{other}] and nodes[{index}]");
                return Err(document.wrong(&format!("nodes[{child}]"), what));
            }
        }
    }
    Ok(parents)
}

/// The topmost nodes of the scene that is shown: of the default one, else of the first one, else
/// all that there are.
fn roots(document: &Document<'_>, parents: &[Option<usize>]) -> Result<Vec<usize>, SceneError> {
    let root = &document.root;
    let index = match root.scene {
        Some(scene) => scene.value(),
        None if root.scenes.is_empty() => {
            return Ok((0..parents.len()).filter(|&node| parents[node].is_none()).collect());
        }
        None => 0,
    };
    let scene = document.get(&root.scenes, index, "scenes", "scene")?;
    let place = format!("scenes[{index}].nodes");
    let nodes = scene
        .nodes
        .iter()
        .map(|node| document.get(&root.nodes, node.value(), "nodes", &place).map(|_| node.value()));
    nodes.collect()
}

/// From a node's space to that of the node above.
fn local(node: &Node) -> DMat4 {
    if let Some(columns) = node.matrix {
        return DMat4::from_cols_array(&columns.map(f64::from));
    }
    let vector = |v: [f32; 3]| DVec3::from_array(v.map(f64::from));
    let rotation = node.rotation.unwrap_or_default().0.map(f64::from);
    DMat4::from_scale_rotation_translation(
        node.scale.map_or(DVec3::ONE, vector),
        unit(rotation),
        node.translation.map_or(DVec3::ZERO, vector),
    )
}

/// The rotation of a quaternion (x, y, z, w) of nearly unit length; none of what has no length.
pub(super) fn unit(quaternion: [f64; 4]) -> DQuat {
    let quaternion = DQuat::from_array(quaternion);
    let length = quaternion.length();
    if length > 0.0 && length.is_finite() { quaternion / length } else { DQuat::IDENTITY }
}
