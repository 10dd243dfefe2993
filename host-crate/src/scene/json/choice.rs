//! The material that a scene file of format 2 gives to a mesh or to a part of it.

use super::material::FileMaterial;
use super::values::Object;
use serde::de::{MapAccess, Visitor, value};
use serde::{Deserialize, Deserializer};
use std::fmt;

/// A material that is named, or described on the spot.
#[derive(Debug)]
pub(super) enum MaterialChoice {
    /// One of the file's `materials`.
    Named(String),
    /// It alone.
    Own(Box<FileMaterial>),
}

impl<'de> Deserialize<'de> for MaterialChoice {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct NameOrMaterial;

        impl<'de> Visitor<'de> for NameOrMaterial {
            type Value = MaterialChoice;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("the name of a material, or a material {...}")
            }

            fn visit_str<E>(self, name: &str) -> Result<MaterialChoice, E> {
                Ok(MaterialChoice::Named(name.to_owned()))
            }

            fn visit_map<A: MapAccess<'de>>(self, keys: A) -> Result<MaterialChoice, A::Error> {
                let deserializer = value::MapAccessDeserializer::new(keys);
                let Object(material) = Object::deserialize(deserializer)?;
                Ok(MaterialChoice::Own(Box::new(material)))
            }
        }

        deserializer.deserialize_any(NameOrMaterial)
    }
}
