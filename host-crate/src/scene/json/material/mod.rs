//! The rule that a scene file gives for a material.

mod layout;
mod textures;

pub(super) use self::textures::key_of;

use self::textures::{Albedo, TextureKeys};
use super::values::{
    AttenuationDistance, Colour, Eta, Extinction, Factor, Ior, Object, Priority, Radiance,
    Rotation, Share, present,
};
use crate::scene::material::{Anisotropy, Attenuation, Material, Opacity, Principled, Reflectance};
use crate::scene::metal::{Conductor, Metal};
use crate::scene::rule::{MaterialRule, Slot, TextureFile, TexturedRule};
use glam::Vec3;
use serde::Deserialize;

/// What a material is, as a scene file says it.
#[derive(Debug, Deserialize)]
#[serde(try_from = "MaterialKeys")]
pub(super) struct FileMaterial(pub MaterialRule);

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
    anisotropy: Option<Share>,
    #[serde(default, deserialize_with = "present")]
    anisotropy_rotation: Option<Rotation>,
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
    f90: Option<Share>,
    #[serde(default, deserialize_with = "present")]
    textures: Option<Object<TextureKeys>>,
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
        let material = match keys.kind {
            MaterialKind::Diffuse => keys.diffuse()?,
            MaterialKind::Mirror => keys.mirror()?.into(),
            MaterialKind::Dielectric => keys.dielectric()?.into(),
            MaterialKind::Emissive => keys.emissive()?.into(),
            MaterialKind::Principled => keys.principled()?,
            MaterialKind::Conductor => keys.metal()?.into(),
            MaterialKind::Null => {
                keys.refuse("a null", &SHARED)?;
                return Ok(Self(MaterialRule::Null));
            }
        };
        Ok(Self(material.rule()))
    }
}

/// A material and the files of its textures.
struct Made {
    material: Material,
    textures: Vec<TextureFile>,
}

impl From<Material> for Made {
    fn from(material: Material) -> Self {
        Self { material, textures: Vec::new() }
    }
}

impl Made {
    /// With its reflectance.
    fn with_albedo(mut self, albedo: Albedo) -> Self {
        match albedo {
            Albedo::Colour(Colour(colour)) => {
                self.material = self.material.with_reflectance(Reflectance::Colour(colour));
            }
            Albedo::Texture(file) => self.textures.insert(0, file),
        }
        self
    }

    fn rule(self) -> MaterialRule {
        let Self { material, textures } = self;
        if textures.is_empty() {
            return MaterialRule::Plain(material);
        }
        MaterialRule::Textured(TexturedRule { material, textures, otherwise: None })
    }
}

/// The material with 1 for each number that a texture multiplies, besides those of all principled
/// materials.
fn shown(mut material: Principled, textures: &[TextureFile]) -> Principled {
    for file in textures {
        match file.slot {
            Slot::Coat(_) => material.coat = 1.0,
            Slot::CoatRoughness(_) => material.coat_roughness = 1.0,
            Slot::Sheen => material.sheen = Vec3::ONE,
            Slot::SheenRoughness(_) => material.sheen_roughness = 1.0,
            Slot::Transmission(_) => material.transmission = 1.0,
            _ => {}
        }
    }
    material
}

/// Of keys with whether they are given, those that are.
fn given<const N: usize>(keys: [(&'static str, bool); N]) -> impl Iterator<Item = &'static str> {
    keys.into_iter().filter_map(|(key, is_given)| is_given.then_some(key))
}

/// The keys that principled materials and conductors have.
const OF_METAL: [&str; 3] = ["roughness", "anisotropy", "anisotropy_rotation"];

/// The keys that several kinds have.
const SHARED: [&str; 4] = ["reflectance", "radiance", "ior", "transmittance"];

impl MaterialKeys {
    fn diffuse(self) -> Result<Made, String> {
        self.refuse("a diffuse", &["radiance", "ior", "transmittance"])?;
        let albedo = needed("a diffuse", "reflectance", self.reflectance)?;
        Ok(Made::from(Material::diffuse(Vec3::ONE)).with_albedo(albedo))
    }

    fn mirror(self) -> Result<Material, String> {
        self.refuse("a mirror", &["radiance", "ior", "transmittance"])?;
        let reflectance = colour("a mirror", self.reflectance)?;
        Ok(Material::mirror(needed("a mirror", "reflectance", reflectance)?.0))
    }

    fn dielectric(self) -> Result<Material, String> {
        self.refuse("a dielectric", &["radiance"])?;
        let white = Colour(Vec3::ONE);
        let (attenuation, priority) = (self.attenuation()?, self.priority());
        Ok(Material::Dielectric {
            ior: needed("a dielectric", "ior", self.ior)?.0,
            transmittance: self.transmittance.unwrap_or(white).0,
            reflectance: colour("a dielectric", self.reflectance)?.unwrap_or(white).0,
            attenuation,
            priority,
        })
    }

    fn emissive(self) -> Result<Material, String> {
        self.refuse("an emissive", &["ior", "transmittance"])?;
        let black = Colour(Vec3::ZERO);
        Ok(Material::Emissive {
            radiance: needed("an emissive", "radiance", self.radiance)?.0,
            reflectance: colour("an emissive", self.reflectance)?.unwrap_or(black).0,
        })
    }

    fn metal(self) -> Result<Material, String> {
        self.refuse("a conductor", &SHARED)?;
        let Share(roughness) = self.roughness.unwrap_or(Share(0.0));
        let anisotropy = self.grain();
        let metal = Principled::conductor(self.conductor()?, roughness);
        Ok(Material::Principled(Principled { anisotropy, ..metal }))
    }

    /// A texture multiplies a number, which is then 1 unless the file says otherwise.
    fn principled(self) -> Result<Made, String> {
        self.refuse("a principled", &["transmittance"])?;
        let (attenuation, priority) = (self.attenuation()?, self.priority());
        let mut anisotropy = self.grain();
        let textures: Vec<_> =
            self.textures.map(|Object(textures)| textures.files().collect()).unwrap_or_default();
        if textures.iter().any(|file| matches!(file.slot, Slot::Bump(_)))
            && textures.iter().any(|file| matches!(file.slot, Slot::Normal(_)))
        {
            return Err("`textures` has `normal` or `bump`, not both".to_owned());
        }
        if self.anisotropy.is_none() && textures.iter().any(|file| file.slot == Slot::Grain) {
            anisotropy.strength = 1.0;
        }
        let has = |wanted: fn(&Slot) -> bool| textures.iter().any(|file| wanted(&file.slot));
        let roughness = if has(|slot| matches!(slot, Slot::Roughness(_))) { 1.0 } else { 0.5 };
        let metallic = if has(|slot| matches!(slot, Slot::Metallic(_))) { 1.0 } else { 0.0 };
        let emission = if has(|slot| *slot == Slot::Emission) { Vec3::ONE } else { Vec3::ZERO };
        let share = |key: Option<Share>, default| key.map_or(default, |Share(share)| share);
        let plain =
            shown(Principled::paint(Vec3::ONE, share(self.roughness, roughness)), &textures);
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
            anisotropy,
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
            f90: share(self.f90, plain.f90),
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
        let albedo = needed("a principled", "reflectance", self.reflectance)?;
        Ok(Made { material, textures }.with_albedo(albedo))
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

    fn grain(&self) -> Anisotropy {
        Anisotropy {
            strength: self.anisotropy.map_or(0.0, |Share(strength)| strength),
            rotation: self.anisotropy_rotation.map_or(0.0, |Rotation(degrees)| degrees),
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
            ("anisotropy", self.anisotropy.is_some()),
            ("anisotropy_rotation", self.anisotropy_rotation.is_some()),
            ("transmission", self.transmission.is_some()),
            ("thin_walled", self.thin_walled.is_some()),
            ("coat", self.coat.is_some()),
            ("coat_roughness", self.coat_roughness.is_some()),
            ("sheen", self.sheen.is_some()),
            ("sheen_roughness", self.sheen_roughness.is_some()),
            ("specular", self.specular.is_some()),
            ("f90", self.f90.is_some()),
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
            .find(|key| !(is_principled || is_conductor && OF_METAL.contains(key)))
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
