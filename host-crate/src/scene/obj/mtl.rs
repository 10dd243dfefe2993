//! MTL files, and the rules that make a material of what they say.
//!
//! Read here and not by tobj, which panics on a colour of one number and keeps no line numbers.

use crate::scene::bounds;
use crate::scene::error::SceneError;
use crate::scene::material::{Material, Reflectance};
use crate::scene::rule::MaterialRule;
use crate::scene::source::{Source, portable};
use glam::Vec3;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// What a material is that no MTL describes: grey.
pub(in crate::scene) const DEFAULT: MaterialRule = MaterialRule::Plain(Material::Diffuse {
    reflectance: Reflectance::Colour(DEFAULT_REFLECTANCE),
});

const DEFAULT_REFLECTANCE: Vec3 = Vec3::splat(0.5);
const DEFAULT_IOR: f64 = 1.5;
const MIRROR_MODELS: [i64; 2] = [3, 5];
const DIELECTRIC_MODELS: [i64; 4] = [4, 6, 7, 9];

/// The materials of all MTL files of an OBJ, by name.
#[derive(Debug, Default)]
pub(in crate::scene) struct Library {
    materials: HashMap<String, Entry>,
}

/// One material: its keys, in lower case, with their lines and values.
#[derive(Debug, Default)]
struct Entry {
    path: PathBuf,
    name: String,
    keys: HashMap<String, (usize, String)>,
}

/// A material's rule, and what the user should know about it.
pub(in crate::scene) struct Described {
    pub rule: MaterialRule,
    pub warning: Option<String>,
}

impl Library {
    /// Adds the materials of one MTL file, which replace those of the same names; `path` is where
    /// textures are looked for.
    pub(in crate::scene) fn add(&mut self, path: &Path, bytes: &[u8]) {
        let text = String::from_utf8_lossy(bytes);
        let mut added: HashMap<String, Entry> = HashMap::new();
        let mut current = None;
        for (index, line) in text.lines().enumerate() {
            let line = line.split_once('#').map_or(line, |(before, _)| before).trim();
            let (key, value) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
            if key == "newmtl" {
                let name = value.trim().to_owned();
                added.entry(name.clone()).or_insert_with(|| Entry {
                    path: path.to_owned(),
                    name: name.clone(),
                    keys: HashMap::new(),
                });
                current = Some(name);
            } else if let Some(entry) = current.as_ref().and_then(|name| added.get_mut(name)) {
                entry.keys.insert(key.to_lowercase(), (index + 1, value.trim().to_owned()));
            }
        }
        self.materials.extend(added);
    }

    /// What the files say of the material `name`, if anything. Textures are looked for beside the
    /// MTL, in `source`.
    pub(in crate::scene) fn describe(
        &self,
        name: &str,
        source: &dyn Source,
    ) -> Option<Result<Described, SceneError>> {
        Some(self.materials.get(name)?.describe(source))
    }
}

impl Entry {
    fn describe(&self, source: &dyn Source) -> Result<Described, SceneError> {
        let plain = |material| Ok(Described { rule: MaterialRule::Plain(material), warning: None });
        let illumination = self.number("illum")?.unwrap_or(2.0) as i64;
        let emitted = self.colour("ke")?.unwrap_or_default();
        if emitted.iter().any(|&component| component > 0.0) {
            let radiance = bounds::radiance(&emitted).map_err(|what| self.error("ke", what))?;
            let reflectance = self.reflectance("kd", DEFAULT_REFLECTANCE)?;
            return plain(Material::Emissive { radiance, reflectance });
        }
        if MIRROR_MODELS.contains(&illumination) {
            return plain(Material::mirror(self.reflectance("ks", Vec3::ZERO)?));
        }
        if DIELECTRIC_MODELS.contains(&illumination) {
            let ior = bounds::ior(self.number("ni")?.unwrap_or(DEFAULT_IOR))
                .map_err(|what| self.error("ni", what))?;
            return plain(Material::glass(ior));
        }
        self.diffuse(source)
    }

    fn diffuse(&self, source: &dyn Source) -> Result<Described, SceneError> {
        let colour = |entry: &Self| {
            entry
                .reflectance("kd", DEFAULT_REFLECTANCE)
                .map(|kd| MaterialRule::Plain(Material::diffuse(kd)))
        };
        let texture = self
            .keys
            .get("map_kd")
            .map(|(_, value)| value.as_str())
            .filter(|value| !value.is_empty());
        let Some(texture) = texture else {
            return Ok(Described { rule: colour(self)?, warning: None });
        };
        // The whole may be a name with spaces; else options may stand before the name.
        let last = texture.split_whitespace().next_back().unwrap_or(texture);
        let folder = self.path.parent().unwrap_or(Path::new(""));
        let found =
            [texture, last].into_iter().find_map(|name| source.find(folder, &portable(name)));
        match found {
            Some(path) => Ok(Described { rule: MaterialRule::Textured(path), warning: None }),
            None => {
                let warning = format!(
                    "{}: material `{}`: the texture `{texture}` is not there; its colour Kd is used instead.",
                    self.path.display(),
                    self.name
                );
                Ok(Described { rule: colour(self)?, warning: Some(warning) })
            }
        }
    }

    fn reflectance(&self, key: &str, default: Vec3) -> Result<Vec3, SceneError> {
        match self.colour(key)? {
            Some(colour) => bounds::reflectance(&colour).map_err(|what| self.error(key, what)),
            None => Ok(default),
        }
    }

    /// Three numbers; a single one stands for all three.
    fn colour(&self, key: &str) -> Result<Option<Vec<f64>>, SceneError> {
        let Some((_, value)) = self.keys.get(key) else { return Ok(None) };
        let numbers: Vec<f64> = value
            .split_whitespace()
            .take(3)
            .map(|word| self.parse(key, word))
            .collect::<Result<_, _>>()?;
        match numbers[..] {
            [grey] => Ok(Some(vec![grey; 3])),
            [_, _, _] => Ok(Some(numbers)),
            _ => {
                Err(self.error(key, format!("must be one or three numbers, has {}", numbers.len())))
            }
        }
    }

    fn number(&self, key: &str) -> Result<Option<f64>, SceneError> {
        let Some((_, value)) = self.keys.get(key) else { return Ok(None) };
        self.parse(key, value.split_whitespace().next().unwrap_or("")).map(Some)
    }

    fn parse(&self, key: &str, word: &str) -> Result<f64, SceneError> {
        let number = word.parse().ok().filter(|number: &f64| number.is_finite());
        number.ok_or_else(|| self.error(key, format!("`{word}` is not a finite number")))
    }

    fn error(&self, key: &str, what: String) -> SceneError {
        let line = self.keys.get(key).map_or(0, |(line, _)| *line);
        SceneError::Mtl {
            path: self.path.clone(),
            line,
            material: self.name.clone(),
            key: key.to_owned(),
            what,
        }
    }
}
