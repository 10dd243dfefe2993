//! The lights of a scene file that have no surface.

use super::values::{Angle, AngularDiameter, Coordinates, Place, Radiance, present};
use crate::scene::bounds;
use crate::scene::light::PunctualLight;
use glam::{DVec3, Vec3};
use serde::Deserialize;

/// A light, where coordinates are those of the file.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(try_from = "LightKeys")]
pub(super) struct FileLight {
    position: DVec3,
    /// At the origin.
    light: PunctualLight,
}

/// All keys of all lights. One flat struct, so that messages name the key and its line.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct LightKeys {
    #[serde(rename = "type")]
    kind: Kind,
    #[serde(default, deserialize_with = "present")]
    position: Option<Place>,
    #[serde(default, deserialize_with = "present")]
    direction: Option<Coordinates>,
    #[serde(default, deserialize_with = "present")]
    intensity: Option<Radiance>,
    #[serde(default, deserialize_with = "present")]
    irradiance: Option<Radiance>,
    #[serde(default, deserialize_with = "present")]
    inner_angle: Option<Angle>,
    #[serde(default, deserialize_with = "present")]
    outer_angle: Option<Angle>,
    #[serde(default, deserialize_with = "present")]
    angle: Option<AngularDiameter>,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Kind {
    Point,
    Spot,
    Directional,
}

impl TryFrom<LightKeys> for FileLight {
    type Error = String;

    fn try_from(keys: LightKeys) -> Result<Self, String> {
        let position = keys.position.map_or(DVec3::ZERO, |Place(position)| position);
        let light = match keys.kind {
            Kind::Point => {
                let of_others = ["direction", "irradiance", "inner_angle", "outer_angle", "angle"];
                keys.refuse("a point", &of_others)?;
                keys.need("a point", &["position", "intensity"])?;
                PunctualLight::Point { position: Vec3::ZERO, intensity: keys.colour() }
            }
            Kind::Spot => {
                keys.refuse("a spot", &["irradiance", "angle"])?;
                keys.need("a spot", &["position", "direction", "intensity", "outer_angle"])?;
                let degrees = |angle: Option<Angle>| angle.map_or(0.0, |Angle(angle)| angle);
                PunctualLight::Spot {
                    position: Vec3::ZERO,
                    direction: keys.towards(),
                    intensity: keys.colour(),
                    inner_angle: degrees(keys.inner_angle),
                    outer_angle: degrees(keys.outer_angle),
                }
            }
            Kind::Directional => {
                let of_others = ["position", "intensity", "inner_angle", "outer_angle"];
                keys.refuse("a directional", &of_others)?;
                keys.need("a directional", &["direction", "irradiance"])?;
                PunctualLight::Directional {
                    direction: keys.towards(),
                    irradiance: keys.colour(),
                    angle: keys.angle.map_or(0.0, |AngularDiameter(angle)| angle),
                }
            }
        };
        light.check().map_err(|(key, what)| format!("{key} {what}"))?;
        Ok(Self { position, light })
    }
}

impl LightKeys {
    fn colour(&self) -> Vec3 {
        self.intensity.or(self.irradiance).map_or(Vec3::ZERO, |Radiance(colour)| colour)
    }

    fn towards(&self) -> Vec3 {
        self.direction.map_or(Vec3::ZERO, |Coordinates(direction)| direction.as_vec3())
    }

    fn refuse(&self, kind: &str, keys: &[&str]) -> Result<(), String> {
        match keys.iter().find(|key| self.has(key)) {
            Some(key) => Err(format!("{kind} light has no key `{key}`")),
            None => Ok(()),
        }
    }

    fn need(&self, kind: &str, keys: &[&str]) -> Result<(), String> {
        match keys.iter().find(|key| !self.has(key)) {
            Some(key) => Err(format!("{kind} light needs the key `{key}`")),
            None => Ok(()),
        }
    }

    fn has(&self, key: &str) -> bool {
        match key {
            "position" => self.position.is_some(),
            "direction" => self.direction.is_some(),
            "intensity" => self.intensity.is_some(),
            "irradiance" => self.irradiance.is_some(),
            "inner_angle" => self.inner_angle.is_some(),
            "outer_angle" => self.outer_angle.is_some(),
            _ => self.angle.is_some(),
        }
    }
}

impl FileLight {
    /// The light where `origin` is the origin; the error says what is then wrong with it.
    pub(super) fn seen_from(&self, origin: DVec3) -> Result<PunctualLight, String> {
        let mut light = self.light;
        if let PunctualLight::Point { position, .. } | PunctualLight::Spot { position, .. } =
            &mut light
        {
            let at = bounds::coordinates(&(self.position - origin).to_array());
            *position = at.map_err(|what| format!("position {what}"))?.as_vec3();
        }
        Ok(light)
    }
}
