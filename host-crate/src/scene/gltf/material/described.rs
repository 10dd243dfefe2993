//! What a file says that a material is.

use super::ALPHA;
use crate::scene::bounds;
use crate::scene::error::SceneError;
use crate::scene::gltf::document::Document;
use crate::scene::gltf::extensions::{SPECULAR_GLOSSINESS, TRANSFORM};
use crate::scene::gltf::layout::Layout;
use crate::scene::gltf::specular_glossiness::SpecularGlossiness;
use crate::scene::gltf::texture::Textures;
use crate::scene::material::{Opacity, Principled};
use crate::scene::summary::{Fate, Summary};
use crate::scene::texture::TextureId;
use glam::{DVec3, Vec3};
use gltf::json::material::{AlphaMode, Material, NormalTexture};
use gltf::json::texture::Info;
use gltf::json::validation::Checked::{self, Valid};
use serde::de::DeserializeOwned;
use std::ops::RangeInclusive;

const CLAMPED: Fate = Fate::Becomes("values beyond their range are brought into it: ");
const ONE_LAYOUT: Fate = Fate::Becomes(
    "a material has one set of texture coordinates and one transform of them here, its first \
     texture's; these textures are laid by it too: ",
);
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
    pub base_colour: Option<Slot>,
    /// Of roughness and metal.
    pub roughness: Option<Slot>,
    /// And what slopes are multiplied by.
    pub normal: Option<(Slot, f32)>,
    pub emission: Option<Slot>,
}

/// A texture and where it lies.
#[derive(Clone, Copy)]
pub(super) struct Slot {
    pub texture: TextureId,
    pub layout: Layout,
}

impl Described {
    /// Where its textures lie; without any, the first coordinates if they say where its grain runs.
    pub(super) fn layout(&self) -> Option<Layout> {
        let grain = (self.plain.anisotropy.strength > 0.0).then_some(Layout::FIRST);
        self.layout_of_textures().or(grain)
    }

    /// Where its textures lie.
    pub(super) fn layout_of_textures(&self) -> Option<Layout> {
        let normal = self.normal.map(|(slot, _)| slot);
        let slots = [self.base_colour, self.roughness, normal, self.emission];
        slots.into_iter().flatten().next().map(|slot| slot.layout)
    }
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
        Reader { sources: self, name, place: own_place }.read(json)
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
        let base_colour = self.slot(base_texture, "the base colour's texture")?;
        let opacity = self.opacity(json, alpha)?;
        let may_be_seen_through = opacity != Opacity::Opaque;
        let pictures = &self.sources.textures.pictures;
        let has_alpha = base_colour.is_some_and(|slot| pictures.has_alpha(slot.texture));
        let has_holes = may_be_seen_through && (alpha < 1.0 || has_alpha);
        let mut plain = Principled::paint(base, 1.0);
        if has_holes {
            plain.opacity = opacity;
        }
        let mut described = Described {
            plain,
            is_invisible: may_be_seen_through && alpha <= 0.0,
            opacity,
            base_colour,
            roughness: None,
            normal: None,
            emission: None,
            name: self.name.clone(),
        };
        if extensions.is_some_and(|all| all.unlit.is_some()) {
            described.plain.specular = Vec3::ZERO;
            self.note(MATT, "KHR_materials_unlit");
            return Ok(described);
        }
        match &older {
            Some(older) => self.specular_glossiness(older, &mut described.plain)?,
            None => {
                let model = &json.pbr_metallic_roughness;
                described.plain.metallic = self.share("metallicFactor", model.metallic_factor.0);
                described.plain.roughness = self.share("roughnessFactor", model.roughness_factor.0);
                described.roughness = self
                    .slot(model.metallic_roughness_texture.as_ref(), "metallicRoughnessTexture")?;
                self.dielectric(json, &mut described.plain)?;
                self.cover(json, &mut described.plain)?;
            }
        }
        described.normal = self.normal_map(json.normal_texture.as_ref())?;
        (described.plain.emission, described.emission) = self.emission(json)?;
        if has_holes && described.plain.emission != Vec3::ZERO {
            described.plain.opacity = Opacity::Opaque;
            self.note(Fate::Becomes("what emits is opaque: "), "alphaMode");
        }
        self.note_what_is_left_out(json)?;
        self.note_other_layouts(&described);
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
        if let Some(slot) = self.slot(older.specular_glossiness_texture.as_ref(), thing)? {
            self.note(FOLLOWS_MEAN, thing);
            let texture = self.sources.textures.pictures.get(slot.texture);
            specular *= texture.mean();
            gloss *= texture.mean_code(ALPHA);
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
            let mut factor = self.share("specularFactor", specular.specular_factor.0);
            let texture = specular.specular_texture.as_ref();
            factor *= self.mean_code(texture, "specularTexture", ALPHA)?;
            let colour = specular.specular_color_factor.0.map(f64::from);
            let mut colour = bounds::factor(&colour).unwrap_or_else(|_| {
                self.note(CLAMPED, "specularColorFactor");
                clamped(colour, 0.0..=1.0)
            });
            let texture = specular.specular_color_texture.as_ref();
            colour *= self.mean(texture, "specularColorTexture")?;
            if factor < 1.0 {
                let what = "reflection at grazing angles is not made less by specularFactor: ";
                self.note(Fate::Judged(what), "specularFactor");
            }
            plain.specular = colour * factor;
        }
        if let Some(transmission) = &extensions.transmission {
            let mut factor = self.share("transmissionFactor", transmission.transmission_factor.0);
            let thing = "transmissionTexture";
            if let Some(slot) = self.slot(transmission.transmission_texture.as_ref(), thing)?
                && factor > 0.0
            {
                self.note(FOLLOWS_MEAN, thing);
                factor *= self.sources.textures.pictures.get(slot.texture).mean_code(0);
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
    fn emission(&mut self, json: &Material) -> Result<(Vec3, Option<Slot>), SceneError> {
        let extensions = json.extensions.as_ref();
        let strength = extensions.and_then(|all| all.emissive_strength.as_ref());
        let strength = strength.map_or(1.0, |strength| f64::from(strength.emissive_strength.0));
        let emission = json.emissive_factor.0.map(|factor| f64::from(factor) * strength);
        let emission = bounds::radiance(&emission).unwrap_or_else(|_| {
            self.note(CLAMPED, "emissiveFactor");
            clamped(emission, 0.0..=bounds::MAX_RADIANCE)
        });
        if emission == Vec3::ZERO {
            return Ok((emission, None));
        }
        let slot = self.slot(json.emissive_texture.as_ref(), "emissiveTexture")?;
        if json.double_sided {
            self.note(Fate::Becomes("lamps shine from the front alone: "), "doubleSided");
        }
        Ok((emission, slot))
    }

    fn normal_map(
        &mut self,
        normal: Option<&NormalTexture>,
    ) -> Result<Option<(Slot, f32)>, SceneError> {
        let Some(normal) = normal else { return Ok(None) };
        let transform = normal.extensions.as_ref().and_then(|all| all.others.get(TRANSFORM));
        let slot = self.slot_of(
            normal.index.value(),
            Layout::new(self.sources.document, normal.tex_coord, transform, &self.place)?,
            "normalTexture",
        )?;
        let scale = bounds::scale(normal.scale.into()).unwrap_or_else(|_| {
            self.note(CLAMPED, "normalTexture.scale");
            1.0
        });
        Ok(slot.map(|slot| (slot, scale)))
    }

    /// A texture, if there is one and its picture can be read.
    pub(super) fn slot(
        &mut self,
        info: Option<&Info>,
        thing: &str,
    ) -> Result<Option<Slot>, SceneError> {
        let Some(info) = info else { return Ok(None) };
        let transform = info.extensions.as_ref().and_then(|all| all.others.get(TRANSFORM));
        let layout = Layout::new(self.sources.document, info.tex_coord, transform, &self.place)?;
        self.slot_of(info.index.value(), layout, thing)
    }

    fn slot_of(
        &mut self,
        texture: usize,
        layout: Layout,
        thing: &str,
    ) -> Result<Option<Slot>, SceneError> {
        let place = format!("{}, {thing}", self.place);
        let Sources { textures, summary, .. } = &mut *self.sources;
        let texture = textures.load(texture, &place, &self.name, summary)?;
        Ok(texture.map(|texture| Slot { texture, layout }))
    }

    fn note_other_layouts(&mut self, described: &Described) {
        let normal = described.normal.map(|(slot, _)| slot);
        let others = [
            (described.roughness, "metallicRoughnessTexture"),
            (normal, "normalTexture"),
            (described.emission, "emissiveTexture"),
        ];
        for (slot, thing) in others {
            if slot.is_some_and(|slot| Some(slot.layout) != described.layout()) {
                self.note(ONE_LAYOUT, thing);
            }
        }
    }

    /// The mean colour of a texture; white if there is none.
    pub(super) fn mean(&mut self, texture: Option<&Info>, thing: &str) -> Result<Vec3, SceneError> {
        let Some(slot) = self.slot(texture, thing)? else { return Ok(Vec3::ONE) };
        self.note(FOLLOWS_MEAN, thing);
        Ok(self.sources.textures.pictures.get(slot.texture).mean())
    }

    /// The mean of a channel of a texture; 1 if there is none.
    pub(super) fn mean_code(
        &mut self,
        texture: Option<&Info>,
        thing: &str,
        channel: usize,
    ) -> Result<f32, SceneError> {
        let Some(slot) = self.slot(texture, thing)? else { return Ok(1.0) };
        self.note(FOLLOWS_MEAN, thing);
        Ok(self.sources.textures.pictures.get(slot.texture).mean_code(channel))
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
