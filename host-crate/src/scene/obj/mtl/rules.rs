//! What a material is by its MTL.

use super::library::{Entry, Library};
use super::map::MapStatement;
use crate::scene::bounds;
use crate::scene::error::SceneError;
use crate::scene::material::{Anisotropy, Material, Principled, Reflectance};
use crate::scene::obj::texture_map::TextureMap;
use crate::scene::rule::{self, MaterialRule, Otherwise, Slot, TexturedRule};
use crate::scene::source::{Found, Source, find_foreign};
use crate::scene::summary::{Fate, Summary};
use crate::scene::text::Name;
use crate::scene::texture::{CoordinateSet, TextureFilter};
use glam::Vec3;
use std::path::{Path, PathBuf};

/// What a material is that no MTL describes: grey.
pub(in crate::scene) const DEFAULT: MaterialRule = MaterialRule::Plain(Material::Diffuse {
    reflectance: Reflectance::Colour(DEFAULT_REFLECTANCE),
});

const DEFAULT_REFLECTANCE: Vec3 = Vec3::splat(0.5);
const DEFAULT_IOR: f64 = 1.5;
const DEFAULT_ROUGHNESS: f64 = 0.5;
/// Which exponent of a highlight stands for a mirror: the largest of the specification.
pub(super) const SHARPEST: f64 = 1000.0;
const MIRROR_MODELS: [i64; 2] = [3, 5];
/// Keys of textures of emission; the first that there is counts.
pub(super) const EMISSION_MAPS: [&str; 2] = ["map_ke", "map_emissive"];
/// Keys of bump maps; the first that says how high it is counts.
pub(super) const BUMP_MAPS: [&str; 2] = ["bump", "map_bump"];
const MISSING_BUMP: Fate = Fate::Becomes("these bump maps are not there and are left out: ");
/// The highest bump map.
const MAX_HEIGHT: f64 = 1e4;
pub(super) const GLASS_MODELS: [i64; 4] = [4, 6, 7, 9];

/// What kind of surface a material is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Surface {
    Lamp,
    Mirror,
    Glass,
    /// By the keys of physically based materials.
    Principled,
    Paint,
}

impl Surface {
    /// Whether a texture may say what it emits.
    pub(super) fn may_glow(self) -> bool {
        !matches!(self, Self::Mirror | Self::Glass)
    }
}

/// A texture that an MTL names.
#[derive(Clone)]
struct TextureFile {
    path: PathBuf,
    /// The line that names it.
    line: usize,
    map: TextureMap,
}

/// The material with an emission for a texture to multiply: white, where it has none.
fn glowing(material: Material) -> Material {
    match material {
        Material::Principled(principled) if principled.emission == Vec3::ZERO => {
            Material::Principled(Principled { emission: Vec3::ONE, ..principled })
        }
        material => material,
    }
}

/// Says what materials are, and notes what of them is left out.
pub(in crate::scene) struct Describer<'a> {
    pub library: &'a Library,
    pub source: &'a dyn Source,
    /// The folder of the OBJ, where textures may lie if not beside the MTL.
    pub obj_folder: &'a Path,
}

impl Describer<'_> {
    /// What the files say of the material `name`, if anything.
    pub(in crate::scene) fn describe(
        &self,
        name: &Name,
        summary: &mut Summary,
    ) -> Option<Result<MaterialRule, SceneError>> {
        let entry = self.library.get(name)?;
        Some(self.rule(entry, summary))
    }

    fn rule(&self, entry: &Entry, summary: &mut Summary) -> Result<MaterialRule, SceneError> {
        let surface = entry.surface()?;
        entry.note_what_has_no_effect(surface, summary);
        let kd = || entry.reflectance("kd", DEFAULT_REFLECTANCE);
        let glow = if surface.may_glow() { self.glow(entry, summary) } else { None };
        let bump = if surface.may_glow() { self.bump(entry, summary) } else { None };
        let material = match surface {
            Surface::Principled => Material::Principled(entry.principled()?),
            Surface::Lamp | Surface::Paint if glow.is_some() || bump.is_some() => {
                entry.without_highlight()?
            }
            Surface::Lamp => {
                if let Some(lost) = entry.keys.get("map_kd").filter(|_| entry.glows(surface)) {
                    // The texture of its emission, beside which it would have counted, is not
                    // there.
                    let (name, thing) = (entry.name.to_string(), lost.key.escape_default());
                    let thing = thing.to_string();
                    summary.note(&entry.path, lost.line, Fate::WithoutEffect, &thing, &name);
                }
                let (radiance, reflectance) = (entry.radiance("ke")?, kd()?);
                return Ok(MaterialRule::Plain(Material::Emissive { radiance, reflectance }));
            }
            Surface::Mirror => {
                let reflectance = entry.reflectance("ks", Vec3::ZERO)?;
                return Ok(MaterialRule::Plain(Material::mirror(reflectance)));
            }
            Surface::Glass => return Ok(MaterialRule::Plain(Material::glass(entry.ior()?))),
            Surface::Paint => Material::diffuse(DEFAULT_REFLECTANCE),
        };
        let colour = self.colour(entry, summary);
        let otherwise = Otherwise {
            mtl: entry.path.clone(),
            reflectance: kd().unwrap_or(DEFAULT_REFLECTANCE),
            emission: material.radiance(),
        };
        let material = match colour {
            Some(_) => material,
            None => material.with_reflectance(Reflectance::Colour(kd()?)),
        };
        let material = if glow.is_some() { glowing(material) } else { material };
        let found = [(Slot::Colour, colour), (Slot::Emission, glow)];
        let found = found.into_iter().filter_map(|(slot, found)| Some((slot, found?)));
        let found: Vec<_> = found.chain(bump).collect();
        if found.is_empty() {
            return Ok(MaterialRule::Plain(material));
        }
        let file = |(slot, TextureFile { path, line, map })| rule::TextureFile {
            slot,
            line,
            path,
            filter: TextureFilter::Linear,
            map,
            set: CoordinateSet::First,
        };
        let textures = found.into_iter().map(file).collect();
        let otherwise = Some(otherwise);
        Ok(MaterialRule::Textured(TexturedRule { material, textures, otherwise }))
    }

    /// The texture of the colour, if the entry names one that is there.
    fn colour(&self, entry: &Entry, summary: &mut Summary) -> Option<TextureFile> {
        self.texture(entry, "map_kd", Fate::MissingTexture, summary)
    }

    /// The texture of the emission, if the entry names one that is there.
    fn glow(&self, entry: &Entry, summary: &mut Summary) -> Option<TextureFile> {
        let key = EMISSION_MAPS.into_iter().find(|key| entry.keys.contains_key(*key))?;
        self.texture(entry, key, Fate::MissingEmission, summary)
    }

    /// The bump map, if the entry names one that is there and says how high it is.
    fn bump(&self, entry: &Entry, summary: &mut Summary) -> Option<(Slot, TextureFile)> {
        let (key, height) = entry.bump()?;
        let file = self.texture(entry, key, MISSING_BUMP, summary)?;
        Some((Slot::Bump(height), file))
    }

    /// The texture behind a key; if it is not there, that is its `fate`.
    fn texture(
        &self,
        entry: &Entry,
        key: &str,
        fate: Fate,
        summary: &mut Summary,
    ) -> Option<TextureFile> {
        let value = entry.keys.get(key)?;
        let mut note = |fate, thing: &str| {
            summary.note(&entry.path, value.line, fate, thing, &entry.name.to_string());
        };
        let Some((statement, found)) = self.find_texture(entry, &value.text) else {
            note(fate, &Name::new(&value.text).to_string());
            return None;
        };
        for option in &statement.without_effect {
            note(Fate::WithoutEffect, &format!("{} {option}", value.key));
        }
        if !BUMP_MAPS.contains(&key) && statement.height.is_some_and(|height| height != 1.0) {
            note(Fate::WithoutEffect, &format!("{} -bm", value.key));
        }
        if found.by_its_end {
            note(Fate::FoundByEnd, &Name::new(statement.file).to_string());
        }
        Some(TextureFile { path: found.path, line: value.line, map: statement.map })
    }

    /// The file that the value of a `map_` key names. Beside the MTL comes before beside the OBJ,
    /// and all of the value before what is left of its options. The last word is tried since there
    /// may be options that nobody knows.
    fn find_texture<'v>(
        &self,
        entry: &Entry,
        value: &'v [u8],
    ) -> Option<(MapStatement<'v>, Found)> {
        let folders = [entry.path.parent().unwrap_or(Path::new("")), self.obj_folder];
        let find = |name: &[u8]| find_foreign(self.source, &folders, &Name::new(name));
        let statement = MapStatement::parse(value);
        if statement.file.len() < value.len()
            && let Some(found) = find(value).filter(|found| !found.by_its_end)
        {
            return Some((MapStatement { file: value, ..MapStatement::default() }, found));
        }
        if let Some(found) = find(statement.file) {
            return Some((statement, found));
        }
        let comment = statement.file.windows(2).position(|pair| pair == b" #" || pair == b"\t#");
        if let Some(found) = comment.and_then(|start| find(&statement.file[..start])) {
            return Some((statement, found));
        }
        let last = statement.file.rsplit(u8::is_ascii_whitespace).next()?;
        let found = find(last).filter(|_| statement.file.starts_with(b"-"))?;
        let mut statement = MapStatement { file: last, ..statement };
        statement.without_effect.push("with unknown options".to_owned());
        Some((statement, found))
    }
}

impl Entry {
    /// What kind of surface it is. Numbers of `illum` are often written without care, so paint
    /// stays paint unless something else speaks for a mirror or for glass.
    fn surface(&self) -> Result<Surface, SceneError> {
        let model = self.number("illum")?.unwrap_or(2.0) as i64;
        Ok(if self.is_principled() {
            Surface::Principled
        } else if self.radiance("ke")? != Vec3::ZERO {
            Surface::Lamp
        } else if MIRROR_MODELS.contains(&model) && self.hints("ks").iter().any(|&ks| ks != 0.0) {
            Surface::Mirror
        } else if GLASS_MODELS.contains(&model) && self.is_transparent() {
            Surface::Glass
        } else {
            Surface::Paint
        })
    }

    /// The key of the bump map, and how high that is, in units of the OBJ.
    pub(super) fn bump(&self) -> Option<(&'static str, f32)> {
        BUMP_MAPS.into_iter().find_map(|key| {
            let height = MapStatement::parse(&self.keys.get(key)?.text).height?;
            (height.abs() <= MAX_HEIGHT).then_some((key, height as f32))
        })
    }

    /// Paint, or a lamp, that has textures but no highlight; its colour comes later.
    fn without_highlight(&self) -> Result<Material, SceneError> {
        Ok(Material::Principled(Principled {
            specular: Vec3::ZERO,
            emission: self.radiance("ke")?,
            ..Principled::paint(DEFAULT_REFLECTANCE, 1.0)
        }))
    }

    /// Whether a texture says what it emits.
    pub(super) fn glows(&self, surface: Surface) -> bool {
        surface.may_glow() && EMISSION_MAPS.iter().any(|key| self.keys.contains_key(*key))
    }

    /// Whether it has the keys of a physically based material: a roughness, or some metal.
    fn is_principled(&self) -> bool {
        self.keys.contains_key("pr") || self.hints("pm").first().is_some_and(|&pm| pm != 0.0)
    }

    fn ior(&self) -> Result<f32, SceneError> {
        let ior = self.number("ni")?.unwrap_or(DEFAULT_IOR);
        bounds::ior(ior).map_err(|what| self.error("ni", what))
    }

    /// What those keys say, but for the colour. Where there is no roughness, the exponent of the
    /// highlight tells it, as Blender writes it: `1000 (1 - roughness)^2`.
    fn principled(&self) -> Result<Principled, SceneError> {
        let model = self.number("illum")?.unwrap_or(2.0) as i64;
        let exponent = self.hints("ns").first().copied();
        let rough = |ns: f64| 1.0 - (ns / SHARPEST).clamp(0.0, 1.0).sqrt();
        let is_glass = GLASS_MODELS.contains(&model) && self.is_transparent();
        let roughness = self.share("pr", exponent.map_or(DEFAULT_ROUGHNESS, rough))?;
        let (roughness, anisotropy) = self.grain(roughness)?;
        Ok(Principled {
            metallic: self.share("pm", 0.0)?,
            roughness,
            anisotropy,
            ior: self.ior()?,
            transmission: f32::from(u8::from(is_glass)),
            coat: self.share("pc", 0.0)?,
            coat_roughness: self.share("pcr", 0.0)?,
            sheen: Vec3::splat(self.share("ps", 0.0)?),
            emission: self.radiance("ke")?,
            ..Principled::paint(DEFAULT_REFLECTANCE, 0.0)
        })
    }

    /// What `aniso` makes of a roughness (Burley, "Physically-Based Shading at Disney", 2012): the
    /// slope along the grain is divided, and that across is multiplied, by the root of `1 - 0.9
    /// aniso`. `anisor` turns it, by whole turns.
    fn grain(&self, roughness: f32) -> Result<(f32, Anisotropy), SceneError> {
        let aniso = self.share("aniso", 0.0)?;
        if aniso == 0.0 {
            return Ok((roughness, Anisotropy::default()));
        }
        let rotation = 360.0 * self.share("anisor", 0.0)?;
        let (slope, aspect) = (roughness * roughness, (1.0 - 0.9 * aniso).sqrt());
        let (along, across) = ((slope / aspect).min(1.0), slope * aspect);
        let strength = ((along - across) / (1.0 - across).max(f32::MIN_POSITIVE)).sqrt().min(1.0);
        Ok((across.sqrt(), Anisotropy { strength, rotation }))
    }

    /// Whether light passes: by the opacity, or by the filter, or by an index of refraction above 1
    /// unless a picture is painted on it. Nothing passes a filter of 0.
    fn is_transparent(&self) -> bool {
        let filter = self.hints("tf");
        if !filter.is_empty() && filter.iter().all(|&share| share == 0.0) {
            return false;
        }
        let refracts = self.hints("ni").first().is_some_and(|&ior| ior > 1.0 + 1e-6);
        refracts && !self.keys.contains_key("map_kd")
            || self.is_see_through()
            || filter.iter().any(|&share| share != 1.0)
    }

    /// Whether `d`, or else `Tr`, says that the surface is not opaque. `Tr 1` alone is no sign:
    /// some programs write it for what is opaque.
    fn is_see_through(&self) -> bool {
        match (self.hints("d").last(), self.hints("tr").first()) {
            (Some(&opacity), _) => opacity < 1.0,
            (None, Some(&transparency)) => transparency > 0.0 && transparency < 1.0,
            (None, None) => false,
        }
    }
}
