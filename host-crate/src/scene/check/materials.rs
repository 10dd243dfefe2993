//! Whether materials are within their ranges, and their textures there.

use super::super::bounds;
use super::super::description::Scene;
use super::super::material::{Attenuation, Maps, Material, Opacity, Principled, Reflectance};
use super::super::metal::Conductor;
use super::super::texture::{TextureId, Wrap};
use super::{in_range, radiance, values};
use glam::Vec3;

impl Scene {
    pub(super) fn check_material(&self, material: &Material) -> Result<(), String> {
        let share = |name: &str, colour: Vec3| match bounds::reflectance(&values(colour)) {
            Ok(_) => Ok(()),
            Err(what) => Err(format!("{name} {what}")),
        };
        match *material {
            Material::Diffuse { reflectance: Reflectance::Colour(colour) }
            | Material::Mirror { reflectance: colour } => share("reflectance", colour),
            Material::Diffuse { reflectance: Reflectance::Texture(texture) } => {
                in_range("texture", texture.0, self.textures.len(), "textures")
            }
            Material::Dielectric { ior, transmittance, reflectance, attenuation, priority } => {
                check_body(attenuation, priority, true)?;
                bounds::ior(ior.into()).map_err(|what| format!("ior {what}"))?;
                share("transmittance", transmittance)?;
                share("reflectance", reflectance)
            }
            Material::Emissive { radiance: emitted, reflectance } => {
                radiance(emitted).map_err(|what| format!("radiance {what}"))?;
                share("reflectance", reflectance)
            }
            Material::Principled(ref principled) => self.check_principled(principled),
        }
    }

    fn check_principled(&self, material: &Principled) -> Result<(), String> {
        let named = |name: &str, checked: Result<(), String>| {
            checked.map_err(|what| format!("{name} {what}"))
        };
        self.check_maps(material)?;
        let rotation = bounds::rotation(material.anisotropy.rotation.into());
        named("anisotropy.rotation", rotation.map(drop))?;
        named("base_colour", bounds::reflectance(&values(material.base_colour)).map(drop))?;
        let shares = [
            ("anisotropy.strength", material.anisotropy.strength),
            ("metallic", material.metallic),
            ("roughness", material.roughness),
            ("transmission", material.transmission),
            ("f90", material.f90),
            ("coat", material.coat),
            ("coat_roughness", material.coat_roughness),
            ("sheen_roughness", material.sheen_roughness),
        ];
        for (name, value) in shares {
            named(name, bounds::share(value.into()).map(drop))?;
        }
        named("ior", bounds::ior(material.ior.into()).map(drop))?;
        named("specular", bounds::factor(&values(material.specular)).map(drop))?;
        named("sheen", bounds::reflectance(&values(material.sheen)).map(drop))?;
        if let Some(Conductor { eta, k }) = material.conductor {
            named("conductor.eta", bounds::eta(&values(eta)).map(drop))?;
            named("conductor.k", bounds::extinction(&values(k)).map(drop))?;
            let Maps { base_colour, metallic, .. } = material.maps;
            if material.metallic != 1.0 || base_colour.is_some() || metallic.is_some() {
                let what = "conductor must be metal alone, without maps of colour and of metal";
                return Err(what.to_owned());
            }
        }
        let has_body = Material::Principled(*material).body().is_some();
        check_body(material.attenuation, material.priority, has_body)?;
        let (alpha, cutoff) = match material.opacity {
            Opacity::Opaque => (1.0, 0.0),
            Opacity::Mask { alpha, cutoff } => (alpha, cutoff),
            Opacity::Blend { alpha } => (alpha, 0.0),
        };
        named("opacity.alpha", bounds::share(alpha.into()).map(drop))?;
        named("opacity.cutoff", bounds::share(cutoff.into()).map(drop))?;
        if material.opacity != Opacity::Opaque && material.emission != Vec3::ZERO {
            return Err("opacity must be that of an opaque surface, since it emits".to_owned());
        }
        named("emission", radiance(material.emission).map(drop))
    }

    fn check_maps(&self, material: &Principled) -> Result<(), String> {
        for texture in material.maps.textures() {
            in_range("texture", texture.0, self.textures.len(), "textures")?;
        }
        for map in material.maps.shares().into_iter().flatten() {
            in_range("channel", map.channel, 4, "channels")?;
        }
        if let Some(TextureId(map)) = material.maps.emission {
            let brightest = f64::from(self.textures[map as usize].brightest());
            let most = f64::from(material.emission.max_element()) * brightest;
            if most > bounds::MAX_RADIANCE {
                let most_allowed = bounds::MAX_RADIANCE;
                return Err(format!(
                    "emission times that of its texture must be at most {most_allowed:e}, is {most:e}"
                ));
            }
        }
        let normals =
            [("normal", material.maps.normal), ("coat_normal", material.maps.coat_normal)];
        for (name, map) in normals {
            let scale = map.map_or(1.0, |map| map.scale);
            bounds::scale(scale.into()).map_err(|what| format!("{name}.scale {what}"))?;
        }
        if let Some(map) = material.maps.bump {
            bounds::scale(map.height.into()).map_err(|what| format!("bump.height {what}"))?;
            if material.maps.normal.is_some() {
                return Err("has maps of normals and of heights; it may have one of them".into());
            }
            if self.textures[map.texture.0 as usize].wrap.contains(&Wrap::Mirror) {
                return Err(
                    "bump.texture runs back beyond its edges; it may repeat or clamp".into()
                );
            }
        }
        Ok(())
    }
}

fn check_body(
    attenuation: Option<Attenuation>,
    priority: Option<i32>,
    has_body: bool,
) -> Result<(), String> {
    if let Some(Attenuation { colour, distance }) = attenuation {
        bounds::reflectance(&values(colour)).map_err(|w| format!("attenuation.colour {w}"))?;
        bounds::attenuation_distance(distance.into())
            .map_err(|what| format!("attenuation.distance {what}"))?;
    }
    if let Some(priority) = priority {
        bounds::priority(priority.into()).map_err(|what| format!("priority {what}"))?;
        if !has_body {
            return Err("priority is that of a body: of what light enters and has no holes".into());
        }
    }
    Ok(())
}
