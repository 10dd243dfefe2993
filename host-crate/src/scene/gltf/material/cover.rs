//! What lies over a surface and what it encloses: coats, sheen, volumes.

use super::ALPHA;
use super::described::Reader;
use crate::scene::bounds;
use crate::scene::error::SceneError;
use crate::scene::material::{Anisotropy, Attenuation, Principled};
use crate::scene::summary::Fate;
use glam::Vec3;
use gltf::json::Value;
use gltf::json::material::Material;
use gltf::json::texture::Info;
use serde::Deserialize;

const CLEARCOAT: &str = "KHR_materials_clearcoat";
const SHEEN: &str = "KHR_materials_sheen";
const VOLUME: &str = "KHR_materials_volume";
const ANISOTROPY: &str = "KHR_materials_anisotropy";
const GRAIN_TEXTURE: Fate = Fate::Becomes(
    "what textures say of anisotropy is left out, strength and rotation are those of all of it: ",
);

#[derive(Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
struct Clearcoat {
    clearcoat_factor: f32,
    clearcoat_texture: Option<Info>,
    clearcoat_roughness_factor: f32,
    clearcoat_roughness_texture: Option<Info>,
    clearcoat_normal_texture: Option<Value>,
}

#[derive(Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
struct Sheen {
    sheen_color_factor: [f32; 3],
    sheen_color_texture: Option<Info>,
    sheen_roughness_factor: f32,
    sheen_roughness_texture: Option<Info>,
}

#[derive(Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
struct Grain {
    anisotropy_strength: f32,
    /// Radians.
    anisotropy_rotation: f32,
    anisotropy_texture: Option<Value>,
}

#[derive(Deserialize)]
#[serde(default, rename_all = "camelCase")]
struct Volume {
    thickness_factor: f32,
    attenuation_distance: Option<f64>,
    attenuation_color: [f32; 3],
}

impl Default for Volume {
    fn default() -> Self {
        Self { thickness_factor: 0.0, attenuation_distance: None, attenuation_color: [1.0; 3] }
    }
}

impl Reader<'_, '_> {
    /// What the file says of a coat, of sheen, of a grain, and of the body behind the surface.
    pub(super) fn cover(
        &mut self,
        json: &Material,
        plain: &mut Principled,
    ) -> Result<(), SceneError> {
        if let Some(coat) = self.extension::<Clearcoat>(json, CLEARCOAT)? {
            self.clearcoat(&coat, plain)?;
        }
        if let Some(sheen) = self.extension::<Sheen>(json, SHEEN)? {
            self.sheen(&sheen, plain)?;
        }
        if let Some(grain) = self.extension::<Grain>(json, ANISOTROPY)? {
            self.grain(&grain, plain);
        }
        let volume = self.extension::<Volume>(json, VOLUME)?.unwrap_or_default();
        self.volume(&volume, plain);
        Ok(())
    }

    fn clearcoat(&mut self, coat: &Clearcoat, plain: &mut Principled) -> Result<(), SceneError> {
        plain.coat = self.share("clearcoatFactor", coat.clearcoat_factor);
        plain.coat_roughness =
            self.share("clearcoatRoughnessFactor", coat.clearcoat_roughness_factor);
        if plain.coat == 0.0 {
            return Ok(());
        }
        let roughness = coat.clearcoat_roughness_texture.as_ref();
        plain.coat *= self.mean_code(coat.clearcoat_texture.as_ref(), "clearcoatTexture", 0)?;
        plain.coat_roughness *= self.mean_code(roughness, "clearcoatRoughnessTexture", 1)?;
        if coat.clearcoat_normal_texture.is_some() {
            let what = "a coat follows the corners' normals: ";
            self.note(Fate::Becomes(what), "clearcoatNormalTexture");
        }
        Ok(())
    }

    fn sheen(&mut self, sheen: &Sheen, plain: &mut Principled) -> Result<(), SceneError> {
        plain.sheen = self.colour("sheenColorFactor", sheen.sheen_color_factor);
        plain.sheen_roughness = self.share("sheenRoughnessFactor", sheen.sheen_roughness_factor);
        if plain.sheen == Vec3::ZERO {
            return Ok(());
        }
        plain.sheen *= self.mean(sheen.sheen_color_texture.as_ref(), "sheenColorTexture")?;
        let roughness = sheen.sheen_roughness_texture.as_ref();
        plain.sheen_roughness *= self.mean_code(roughness, "sheenRoughnessTexture", ALPHA)?;
        Ok(())
    }

    fn grain(&mut self, grain: &Grain, plain: &mut Principled) {
        let strength = self.share("anisotropyStrength", grain.anisotropy_strength);
        let degrees = f64::from(grain.anisotropy_rotation).to_degrees();
        let rotation = bounds::rotation(degrees).unwrap_or_else(|_| {
            self.note(Fate::Becomes("these are no angles and count as 0: "), "anisotropyRotation");
            0.0
        });
        plain.anisotropy = Anisotropy { strength, rotation };
        if strength > 0.0 && grain.anisotropy_texture.is_some() {
            self.note(GRAIN_TEXTURE, "anisotropyTexture");
        }
    }

    /// Glass without a volume, or without thickness, is thin.
    fn volume(&mut self, volume: &Volume, plain: &mut Principled) {
        plain.thin_walled = plain.transmission > 0.0 && volume.thickness_factor <= 0.0;
        let Some(distance) = volume.attenuation_distance else { return };
        if volume.attenuation_color == [1.0; 3] {
            return;
        }
        let colour = self.colour("attenuationColor", volume.attenuation_color);
        match bounds::attenuation_distance(distance) {
            Ok(distance) => plain.attenuation = Some(Attenuation { colour, distance }),
            Err(_) => self.note(
                Fate::Becomes("light is absorbed over no distance that is: "),
                "attenuationDistance",
            ),
        }
    }
}
