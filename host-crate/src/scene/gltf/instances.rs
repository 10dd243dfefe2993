//! Copies of a mesh (EXT_mesh_gpu_instancing).

use super::document::Document;
use super::extensions::INSTANCING;
use super::nodes::{Nodes, unit};
use crate::scene::error::SceneError;
use glam::{DMat4, DQuat, DVec3};
use serde::Deserialize;

#[derive(Deserialize)]
struct Instancing {
    attributes: Attributes,
}

/// Accessors with an element for each copy.
#[derive(Deserialize)]
#[serde(rename_all = "UPPERCASE")]
struct Attributes {
    translation: Option<usize>,
    rotation: Option<usize>,
    scale: Option<usize>,
}

/// From a node's mesh to the world: once, or for each of its copies.
pub(super) fn instances(
    document: &Document<'_>,
    nodes: &Nodes,
    node: usize,
) -> Result<Vec<DMat4>, SceneError> {
    let above = nodes.transform(node);
    let extensions = document.root.nodes[node].extensions.as_ref();
    let Some(value) = extensions.and_then(|extensions| extensions.others.get(INSTANCING)) else {
        return Ok(vec![above]);
    };
    let place = format!("nodes[{node}].extensions.{INSTANCING}");
    let Instancing { attributes } = Instancing::deserialize(value)
        .map_err(|error| document.wrong(&place, error.to_string()))?;
    let at = |name: &str| format!("{place}.attributes.{name}");
    let vectors = |accessor: Option<usize>, name: &str| {
        accessor.map(|accessor| document.numbers::<3>(accessor, &at(name))).transpose()
    };
    let translations = vectors(attributes.translation, "TRANSLATION")?;
    let scales = vectors(attributes.scale, "SCALE")?;
    let rotations = attributes
        .rotation
        .map(|accessor| document.numbers::<4>(accessor, &at("ROTATION")))
        .transpose()?;
    let counts = [
        translations.as_ref().map(Vec::len),
        scales.as_ref().map(Vec::len),
        rotations.as_ref().map(Vec::len),
    ];
    let Some(count) = counts.into_iter().flatten().max() else {
        return Ok(vec![above]);
    };
    if counts.into_iter().flatten().any(|other| other != count) {
        return Err(document.wrong(&place, "has attributes of different numbers of copies"));
    }
    // A copy of nothing takes memory, too.
    document.charge_vertices(count.saturating_mul(4), &place)?;
    let vector = |list: &Option<Vec<[f32; 3]>>, copy: usize, otherwise: DVec3| {
        list.as_ref().map_or(otherwise, |list| DVec3::from_array(list[copy].map(f64::from)))
    };
    let transforms = (0..count).map(|copy| {
        let rotation =
            rotations.as_ref().map_or(DQuat::IDENTITY, |list| unit(list[copy].map(f64::from)));
        above
            * DMat4::from_scale_rotation_translation(
                vector(&scales, copy, DVec3::ONE),
                rotation,
                vector(&translations, copy, DVec3::ZERO),
            )
    });
    Ok(transforms.collect())
}
