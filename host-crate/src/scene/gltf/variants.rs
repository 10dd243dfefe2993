//! Variants of a file: which materials its parts have in each (`KHR_materials_variants`).

use super::document::Document;
use super::extensions::VARIANTS;
use super::primitive::Primitive;
use crate::scene::error::SceneError;
use gltf::json::Value;
use serde::Deserialize;
use serde::de::DeserializeOwned;

/// The variants of a file.
#[derive(Default)]
pub(super) struct Variants {
    /// Their names, in the order of the file.
    pub names: Vec<String>,
    /// The number of the one that is shown.
    shown: Option<usize>,
}

#[derive(Deserialize)]
struct OfRoot {
    variants: Vec<Named>,
}

#[derive(Deserialize)]
struct Named {
    name: String,
}

#[derive(Deserialize)]
struct OfPrimitive {
    mappings: Vec<Mapping>,
}

#[derive(Deserialize)]
struct Mapping {
    material: usize,
    variants: Vec<usize>,
}

impl Variants {
    /// Those of a file; `wanted` is the name of the one to show.
    pub(super) fn of(document: &Document<'_>, wanted: Option<&str>) -> Result<Self, SceneError> {
        let extensions = document.root.extensions.as_ref();
        let json = extensions.and_then(|all| all.others.get(VARIANTS));
        let of_root: Option<OfRoot> = read(document, json, &format!("extensions.{VARIANTS}"))?;
        let named = of_root.map_or_else(Vec::new, |of_root| of_root.variants);
        let names: Vec<String> = named.into_iter().map(|named| named.name).collect();
        let Some(wanted) = wanted else { return Ok(Self { names, shown: None }) };
        let shown = names.iter().position(|name| name == wanted);
        if shown.is_none() {
            let (path, name) = (document.path.to_owned(), wanted.to_owned());
            return Err(SceneError::UnknownVariant { path, name, known: names });
        }
        Ok(Self { names, shown })
    }

    /// The number of the material of a part: that of the variant, if it has one.
    pub(super) fn material(
        &self,
        primitive: &Primitive<'_, '_>,
    ) -> Result<Option<usize>, SceneError> {
        let json = primitive.json();
        let plain = json.material.map(|material| material.value());
        let extensions = json.extensions.as_ref();
        let Some(found) = extensions.and_then(|all| all.others.get(VARIANTS)) else {
            return Ok(plain);
        };
        let document = primitive.document;
        let place = format!("{}.extensions.{VARIANTS}", primitive.place());
        let of_primitive: Option<OfPrimitive> = read(document, Some(found), &place)?;
        let mappings = of_primitive.map_or_else(Vec::new, |of_primitive| of_primitive.mappings);
        let mut chosen = None;
        for (index, Mapping { material, variants }) in mappings.into_iter().enumerate() {
            let place = format!("{place}.mappings[{index}]");
            document.get(&document.root.materials, material, "materials", &place)?;
            for variant in variants {
                document.get(&self.names, variant, "variants", &place)?;
                if Some(variant) == self.shown {
                    chosen = chosen.or(Some(material));
                }
            }
        }
        Ok(chosen.or(plain))
    }
}

fn read<T: DeserializeOwned>(
    document: &Document<'_>,
    json: Option<&Value>,
    place: &str,
) -> Result<Option<T>, SceneError> {
    json.map(T::deserialize).transpose().map_err(|error| document.wrong(place, error.to_string()))
}
