//! What lies over a surface and what it encloses: coats, sheen, volumes.

use super::described::Reader;
use super::{ALPHA, ROUGHNESS};
use crate::scene::bounds;
use crate::scene::error::SceneError;
use crate::scene::material::{Anisotropy, Attenuation, Principled};
use crate::scene::rule;
use crate::scene::summary::Fate;
use glam::Vec3;
use gltf::json::Value;
use gltf::json::material::{Material, NormalTexture};
use gltf::json::texture::Info;
use serde::Deserialize;

const CLEARCOAT: &str = "KHR_materials_clearcoat";
const SHEEN: &str = "KHR_materials_sheen";
const VOLUME: &str = "KHR_materials_volume";
const ANISOTROPY: &str = "KHR_materials_anisotropy";
const THICKNESS: Fate =
    Fate::Judged("light goes as far through a body as its mesh is thick, whatever this says: ");

#[derive(Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
struct Clearcoat {
    clearcoat_factor: f32,
    clearcoat_texture: Option<Info>,
    clearcoat_roughness_factor: f32,
    clearcoat_roughness_texture: Option<Info>,
    clearcoat_normal_texture: Option<NormalTexture>,
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
    anisotropy_texture: Option<Info>,
}

#[derive(Deserialize)]
#[serde(default, rename_all = "camelCase")]
struct Volume {
    thickness_factor: f32,
    thickness_texture: Option<Value>,
    attenuation_distance: Option<f64>,
    attenuation_color: [f32; 3],
}

impl Default for Volume {
    fn default() -> Self {
        Self {
            thickness_factor: 0.0,
            thickness_texture: None,
            attenuation_distance: None,
            attenuation_color: [1.0; 3],
        }
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
            self.grain(&grain, plain)?;
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
        let factor = coat.clearcoat_texture.as_ref();
        self.slot(factor, &[rule::Slot::Coat(0)], "clearcoatTexture")?;
        let roughness = coat.clearcoat_roughness_texture.as_ref();
        let says = [rule::Slot::CoatRoughness(ROUGHNESS)];
        self.slot(roughness, &says, "clearcoatRoughnessTexture")?;
        let normal = coat.clearcoat_normal_texture.as_ref();
        self.normal_map(normal, rule::Slot::CoatNormal, "clearcoatNormalTexture")
    }

    fn sheen(&mut self, sheen: &Sheen, plain: &mut Principled) -> Result<(), SceneError> {
        plain.sheen = self.colour("sheenColorFactor", sheen.sheen_color_factor);
        plain.sheen_roughness = self.share("sheenRoughnessFactor", sheen.sheen_roughness_factor);
        if plain.sheen == Vec3::ZERO {
            return Ok(());
        }
        let colour = sheen.sheen_color_texture.as_ref();
        self.slot(colour, &[rule::Slot::Sheen], "sheenColorTexture")?;
        let roughness = sheen.sheen_roughness_texture.as_ref();
        self.slot(roughness, &[rule::Slot::SheenRoughness(ALPHA)], "sheenRoughnessTexture")
    }

    fn grain(&mut self, grain: &Grain, plain: &mut Principled) -> Result<(), SceneError> {
        let strength = self.share("anisotropyStrength", grain.anisotropy_strength);
        let degrees = f64::from(grain.anisotropy_rotation).to_degrees();
        let rotation = bounds::rotation(degrees).unwrap_or_else(|_| {
            self.note(Fate::Becomes("these are no angles and count as 0: "), "anisotropyRotation");
            0.0
        });
        plain.anisotropy = Anisotropy { strength, rotation };
        if strength > 0.0 {
            let texture = grain.anisotropy_texture.as_ref();
            self.slot(texture, &[rule::Slot::Grain], "anisotropyTexture")?;
        }
        Ok(())
    }

    /// Glass without a volume, or without thickness, is thin.
    fn volume(&mut self, volume: &Volume, plain: &mut Principled) {
        plain.thin_walled = plain.transmission > 0.0 && volume.thickness_factor <= 0.0;
        if plain.transmission > 0.0 && !plain.thin_walled && volume.thickness_texture.is_some() {
            self.note(THICKNESS, "thicknessTexture");
        }
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
