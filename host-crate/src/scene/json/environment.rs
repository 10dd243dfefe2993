//! The environment of a scene file.

use super::names::Names;
use super::values::{Radiance, Rotation, Strength, present};
use crate::scene::description::Scene;
use crate::scene::environment::Environment;
use crate::scene::error::SceneError;
use crate::scene::options::LoadOptions;
use glam::Vec3;
use serde::Deserialize;

/// Light from all around: a picture of it, or the same from everywhere.
#[derive(Debug, Deserialize)]
#[serde(try_from = "EnvironmentKeys")]
pub(super) struct FileEnvironment(EnvironmentKeys);

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct EnvironmentKeys {
    #[serde(default, deserialize_with = "present")]
    file: Option<String>,
    #[serde(default, deserialize_with = "present")]
    rotation: Option<Rotation>,
    #[serde(default, deserialize_with = "present")]
    strength: Option<Strength>,
    #[serde(default, deserialize_with = "present")]
    colour: Option<Radiance>,
}

impl TryFrom<EnvironmentKeys> for FileEnvironment {
    type Error = String;

    fn try_from(keys: EnvironmentKeys) -> Result<Self, String> {
        if keys.file.is_none() && keys.colour.is_none() {
            return Err("an environment needs the key `file`, or `colour`".to_owned());
        }
        if keys.file.is_none() && keys.rotation.is_some() {
            return Err("`rotation` needs a `file` to turn".to_owned());
        }
        Ok(Self(keys))
    }
}

impl FileEnvironment {
    /// Reads the picture and lights the scene by it.
    pub(super) fn light(
        &self,
        names: &Names<'_>,
        options: LoadOptions,
        scene: &mut Scene,
    ) -> Result<(), SceneError> {
        let Self(keys) = self;
        let colour = keys.colour.map_or(Vec3::ONE, |Radiance(colour)| colour);
        let environment = match &keys.file {
            None => Environment::new(1, 1, vec![colour]),
            Some(file) => {
                let path = names.find("environment.file", file, &[names.folder])?;
                let (mut environment, warnings) = options.read_environment(names.source, &path)?;
                scene.warnings.extend(warnings);
                if keys.colour.is_some() {
                    environment.texels.iter_mut().for_each(|texel| *texel *= colour);
                }
                environment
            }
        };
        let environment = Environment {
            rotation: keys.rotation.map_or(0.0, |Rotation(rotation)| rotation),
            strength: keys.strength.map_or(1.0, |Strength(strength)| strength),
            ..environment
        };
        environment.check().map_err(|what| super::wrong_key(names.scene, "environment", &what))?;
        scene.set_environment(environment);
        Ok(())
    }
}
