//! Whether textures have the texels that they say, and fit together.

use super::super::bounds::{MAX_COORDINATE, MAX_TEXELS, MAX_TEXTURE_SIDE};
use super::super::description::Scene;
use super::super::texture::{Texels, Texture};
use super::{InvalidScene, at, radiance};
use glam::Vec3;
use std::collections::HashSet;
use std::sync::Arc;

impl Scene {
    pub(super) fn check_textures(&self) -> Result<(), InvalidScene> {
        // They share a buffer.
        let mut texels = self.environment.as_ref().map_or(0, |e| e.texels.len());
        let mut shared = HashSet::new();
        for (index, texture) in self.textures.iter().enumerate() {
            check_texture(texture).map_err(at(&format!("textures[{index}]")))?;
            if !texture.is_placed() || shared.insert(Arc::as_ptr(&texture.texels)) {
                texels += texture.texels.words();
            }
        }
        // Each becomes a map of normals.
        let bumps = self.materials.iter().filter_map(|m| m.principled()?.maps.bump);
        let sizes = bumps.filter_map(|map| self.textures.get(map.texture.0 as usize));
        texels += sizes.map(|texture| 2 * texture.texels.len()).sum::<usize>();
        if texels > MAX_TEXELS {
            let what = format!(
                "have {texels} texels of 4 bytes together, but a scene has at most {MAX_TEXELS}"
            );
            return Err(at("textures")(what));
        }
        Ok(())
    }
}

fn check_texture(texture: &Texture) -> Result<(), String> {
    let Texture { width, height, texels, wrap: _, filter: _, placement } = texture;
    if [width, height].iter().any(|side| !(1..=MAX_TEXTURE_SIDE).contains(side)) {
        return Err(format!(
            "width and height must be from 1 to {MAX_TEXTURE_SIDE} texels, are {width} and {height}"
        ));
    }
    let wanted = *width as usize * *height as usize;
    if texels.len() != wanted {
        return Err(format!("{width}x{height} texels are {wanted}, not {}", texels.len()));
    }
    let is_fine = |number: f32| f64::from(number.abs()) <= MAX_COORDINATE;
    if !placement.numbers().into_iter().all(is_fine) {
        return Err(format!(
            "placement must have numbers from -{MAX_COORDINATE} to {MAX_COORDINATE}"
        ));
    }
    if let Texels::Floats(texels) = &**texels {
        for (index, texel) in texels.iter().enumerate() {
            radiance(Vec3::from(*texel)).map_err(|what| format!("texels[{index}] {what}"))?;
        }
    }
    Ok(())
}
