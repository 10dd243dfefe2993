//! The rule that a scene file gives for a material.

use super::values::{AttenuationDistance, Colour, Ior, Radiance, Share};
use crate::scene::material::{Attenuation, Material, Opacity, Principled, Reflectance};
use crate::scene::obj::texture_map::TextureMap;
use crate::scene::rule::{MaterialRule, TexturedRule};
use glam::Vec3;
use serde::de::{MapAccess, SeqAccess, Visitor, value};
use serde::{Deserialize, Deserializer};
use std::path::PathBuf;

/// What a material is, as a scene file says it.
#[derive(Debug, Deserialize)]
#[serde(try_from = "MaterialKeys")]
pub(super) struct FileMaterial(pub MaterialRule);

/// The reflectance of a diffuse material: one colour, or the picture in the given file.
#[derive(Debug)]
enum Albedo {
    Colour(Colour),
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
    transmittance: Option<Colour>,
    #[serde(default, deserialize_with = "present")]
    metallic: Option<Share>,
    #[serde(default, deserialize_with = "present")]
    roughness: Option<Share>,
    #[serde(default, deserialize_with = "present")]
    transmission: Option<Share>,
    #[serde(default, deserialize_with = "present")]
    thin_walled: Option<bool>,
    #[serde(default, deserialize_with = "present")]
    attenuation: Option<Colour>,
    #[serde(default, deserialize_with = "present")]
    attenuation_distance: Option<AttenuationDistance>,
    #[serde(default, deserialize_with = "present")]
    coat: Option<Share>,
    #[serde(default, deserialize_with = "present")]
    coat_roughness: Option<Share>,
    #[serde(default, deserialize_with = "present")]
    sheen: Option<Colour>,
    #[serde(default, deserialize_with = "present")]
    sheen_roughness: Option<Share>,
    #[serde(default, deserialize_with = "present")]
    alpha: Option<Share>,
    #[serde(default, deserialize_with = "present")]
    alpha_cutoff: Option<Share>,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "lowercase")]
enum MaterialKind {
    Diffuse,
    Mirror,
    Dielectric,
    Emissive,
    Principled,
    Null,
}

/// An optional key; unlike serde's own `Option`, null does not stand for its absence.
fn present<'de, D: Deserializer<'de>, T: Deserialize<'de>>(
    deserializer: D,
) -> Result<Option<T>, D::Error> {
    T::deserialize(deserializer).map(Some)
}

impl TryFrom<MaterialKeys> for FileMaterial {
    type Error = String;

    fn try_from(keys: MaterialKeys) -> Result<Self, String> {
        let white = Colour(Vec3::ONE);
        let plain = |material| Ok(Self(MaterialRule::Plain(material)));
        let textured = |material, path| {
            let map = TextureMap::default();
            Ok(Self(MaterialRule::Textured(TexturedRule { material, path, map, otherwise: None })))
        };
        match keys.kind {
            MaterialKind::Diffuse => {
                keys.refuse("a diffuse", &["radiance", "ior", "transmittance"])?;
                match needed("a diffuse", "reflectance", keys.reflectance)? {
                    Albedo::Colour(Colour(colour)) => plain(Material::diffuse(colour)),
                    Albedo::Texture(path) => textured(Material::diffuse(Vec3::ONE), path),
                }
            }
            MaterialKind::Mirror => {
                keys.refuse("a mirror", &["radiance", "ior", "transmittance"])?;
                let reflectance = colour("a mirror", keys.reflectance)?;
                plain(Material::mirror(needed("a mirror", "reflectance", reflectance)?.0))
            }
            MaterialKind::Dielectric => {
                keys.refuse("a dielectric", &["radiance"])?;
                plain(Material::Dielectric {
                    ior: needed("a dielectric", "ior", keys.ior)?.0,
                    transmittance: keys.transmittance.unwrap_or(white).0,
                    reflectance: colour("a dielectric", keys.reflectance)?.unwrap_or(white).0,
                })
            }
            MaterialKind::Emissive => {
                keys.refuse("an emissive", &["ior", "transmittance"])?;
                let black = Colour(Vec3::ZERO);
                plain(Material::Emissive {
                    radiance: needed("an emissive", "radiance", keys.radiance)?.0,
                    reflectance: colour("an emissive", keys.reflectance)?.unwrap_or(black).0,
                })
            }
            MaterialKind::Principled => {
                keys.refuse("a principled", &["transmittance"])?;
                let (material, reflectance) = keys.principled()?;
                match needed("a principled", "reflectance", reflectance)? {
                    Albedo::Colour(Colour(colour)) => {
                        plain(material.with_reflectance(Reflectance::Colour(colour)))
                    }
                    Albedo::Texture(path) => textured(material, path),
                }
            }
            MaterialKind::Null => {
                let all = ["reflectance", "radiance", "ior", "transmittance"];
                keys.refuse("a null", &all)?;
                Ok(Self(MaterialRule::Null))
            }
        }
    }
}

impl MaterialKeys {
    /// A principled material but for its reflectance, and that.
    fn principled(self) -> Result<(Material, Option<Albedo>), String> {
        let share = |key: Option<Share>, default| key.map_or(default, |Share(share)| share);
        let plain = Principled::paint(Vec3::ONE, share(self.roughness, 0.5));
        let opacity = match (self.alpha, self.alpha_cutoff) {
            (None, None) => Opacity::Opaque,
            (Some(Share(alpha)), None) => Opacity::Blend { alpha },
            (alpha, Some(Share(cutoff))) => Opacity::Mask { alpha: share(alpha, 1.0), cutoff },
        };
        let emission = self.radiance.map_or(plain.emission, |Radiance(radiance)| radiance);
        if opacity != Opacity::Opaque && emission != Vec3::ZERO {
            let what = "what has a `radiance` is opaque: leave out `alpha` and `alpha_cutoff`";
            return Err(what.to_owned());
        }
        let attenuation = match (self.attenuation, self.attenuation_distance) {
            (Some(Colour(colour)), Some(AttenuationDistance(distance))) => {
                Some(Attenuation { colour, distance })
            }
            (None, None) => None,
            _ => return Err("`attenuation` and `attenuation_distance` need each other".to_owned()),
        };
        let material = Principled {
            attenuation,
            metallic: share(self.metallic, plain.metallic),
            transmission: share(self.transmission, plain.transmission),
            thin_walled: self.thin_walled.unwrap_or(plain.thin_walled),
            ior: self.ior.map_or(plain.ior, |Ior(ior)| ior),
            coat: share(self.coat, plain.coat),
            coat_roughness: share(self.coat_roughness, plain.coat_roughness),
            sheen: self.sheen.map_or(plain.sheen, |Colour(colour)| colour),
            sheen_roughness: share(self.sheen_roughness, plain.sheen_roughness),
            opacity,
            emission,
            ..plain
        };
        Ok((Material::Principled(material), self.reflectance))
    }

    /// The keys that are given and that principled materials alone have.
    fn of_principled(&self) -> impl Iterator<Item = &'static str> {
        let keys = [
            ("metallic", self.metallic.is_some()),
            ("roughness", self.roughness.is_some()),
            ("transmission", self.transmission.is_some()),
            ("thin_walled", self.thin_walled.is_some()),
            ("attenuation", self.attenuation.is_some()),
            ("attenuation_distance", self.attenuation_distance.is_some()),
            ("coat", self.coat.is_some()),
            ("coat_roughness", self.coat_roughness.is_some()),
            ("sheen", self.sheen.is_some()),
            ("sheen_roughness", self.sheen_roughness.is_some()),
            ("alpha", self.alpha.is_some()),
            ("alpha_cutoff", self.alpha_cutoff.is_some()),
        ];
        keys.into_iter().filter_map(|(key, is_given)| is_given.then_some(key))
    }

    /// Fails if one of these keys is given, or one that only principled materials have.
    fn refuse(&self, kind: &str, keys: &[&str]) -> Result<(), String> {
        let is_given = |key: &str| match key {
            "reflectance" => self.reflectance.is_some(),
            "radiance" => self.radiance.is_some(),
            "ior" => self.ior.is_some(),
            _ => self.transmittance.is_some(),
        };
        let is_principled = matches!(self.kind, MaterialKind::Principled);
        let other = self.of_principled().next().filter(|_| !is_principled);
        match keys.iter().copied().find(|key| is_given(key)).or(other) {
            Some(key) => Err(format!("{kind} material has no key `{key}`")),
            None => Ok(()),
        }
    }
}

/// The value of a key that must be given.
fn needed<T>(kind: &str, key: &str, value: Option<T>) -> Result<T, String> {
    value.ok_or_else(|| format!("{kind} material needs the key `{key}`"))
}

/// The reflectance, if given, of a material that cannot have a texture.
fn colour(kind: &str, reflectance: Option<Albedo>) -> Result<Option<Colour>, String> {
    match reflectance {
        Some(Albedo::Texture(_)) => Err(format!(
            "reflectance: only diffuse and principled materials can have a texture, not {kind} one"
        )),
        Some(Albedo::Colour(colour)) => Ok(Some(colour)),
        None => Ok(None),
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
                Colour::deserialize(value::SeqAccessDeserializer::new(values)).map(Albedo::Colour)
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
