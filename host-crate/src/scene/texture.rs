//! Pictures on surfaces.

use crate::color::srgb_decode;
use glam::{DVec3, Vec3};

/// Names a texture of a scene: its index in [`Scene::textures`](super::Scene::textures).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct TextureId(pub u32);

/// A picture of reflectances, which repeats in both directions.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Texture {
    /// Width in texels, from 1 to 16384.
    pub width: u32,
    /// Height in texels, from 1 to 16384.
    pub height: u32,
    /// Red, green, blue (sRGB) and a fourth value that has no effect, for each texel, row by row
    /// from the top: `width * height` of them.
    pub texels: Vec<[u8; 4]>,
}

impl Texture {
    /// The mean of its reflectances, linear Rec.709.
    pub fn mean(&self) -> Vec3 {
        let linear: [f64; 256] = std::array::from_fn(|code| srgb_decode(code as f64 / 255.0));
        let sum: DVec3 = self
            .texels
            .iter()
            .map(|&[red, green, blue, _]| {
                DVec3::from([red, green, blue].map(|c| linear[usize::from(c)]))
            })
            .sum();
        (sum / self.texels.len() as f64).as_vec3()
    }

    /// The mean of one of its channels, 0 to 3, whose codes 0 to 255 stand for 0 to 1.
    pub(super) fn mean_of(&self, channel: u32) -> f32 {
        let code = |texel: &[u8; 4]| u64::from(texel[channel as usize]);
        let sum: u64 = self.texels.iter().map(code).sum();
        (sum as f64 / (255.0 * self.texels.len() as f64)) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_is_that_of_light() {
        let texels = vec![[255, 0, 0, 255], [0, 0, 255, 0]];
        let mean = Texture { width: 2, height: 1, texels }.mean();
        assert_eq!(mean, Vec3::new(0.5, 0.0, 0.5));
        let grey = Texture { width: 1, height: 1, texels: vec![[128; 4]] }.mean();
        assert!((grey - 0.215_860_5).abs().max_element() < 1e-6, "{grey}");
    }
}
