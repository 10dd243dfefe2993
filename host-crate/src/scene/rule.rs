//! What a material is: the rule that the scene file gives for it, or its MTL.

use super::values::{Ior, Radiance, Reflectance};
use serde::de::{MapAccess, SeqAccess, Visitor, value};
use serde::{Deserialize, Deserializer};
use std::path::PathBuf;

/// What a material is, as the scene file or the MTL says it.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(try_from = "MaterialKeys")]
pub(super) enum MaterialRule {
    Diffuse(Albedo),
    Mirror(Reflectance),
    Dielectric { ior: Ior, transmittance: Reflectance, reflectance: Reflectance },
    Emissive { radiance: Radiance, reflectance: Reflectance },
    Null,
}

/// The reflectance of a diffuse material: one colour, or the picture in the given file.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Albedo {
    Colour(Reflectance),
    Texture(PathBuf),
}

/// All keys of all materials. One flat struct, so that messages name the key and its line.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MaterialKeys {
    #[serde(rename = "type")]
    kind: MaterialKind,
    #[serde(default, deserialize_with = "present")]
    reflectance: Option<Albedo>,
    #[serde(default, deserialize_with = "present")]
    radiance: Option<Radiance>,
    #[serde(default, deserialize_with = "present")]
    ior: Option<Ior>,
    #[serde(default, deserialize_with = "present")]
    transmittance: Option<Reflectance>,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "lowercase")]
enum MaterialKind {
    Diffuse,
    Mirror,
    Dielectric,
    Emissive,
    Null,
}

/// An optional key; unlike serde's own `Option`, null does not stand for its absence.
fn present<'de, D: Deserializer<'de>, T: Deserialize<'de>>(
    deserializer: D,
) -> Result<Option<T>, D::Error> {
    T::deserialize(deserializer).map(Some)
}

impl TryFrom<MaterialKeys> for MaterialRule {
    type Error = String;

    fn try_from(keys: MaterialKeys) -> Result<Self, String> {
        let MaterialKeys { kind, reflectance, radiance, ior, transmittance } = keys;
        let refuse =
            |kind: &str, extra: &[(&str, bool)]| match extra.iter().find(|(_, given)| *given) {
                Some((key, _)) => Err(format!("{kind} material has no key `{key}`")),
                None => Ok(()),
            };
        let missing = |kind: &str, key: &str| format!("{kind} material needs the key `{key}`");
        let colour = |kind: &str, reflectance: Option<Albedo>| match reflectance {
            Some(Albedo::Texture(_)) => Err(format!(
                "reflectance: only a diffuse material can have a texture, not {kind} one"
            )),
            Some(Albedo::Colour(colour)) => Ok(Some(colour)),
            None => Ok(None),
        };
        let has_radiance = ("radiance", radiance.is_some());
        let has_ior = ("ior", ior.is_some());
        let has_transmittance = ("transmittance", transmittance.is_some());
        let has_reflectance = ("reflectance", reflectance.is_some());
        let white = Reflectance(glam::Vec3::ONE);
        match kind {
            MaterialKind::Diffuse => {
                refuse("a diffuse", &[has_radiance, has_ior, has_transmittance])?;
                reflectance.map(Self::Diffuse).ok_or_else(|| missing("a diffuse", "reflectance"))
            }
            MaterialKind::Mirror => {
                refuse("a mirror", &[has_radiance, has_ior, has_transmittance])?;
                colour("a mirror", reflectance)?
                    .map(Self::Mirror)
                    .ok_or_else(|| missing("a mirror", "reflectance"))
            }
            MaterialKind::Dielectric => {
                refuse("a dielectric", &[has_radiance])?;
                Ok(Self::Dielectric {
                    ior: ior.ok_or_else(|| missing("a dielectric", "ior"))?,
                    transmittance: transmittance.unwrap_or(white),
                    reflectance: colour("a dielectric", reflectance)?.unwrap_or(white),
                })
            }
            MaterialKind::Emissive => {
                refuse("an emissive", &[has_ior, has_transmittance])?;
                Ok(Self::Emissive {
                    radiance: radiance.ok_or_else(|| missing("an emissive", "radiance"))?,
                    reflectance: colour("an emissive", reflectance)?
                        .unwrap_or(Reflectance(glam::Vec3::ZERO)),
                })
            }
            MaterialKind::Null => {
                refuse("a null", &[has_reflectance, has_radiance, has_ior, has_transmittance])?;
                Ok(Self::Null)
            }
        }
    }
}

impl<'de> Deserialize<'de> for Albedo {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct ColourOrTexture;

        impl<'de> Visitor<'de> for ColourOrTexture {
            type Value = Albedo;

            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("[red, green, blue] or {\"texture\": file}")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, values: A) -> Result<Albedo, A::Error> {
                Reflectance::deserialize(value::SeqAccessDeserializer::new(values))
                    .map(Albedo::Colour)
            }

            fn visit_map<A: MapAccess<'de>>(self, keys: A) -> Result<Albedo, A::Error> {
                #[derive(Deserialize)]
                #[serde(deny_unknown_fields)]
                struct TextureKeys {
                    texture: String,
                }
                let keys = TextureKeys::deserialize(value::MapAccessDeserializer::new(keys))?;
                Ok(Albedo::Texture(PathBuf::from(keys.texture)))
            }
        }

        deserializer.deserialize_any(ColourOrTexture)
    }
}
