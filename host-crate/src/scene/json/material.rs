//! The rule that a scene file gives for a material.

use super::values::{
    AttenuationDistance, Colour, Eta, Extinction, Factor, Ior, Object, Priority, Radiance, Share,
    Slope, present,
};
use crate::scene::material::{Attenuation, Material, Opacity, Principled, Reflectance};
use crate::scene::metal::{Conductor, Metal};
use crate::scene::obj::texture_map::TextureMap;
use crate::scene::rule::{MaterialRule, Slot, TexturedRule};
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
    metal: Option<String>,
    #[serde(default, deserialize_with = "present")]
    eta: Option<Eta>,
    #[serde(default, deserialize_with = "present")]
    k: Option<Extinction>,
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
    priority: Option<Priority>,
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
    #[serde(default, deserialize_with = "present")]
    specular: Option<Factor>,
    #[serde(default, deserialize_with = "present")]
    textures: Option<Object<TextureKeys>>,
}

/// The textures of a principled material beside that of its reflectance.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TextureKeys {
    #[serde(default, deserialize_with = "present")]
    roughness: Option<Object<ChannelKeys>>,
    #[serde(default, deserialize_with = "present")]
    metallic: Option<Object<ChannelKeys>>,
    #[serde(default, deserialize_with = "present")]
    normal: Option<Object<NormalKeys>>,
    #[serde(default, deserialize_with = "present")]
    emission: Option<Object<FileKeys>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ChannelKeys {
    file: PathBuf,
    channel: TextureChannel,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "lowercase")]
enum TextureChannel {
    Red,
    Green,
    Blue,
    Alpha,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct NormalKeys {
    file: PathBuf,
    #[serde(default, deserialize_with = "present")]
    scale: Option<Slope>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FileKeys {
    file: PathBuf,
}

/// The key within a material that names the file of a texture.
pub(super) fn key_of(slot: Slot) -> &'static str {
    match slot {
        Slot::Colour => "reflectance.texture",
        Slot::Roughness(_) => "textures.roughness.file",
        Slot::Metallic(_) => "textures.metallic.file",
        Slot::Normal(_) => "textures.normal.file",
        Slot::Emission => "textures.emission.file",
    }
}

impl TextureKeys {
    fn slots(self) -> impl Iterator<Item = (Slot, PathBuf)> {
        let channel = |slot: fn(u32) -> Slot| {
            move |Object(ChannelKeys { file, channel })| (slot(channel as u32), file)
        };
        let normal = self.normal.map(|Object(NormalKeys { file, scale })| {
            (Slot::Normal(scale.map_or(1.0, |Slope(scale)| scale)), file)
        });
        let emission = self.emission.map(|Object(FileKeys { file })| (Slot::Emission, file));
        [
            self.roughness.map(channel(Slot::Roughness)),
            self.metallic.map(channel(Slot::Metallic)),
            normal,
            emission,
        ]
        .into_iter()
        .flatten()
    }
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "lowercase")]
enum MaterialKind {
    Diffuse,
    Mirror,
    Dielectric,
    Emissive,
    Principled,
    Conductor,
    Null,
}

impl TryFrom<MaterialKeys> for FileMaterial {
    type Error = String;

    fn try_from(keys: MaterialKeys) -> Result<Self, String> {
        let white = Colour(Vec3::ONE);
        let plain = |material| Ok(Self(MaterialRule::Plain(material)));
        let textured = |material, slots: Vec<(Slot, PathBuf)>| {
            let textures = slots.into_iter().map(|(slot, file)| (slot, 0, file)).collect();
            let map = TextureMap::default();
            let rule = TexturedRule { material, textures, map, otherwise: None };
            Ok(Self(MaterialRule::Textured(rule)))
        };
        match keys.kind {
            MaterialKind::Diffuse => {
                keys.refuse("a diffuse", &["radiance", "ior", "transmittance"])?;
                match needed("a diffuse", "reflectance", keys.reflectance)? {
                    Albedo::Colour(Colour(colour)) => plain(Material::diffuse(colour)),
                    Albedo::Texture(path) => {
                        textured(Material::diffuse(Vec3::ONE), vec![(Slot::Colour, path)])
                    }
                }
            }
            MaterialKind::Mirror => {
                keys.refuse("a mirror", &["radiance", "ior", "transmittance"])?;
                let reflectance = colour("a mirror", keys.reflectance)?;
                plain(Material::mirror(needed("a mirror", "reflectance", reflectance)?.0))
            }
            MaterialKind::Dielectric => {
                keys.refuse("a dielectric", &["radiance"])?;
                let (attenuation, priority) = (keys.attenuation()?, keys.priority());
                plain(Material::Dielectric {
                    ior: needed("a dielectric", "ior", keys.ior)?.0,
                    transmittance: keys.transmittance.unwrap_or(white).0,
                    reflectance: colour("a dielectric", keys.reflectance)?.unwrap_or(white).0,
                    attenuation,
                    priority,
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
                let (material, reflectance, mut slots) = keys.principled()?;
                let material = match needed("a principled", "reflectance", reflectance)? {
                    Albedo::Colour(Colour(colour)) => {
                        material.with_reflectance(Reflectance::Colour(colour))
                    }
                    Albedo::Texture(path) => {
                        slots.insert(0, (Slot::Colour, path));
                        material
                    }
                };
                if slots.is_empty() { plain(material) } else { textured(material, slots) }
            }
            MaterialKind::Conductor => {
                let all = ["reflectance", "radiance", "ior", "transmittance"];
                keys.refuse("a conductor", &all)?;
                let Share(roughness) = keys.roughness.unwrap_or(Share(0.0));
                let metal = Principled::conductor(keys.conductor()?, roughness);
                plain(Material::Principled(metal))
            }
            MaterialKind::Null => {
                let all = ["reflectance", "radiance", "ior", "transmittance"];
                keys.refuse("a null", &all)?;
                Ok(Self(MaterialRule::Null))
            }
        }
    }
}

/// A principled material but for its reflectance, that, and its other textures.
type Made = (Material, Option<Albedo>, Vec<(Slot, PathBuf)>);

/// Of keys with whether they are given, those that are.
fn given<const N: usize>(keys: [(&'static str, bool); N]) -> impl Iterator<Item = &'static str> {
    keys.into_iter().filter_map(|(key, is_given)| is_given.then_some(key))
}

impl MaterialKeys {
    /// A principled material but for its reflectance, that, and its other textures. A texture
    /// multiplies a number, which is then 1 unless the file says otherwise.
    fn principled(self) -> Result<Made, String> {
        let (attenuation, priority) = (self.attenuation()?, self.priority());
        let slots: Vec<_> =
            self.textures.map(|Object(textures)| textures.slots().collect()).unwrap_or_default();
        let has = |wanted: fn(&Slot) -> bool| slots.iter().any(|(slot, _)| wanted(slot));
        let roughness = if has(|slot| matches!(slot, Slot::Roughness(_))) { 1.0 } else { 0.5 };
        let metallic = if has(|slot| matches!(slot, Slot::Metallic(_))) { 1.0 } else { 0.0 };
        let emission = if has(|slot| *slot == Slot::Emission) { Vec3::ONE } else { Vec3::ZERO };
        let share = |key: Option<Share>, default| key.map_or(default, |Share(share)| share);
        let plain = Principled::paint(Vec3::ONE, share(self.roughness, roughness));
        let emission = self.radiance.map_or(emission, |Radiance(radiance)| radiance);
        let opacity = match (self.alpha, self.alpha_cutoff) {
            (None, None) => Opacity::Opaque,
            (Some(Share(alpha)), None) => Opacity::Blend { alpha },
            (alpha, Some(Share(cutoff))) => Opacity::Mask { alpha: share(alpha, 1.0), cutoff },
        };
        if opacity != Opacity::Opaque && emission != Vec3::ZERO {
            let what = "what has a `radiance` is opaque: leave out `alpha` and `alpha_cutoff`";
            return Err(what.to_owned());
        }
        let material = Principled {
            attenuation,
            priority,
            metallic: share(self.metallic, metallic),
            transmission: share(self.transmission, plain.transmission),
            thin_walled: self.thin_walled.unwrap_or(plain.thin_walled),
            ior: self.ior.map_or(plain.ior, |Ior(ior)| ior),
            coat: share(self.coat, plain.coat),
            coat_roughness: share(self.coat_roughness, plain.coat_roughness),
            sheen: self.sheen.map_or(plain.sheen, |Colour(colour)| colour),
            sheen_roughness: share(self.sheen_roughness, plain.sheen_roughness),
            specular: self.specular.map_or(plain.specular, |Factor(factor)| factor),
            opacity,
            emission,
            ..plain
        };
        let material = Material::Principled(material);
        if priority.is_some() && material.body().is_none() {
            let what = "`priority` is that of a body: it needs a `transmission`, and no \
                        `thin_walled`, `alpha` or `alpha_cutoff`";
            return Err(what.to_owned());
        }
        Ok((material, self.reflectance, slots))
    }

    fn attenuation(&self) -> Result<Option<Attenuation>, String> {
        match (self.attenuation, self.attenuation_distance) {
            (Some(Colour(colour)), Some(AttenuationDistance(distance))) => {
                Ok(Some(Attenuation { colour, distance }))
            }
            (None, None) => Ok(None),
            _ => Err("`attenuation` and `attenuation_distance` need each other".to_owned()),
        }
    }

    /// The index of refraction of a conductor, by name or in numbers.
    fn conductor(&self) -> Result<Conductor, String> {
        match (&self.metal, self.eta, self.k) {
            (Some(name), None, None) => {
                let metal = name.parse::<Metal>().map_err(|what| format!("metal: {what}"))?;
                Ok(metal.conductor())
            }
            (None, Some(Eta(eta)), Some(Extinction(k))) => Ok(Conductor { eta, k }),
            _ => Err("a conductor material needs the key `metal`, or `eta` and `k`".to_owned()),
        }
    }

    /// The keys that are given and that conductors alone have.
    fn of_conductors(&self) -> impl Iterator<Item = &'static str> {
        given([
            ("metal", self.metal.is_some()),
            ("eta", self.eta.is_some()),
            ("k", self.k.is_some()),
        ])
    }

    fn priority(&self) -> Option<i32> {
        self.priority.map(|Priority(priority)| priority)
    }

    /// The keys that are given and that principled materials alone have, but for those of bodies,
    /// which dielectrics have as well.
    fn of_principled(&self) -> impl Iterator<Item = &'static str> {
        given([
            ("metallic", self.metallic.is_some()),
            ("roughness", self.roughness.is_some()),
            ("transmission", self.transmission.is_some()),
            ("thin_walled", self.thin_walled.is_some()),
            ("coat", self.coat.is_some()),
            ("coat_roughness", self.coat_roughness.is_some()),
            ("sheen", self.sheen.is_some()),
            ("sheen_roughness", self.sheen_roughness.is_some()),
            ("specular", self.specular.is_some()),
            ("textures", self.textures.is_some()),
            ("alpha", self.alpha.is_some()),
            ("alpha_cutoff", self.alpha_cutoff.is_some()),
        ])
    }

    /// The keys of bodies that are given.
    fn of_bodies(&self) -> impl Iterator<Item = &'static str> {
        given([
            ("attenuation", self.attenuation.is_some()),
            ("attenuation_distance", self.attenuation_distance.is_some()),
            ("priority", self.priority.is_some()),
        ])
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
        let has_body = is_principled || matches!(self.kind, MaterialKind::Dielectric);
        let of_bodies = self.of_bodies().next().filter(|_| !has_body);
        let is_conductor = matches!(self.kind, MaterialKind::Conductor);
        let of_conductors = self.of_conductors().next().filter(|_| !is_conductor);
        let mut of_principled = self.of_principled();
        let other = of_principled
            .find(|key| !(is_principled || is_conductor && *key == "roughness"))
            .or(of_bodies)
            .or(of_conductors);
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
