//! The environment of a scene file.

use super::names::Names;
use super::values::{Colour, Elevation, Object, Radiance, Rotation, Strength, Turbidity, present};
use crate::scene::description::Scene;
use crate::scene::environment::Environment;
use crate::scene::error::SceneError;
use crate::scene::options::LoadOptions;
use crate::scene::sky::Sky;
use glam::Vec3;
use serde::Deserialize;

/// Light from all around: a picture of it, a sky, or the same from everywhere.
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
    #[serde(default, deserialize_with = "present")]
    sky: Option<Object<SkyKeys>>,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct SkyKeys {
    elevation: Elevation,
    #[serde(default, deserialize_with = "present")]
    turbidity: Option<Turbidity>,
    #[serde(default, deserialize_with = "present")]
    ground: Option<Colour>,
    #[serde(default, deserialize_with = "present")]
    sun: Option<bool>,
}

impl SkyKeys {
    fn sky(self) -> Sky {
        let sky = Sky::new(self.elevation.0);
        Sky {
            turbidity: self.turbidity.map_or(sky.turbidity, |Turbidity(turbidity)| turbidity),
            ground: self.ground.map_or(sky.ground, |Colour(colour)| colour),
            has_sun: self.sun.unwrap_or(sky.has_sun),
            ..sky
        }
    }
}

impl TryFrom<EnvironmentKeys> for FileEnvironment {
    type Error = String;

    fn try_from(keys: EnvironmentKeys) -> Result<Self, String> {
        let has_picture = keys.file.is_some() || keys.sky.is_some();
        if keys.file.is_some() && keys.sky.is_some() {
            return Err("an environment has a `file` or a `sky`, not both".to_owned());
        }
        if !has_picture && keys.colour.is_none() {
            return Err("an environment needs the key `file`, `sky` or `colour`".to_owned());
        }
        if !has_picture && keys.rotation.is_some() {
            return Err("`rotation` needs a `file` or a `sky` to turn".to_owned());
        }
        Ok(Self(keys))
    }
}

impl FileEnvironment {
    /// Reads the picture and lights the scene by it.
    pub(super) fn light(
        &self,
        names: &Names<'_>,
        options: &LoadOptions,
        scene: &mut Scene,
    ) -> Result<(), SceneError> {
        let Self(keys) = self;
        let colour = keys.colour.map_or(Vec3::ONE, |Radiance(colour)| colour);
        let mut environment = match (&keys.file, keys.sky) {
            (None, None) => Environment::new(1, 1, vec![Vec3::ONE]),
            (None, Some(Object(sky))) => sky.sky().environment(),
            (Some(file), _) => {
                let path = names.find("environment.file", file, &[names.folder])?;
                let (environment, warnings) = options.read_environment(names.source, &path)?;
                scene.warnings.extend(warnings);
                environment
            }
        };
        if keys.colour.is_some() {
            environment.texels.iter_mut().for_each(|texel| *texel *= colour);
        }
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
