//! Primitives whose geometry is compressed: the extension `KHR_draco_mesh_compression`. The crate
//! `draco-core` decodes them.
//!
//! What is decoded becomes views and accessors of the document, in the place of the primitive's.

use super::document::{Document, PER_TRIANGLE};
use super::extensions::DRACO;
use crate::scene::error::SceneError;
use draco_core::{DecodeLimits, DecoderBuffer, ErrorKind, Mesh, MeshDecoder};
use gltf::json::accessor::{ComponentType, GenericComponentType, Type};
use gltf::json::buffer::View;
use gltf::json::mesh::Mode;
use gltf::json::validation::{Checked::Valid, USize64};
use gltf::json::{Accessor, Index};
use serde::Deserialize;
use std::collections::BTreeMap;

/// How a primitive is compressed.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Compressed {
    buffer_view: usize,
    /// Of the attributes, by their names, the numbers in the compressed mesh.
    attributes: BTreeMap<String, u32>,
}

impl Document<'_> {
    /// Decodes the primitives that are compressed.
    pub(super) fn decode_primitives(&mut self) -> Result<(), SceneError> {
        for mesh in 0..self.root.meshes.len() {
            for number in 0..self.root.meshes[mesh].primitives.len() {
                let extensions = &self.root.meshes[mesh].primitives[number].extensions;
                let found = extensions.as_ref().and_then(|all| all.others.get(DRACO));
                let Some(value) = found else { continue };
                let place = format!("meshes[{mesh}].primitives[{number}].extensions.{DRACO}");
                let compressed = Compressed::deserialize(value)
                    .map_err(|error| self.wrong(&place, format!("cannot be read: {error}")))?;
                let decoded = self.decode(&compressed, &place)?;
                self.add_decoded([mesh, number], &compressed, &decoded, &place)?;
            }
        }
        Ok(())
    }

    fn decode(&self, compressed: &Compressed, place: &str) -> Result<Mesh, SceneError> {
        let (bytes, _) = self.view(compressed.buffer_view, place)?;
        let limits = DecodeLimits::default()
            .with_max_faces(self.left() / PER_TRIANGLE)
            .with_max_decoded_bytes(self.left());
        let mut mesh = Mesh::new();
        let mut buffer = DecoderBuffer::new(bytes).with_limits(limits);
        match MeshDecoder::new().decode(&mut buffer, &mut mesh) {
            Ok(()) => Ok(mesh),
            Err(error) if error.kind() == ErrorKind::LimitExceeded => Err(self.too_large(place)),
            Err(error) => Err(self.wrong(place, format!("cannot be decoded: {error}"))),
        }
    }

    /// Has a primitive's accessors say what was decoded.
    fn add_decoded(
        &mut self,
        [mesh, number]: [usize; 2],
        compressed: &Compressed,
        decoded: &Mesh,
        place: &str,
    ) -> Result<(), SceneError> {
        let attributes = self.root.meshes[mesh].primitives[number].attributes.clone();
        for (semantic, accessor) in &attributes {
            let Valid(name) = semantic else { continue };
            let Some(&id) = compressed.attributes.get(&name.to_string()) else { continue };
            let place = format!("{place}.attributes.{}", name.to_string());
            let accessor = self.decoded_attribute(decoded, id, accessor.value(), &place)?;
            let attributes = &mut self.root.meshes[mesh].primitives[number].attributes;
            attributes.insert(semantic.clone(), Index::new(accessor as u32));
        }
        self.charge(12 * decoded.num_faces() as u64, place)?;
        let corners = decoded.faces().iter().flatten();
        let bytes = corners.flat_map(|corner| corner.0.to_le_bytes()).collect();
        let indices = self.add_view(bytes, |view| Accessor {
            buffer_view: Some(view),
            byte_offset: None,
            count: USize64(3 * decoded.num_faces() as u64),
            component_type: Valid(GenericComponentType(ComponentType::U32)),
            extensions: None,
            extras: Default::default(),
            type_: Valid(Type::Scalar),
            min: None,
            max: None,
            name: None,
            normalized: false,
            sparse: None,
        });
        let primitive = &mut self.root.meshes[mesh].primitives[number];
        primitive.indices = Some(Index::new(indices as u32));
        primitive.mode = Valid(Mode::Triangles);
        Ok(())
    }

    /// The accessor of what was decoded for another one, whose type it has.
    fn decoded_attribute(
        &mut self,
        decoded: &Mesh,
        id: u32,
        accessor: usize,
        place: &str,
    ) -> Result<usize, SceneError> {
        let components = self.components(accessor, place)?;
        let old = &self.root.accessors[accessor];
        let Valid(GenericComponentType(component)) = old.component_type else {
            let place = format!("accessors[{accessor}].componentType");
            return Err(self.wrong(&place, "is none of glTF's"));
        };
        let Some(attribute) = decoded.attribute_by_unique_id(id) else {
            return Err(self.wrong(place, format!("names attribute {id}, which is not there")));
        };
        let own = usize::from(attribute.num_components());
        if own != components {
            let what = format!("has {own} components, but accessors[{accessor}] {components}");
            return Err(self.wrong(place, what));
        }
        let count = decoded.num_points();
        let size = 2 * 4 * components as u64;
        self.charge(size.saturating_mul(count as u64), place)?;
        let old = old.clone();
        let values = attribute.read_f32s(count, components);
        let bytes = values.into_iter().flat_map(|value| stored(value, component)).collect();
        Ok(self.add_view(bytes, |view| Accessor {
            buffer_view: Some(view),
            byte_offset: None,
            count: USize64(count as u64),
            sparse: None,
            ..old
        }))
    }

    /// Adds a view of these bytes and an accessor of it; the accessor's number.
    fn add_view(
        &mut self,
        bytes: Vec<u8>,
        accessor: impl FnOnce(Index<View>) -> Accessor,
    ) -> usize {
        let view = View {
            // The bytes lie in none.
            buffer: Index::new(0),
            byte_length: USize64(bytes.len() as u64),
            byte_offset: None,
            byte_stride: None,
            name: None,
            target: None,
            extensions: None,
            extras: Default::default(),
        };
        let index = self.add_bytes(view, bytes);
        self.root.accessors.push(accessor(Index::new(index as u32)));
        self.root.accessors.len() - 1
    }
}

/// A number as a component of an accessor.
fn stored(value: f32, component: ComponentType) -> impl Iterator<Item = u8> {
    let (bytes, size) = match component {
        ComponentType::I8 => ((value as i8 as i32).to_le_bytes(), 1),
        ComponentType::U8 => (u32::from(value as u8).to_le_bytes(), 1),
        ComponentType::I16 => ((value as i16 as i32).to_le_bytes(), 2),
        ComponentType::U16 => (u32::from(value as u16).to_le_bytes(), 2),
        ComponentType::U32 => ((value as u32).to_le_bytes(), 4),
        ComponentType::F32 => (value.to_le_bytes(), 4),
    };
    bytes.into_iter().take(size)
}
