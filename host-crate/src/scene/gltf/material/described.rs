//! What a file says that a material is.

use super::{ALPHA, METALLIC, ROUGHNESS};
use crate::scene::bounds;
use crate::scene::error::SceneError;
use crate::scene::gltf::document::Document;
use crate::scene::gltf::extensions::{SPECULAR_GLOSSINESS, TRANSFORM};
use crate::scene::gltf::layout::Layout;
use crate::scene::gltf::specular_glossiness::SpecularGlossiness;
use crate::scene::gltf::texture::Textures;
use crate::scene::material::{Opacity, Principled};
use crate::scene::rule;
use crate::scene::summary::{Fate, Summary};
use crate::scene::texture::TextureId;
use glam::{DVec3, Vec3};
use gltf::json::material::{AlphaMode, Material, NormalTexture};
use gltf::json::texture::Info;
use gltf::json::validation::Checked::{self, Valid};
use serde::de::DeserializeOwned;
use std::ops::RangeInclusive;

const CLAMPED: Fate = Fate::Becomes("values beyond their range are brought into it: ");
const FOLLOWS_MEAN: Fate = Fate::Becomes("these textures are shown in their mean: ");
const MATT: Fate = Fate::Becomes("what shall not be lit is paint here, lit like all else: ");
/// What index of refraction stands for a surface that reflects all (0 in a file).
const REFLECTS_ALL: f64 = 100.0;

/// What the file says, with textures apart.
pub(super) struct Described {
    /// What it is called in messages.
    pub name: String,
    /// What it is but for its textures.
    pub plain: Principled,
    /// Whether none of it is seen.
    pub is_invisible: bool,
    /// What its alpha means, whether or not any of its own is below 1.
    pub opacity: Opacity,
    /// Its textures.
    pub slots: Vec<Slot>,
}

/// A texture, what it says and where it lies.
#[derive(Clone, Copy)]
pub(super) struct Slot {
    pub says: rule::Slot,
    pub texture: TextureId,
    pub layout: Layout,
    /// What it is called in messages.
    pub name: &'static str,
}

/// What materials are read from, and where it is noted what becomes of them.
pub(super) struct Sources<'a> {
    pub document: &'a Document<'a>,
    pub textures: Textures<'a>,
    pub summary: Summary,
}

/// A material as it is read.
pub(super) struct Reader<'m, 'a> {
    pub sources: &'m mut Sources<'a>,
    /// What the material is called in messages.
    pub name: String,
    /// Where it is in the file.
    pub place: String,
    /// The textures so far.
    pub slots: Vec<Slot>,
}

impl Sources<'_> {
    /// What the file says of a material, or what one is by default; `place` names it.
    pub(super) fn describe(
        &mut self,
        material: Option<usize>,
        place: &str,
    ) -> Result<Described, SceneError> {
        let document = self.document;
        let default = Material::default();
        let (json, own_place) = match material {
            Some(index) => {
                let place = format!("{place}.material");
                let json = document.get(&document.root.materials, index, "materials", &place)?;
                (json, format!("materials[{index}]"))
            }
            None => (&default, "the default material".to_owned()),
        };
        let name = json.name.clone().unwrap_or_else(|| own_place.clone());
        Reader { sources: self, name, place: own_place, slots: Vec::new() }.read(json)
    }
}

impl Reader<'_, '_> {
    pub(super) fn note(&mut self, fate: Fate, thing: &str) {
        let path = self.sources.document.path;
        self.sources.summary.note(path, 0, fate, thing, &self.name);
    }

    fn read(mut self, json: &Material) -> Result<Described, SceneError> {
        let older: Option<SpecularGlossiness> = self.extension(json, SPECULAR_GLOSSINESS)?;
        let extensions = json.extensions.as_ref();
        let (base, base_texture) = match &older {
            Some(older) => (older.diffuse_factor, older.diffuse_texture.as_ref()),
            None => {
                let model = &json.pbr_metallic_roughness;
                (model.base_color_factor.0, model.base_color_texture.as_ref())
            }
        };
        let [red, green, blue, alpha] = base;
        let base = self.colour("base colour", [red, green, blue]);
        self.slot(base_texture, &[rule::Slot::BaseColour], "the base colour's texture")?;
        let opacity = self.opacity(json, alpha)?;
        let may_be_seen_through = opacity != Opacity::Opaque;
        let pictures = &self.sources.textures.pictures;
        let has_alpha = self.slots.iter().any(|slot| pictures.has_alpha(slot.texture));
        let has_holes = may_be_seen_through && (alpha < 1.0 || has_alpha);
        let mut plain = Principled::paint(base, 1.0);
        if has_holes {
            plain.opacity = opacity;
        }
        let mut described = Described {
            plain,
            is_invisible: may_be_seen_through && alpha <= 0.0,
            opacity,
            slots: Vec::new(),
            name: self.name.clone(),
        };
        if extensions.is_some_and(|all| all.unlit.is_some()) {
            (described.plain.specular, described.plain.f90) = (Vec3::ZERO, 0.0);
            self.note(MATT, "KHR_materials_unlit");
            described.slots = self.slots;
            return Ok(described);
        }
        match &older {
            Some(older) => self.specular_glossiness(older, &mut described.plain)?,
            None => {
                let model = &json.pbr_metallic_roughness;
                described.plain.metallic = self.share("metallicFactor", model.metallic_factor.0);
                described.plain.roughness = self.share("roughnessFactor", model.roughness_factor.0);
                let says = [rule::Slot::Roughness(ROUGHNESS), rule::Slot::Metallic(METALLIC)];
                let texture = model.metallic_roughness_texture.as_ref();
                self.slot(texture, &says, "metallicRoughnessTexture")?;
                self.dielectric(json, &mut described.plain)?;
                self.cover(json, &mut described.plain)?;
            }
        }
        self.normal_map(json.normal_texture.as_ref(), rule::Slot::Normal, "normalTexture")?;
        described.plain.emission = self.emission(json)?;
        if has_holes && described.plain.emission != Vec3::ZERO {
            described.plain.opacity = Opacity::Opaque;
            self.note(Fate::Becomes("what emits is opaque: "), "alphaMode");
        }
        self.note_what_is_left_out(json)?;
        described.slots = self.slots;
        Ok(described)
    }

    fn specular_glossiness(
        &mut self,
        older: &SpecularGlossiness,
        plain: &mut Principled,
    ) -> Result<(), SceneError> {
        let mut specular = self.colour("specularFactor", older.specular_factor);
        let mut gloss = self.share("glossinessFactor", older.glossiness_factor);
        let thing = "specularGlossinessTexture";
        let texture = older.specular_glossiness_texture.as_ref();
        let texture = texture.map(|info| self.texture(info.index.value(), thing)).transpose()?;
        if let Some(texture) = texture.flatten() {
            self.note(FOLLOWS_MEAN, thing);
            let texture = self.sources.textures.pictures.get(texture);
            specular *= texture.mean();
            gloss *= texture.mean_code(ALPHA as usize);
        }
        plain.roughness = 1.0 - gloss;
        let straight = (plain.ior - 1.0) / (plain.ior + 1.0);
        plain.specular = specular / (straight * straight);
        Ok(())
    }

    /// What is said of surfaces that are no metal.
    fn dielectric(&mut self, json: &Material, plain: &mut Principled) -> Result<(), SceneError> {
        let Some(extensions) = &json.extensions else { return Ok(()) };
        if let Some(ior) = &extensions.ior {
            let ior = f64::from(ior.ior.0);
            let ior = if ior == 0.0 { REFLECTS_ALL } else { ior };
            plain.ior = bounds::ior(ior).unwrap_or_else(|_| {
                self.note(CLAMPED, "ior");
                (ior as f32).clamp(1.0, REFLECTS_ALL as f32)
            });
        }
        if let Some(specular) = &extensions.specular {
            let factor = self.share("specularFactor", specular.specular_factor.0);
            let texture = specular.specular_texture.as_ref();
            self.slot(texture, &[rule::Slot::Specular(ALPHA)], "specularTexture")?;
            let colour = specular.specular_color_factor.0.map(f64::from);
            let colour = bounds::factor(&colour).unwrap_or_else(|_| {
                self.note(CLAMPED, "specularColorFactor");
                clamped(colour, 0.0..=1.0)
            });
            let texture = specular.specular_color_texture.as_ref();
            self.slot(texture, &[rule::Slot::SpecularColour], "specularColorTexture")?;
            (plain.specular, plain.f90) = (colour * factor, factor);
        }
        if let Some(transmission) = &extensions.transmission {
            let factor = self.share("transmissionFactor", transmission.transmission_factor.0);
            if factor > 0.0 {
                let texture = transmission.transmission_texture.as_ref();
                self.slot(texture, &[rule::Slot::Transmission(0)], "transmissionTexture")?;
            }
            plain.transmission = factor;
        }
        Ok(())
    }

    /// Where there is a surface, by an alpha that the texture of the base colour multiplies.
    fn opacity(&mut self, json: &Material, alpha: f32) -> Result<Opacity, SceneError> {
        let mut alpha = || self.share("the alpha of the base colour", alpha);
        match json.alpha_mode {
            Valid(AlphaMode::Opaque) => Ok(Opacity::Opaque),
            Valid(AlphaMode::Mask) => {
                let alpha = alpha();
                let cutoff = json.alpha_cutoff.map_or(0.5, |cutoff| cutoff.0);
                Ok(Opacity::Mask { alpha, cutoff: self.share("alphaCutoff", cutoff) })
            }
            Valid(AlphaMode::Blend) => Ok(Opacity::Blend { alpha: alpha() }),
            Checked::Invalid => {
                let place = format!("{}.alphaMode", self.place);
                Err(self.sources.document.wrong(&place, "is none of glTF's"))
            }
        }
    }

    /// What the front emits, and the texture that multiplies it.
    fn emission(&mut self, json: &Material) -> Result<Vec3, SceneError> {
        let extensions = json.extensions.as_ref();
        let strength = extensions.and_then(|all| all.emissive_strength.as_ref());
        let strength = strength.map_or(1.0, |strength| f64::from(strength.emissive_strength.0));
        let emission = json.emissive_factor.0.map(|factor| f64::from(factor) * strength);
        let emission = bounds::radiance(&emission).unwrap_or_else(|_| {
            self.note(CLAMPED, "emissiveFactor");
            clamped(emission, 0.0..=bounds::MAX_RADIANCE)
        });
        if emission == Vec3::ZERO {
            return Ok(emission);
        }
        self.slot(json.emissive_texture.as_ref(), &[rule::Slot::Emission], "emissiveTexture")?;
        if json.double_sided {
            self.note(Fate::Becomes("lamps shine from the front alone: "), "doubleSided");
        }
        Ok(emission)
    }

    /// A map of normals, if there is one and its picture can be read.
    pub(super) fn normal_map(
        &mut self,
        normal: Option<&NormalTexture>,
        says: fn(f32) -> rule::Slot,
        name: &'static str,
    ) -> Result<(), SceneError> {
        let Some(normal) = normal else { return Ok(()) };
        let transform = normal.extensions.as_ref().and_then(|all| all.others.get(TRANSFORM));
        let layout = Layout::new(self.sources.document, normal.tex_coord, transform, &self.place)?;
        let scale = bounds::scale(normal.scale.into()).unwrap_or_else(|_| {
            self.note(CLAMPED, "normalTexture.scale");
            1.0
        });
        let texture = self.texture(normal.index.value(), name)?;
        let slot = |texture| Slot { says: says(scale), texture, layout, name };
        self.slots.extend(texture.map(slot));
        Ok(())
    }

    /// A texture and what it says, if there is one and its picture can be read.
    pub(super) fn slot(
        &mut self,
        info: Option<&Info>,
        says: &[rule::Slot],
        name: &'static str,
    ) -> Result<(), SceneError> {
        let Some(info) = info else { return Ok(()) };
        let transform = info.extensions.as_ref().and_then(|all| all.others.get(TRANSFORM));
        let layout = Layout::new(self.sources.document, info.tex_coord, transform, &self.place)?;
        if let Some(texture) = self.texture(info.index.value(), name)? {
            let slot = |&says: &rule::Slot| Slot { says, texture, layout, name };
            self.slots.extend(says.iter().map(slot));
        }
        Ok(())
    }

    /// The texture of this number, if its picture can be read.
    fn texture(&mut self, texture: usize, name: &str) -> Result<Option<TextureId>, SceneError> {
        let place = format!("{}, {name}", self.place);
        let Sources { textures, summary, .. } = &mut *self.sources;
        textures.load(texture, &place, &self.name, summary)
    }

    /// What the file has under this name, if anything.
    pub(super) fn extension<T: DeserializeOwned>(
        &self,
        json: &Material,
        name: &str,
    ) -> Result<Option<T>, SceneError> {
        let others = json.extensions.as_ref().map(|all| &all.others);
        let Some(value) = others.and_then(|others| others.get(name)) else { return Ok(None) };
        let place = format!("{}.extensions.{name}", self.place);
        let fail =
            |error: serde_json::Error| self.sources.document.wrong(&place, error.to_string());
        T::deserialize(value).map(Some).map_err(fail)
    }

    /// A share in [0, 1].
    pub(super) fn share(&mut self, thing: &str, value: f32) -> f32 {
        bounds::share(value.into()).unwrap_or_else(|_| {
            self.note(CLAMPED, thing);
            value.clamp(0.0, 1.0)
        })
    }

    /// A share of light.
    pub(super) fn colour(&mut self, thing: &str, colour: [f32; 3]) -> Vec3 {
        let colour = colour.map(f64::from);
        bounds::reflectance(&colour).unwrap_or_else(|_| {
            self.note(CLAMPED, thing);
            clamped(colour, 0.0..=1.0)
        })
    }
}

fn clamped(values: [f64; 3], range: RangeInclusive<f64>) -> Vec3 {
    let clamped = values.map(|value| value.clamp(*range.start(), *range.end()));
    DVec3::from_array(clamped).as_vec3()
}
