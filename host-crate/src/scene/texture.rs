//! Pictures on surfaces.

use crate::color::srgb_decode;
use glam::{DVec3, Vec3};

/// Names a texture of a scene: its index in [`Scene::textures`](super::Scene::textures).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct TextureId(pub u32);

/// How a texture goes on beyond its edges.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Wrap {
    /// It begins again.
    #[default]
    Repeat,
    /// Its outermost texels go on.
    Clamp,
    /// It runs back, and forth again.
    Mirror,
}

/// A picture on a surface.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Texture {
    /// Width in texels, from 1 to 16384.
    pub width: u32,
    /// Height in texels, from 1 to 16384.
    pub height: u32,
    /// Red, green, blue and a fourth channel for each texel, row by row from the top: `width *
    /// height` of them. What they stand for is up to who looks them up: colours are sRGB, and a
    /// fourth channel has no effect on them.
    pub texels: Vec<[u8; 4]>,
    /// How it goes on beyond its left and right edges, and beyond its upper and lower ones.
    pub wrap: [Wrap; 2],
}

impl Texture {
    /// A texture that repeats in both directions; see the fields.
    pub fn new(width: u32, height: u32, texels: Vec<[u8; 4]>) -> Self {
        Self { width, height, texels, wrap: [Wrap::Repeat; 2] }
    }

    /// The mean of a channel (red, green, blue or alpha: 0 to 3), whose codes 0 to 255 stand for 0
    /// to 1.
    pub fn mean_code(&self, channel: usize) -> f32 {
        let sum: u64 = self.texels.iter().map(|texel| u64::from(texel[channel])).sum();
        (sum as f64 / (255.0 * self.texels.len() as f64)) as f32
    }

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
        let mean = Texture::new(2, 1, texels).mean();
        assert_eq!(mean, Vec3::new(0.5, 0.0, 0.5));
        let grey = Texture::new(1, 1, vec![[128; 4]]).mean();
        assert!((grey - 0.215_860_5).abs().max_element() < 1e-6, "{grey}");
    }
}
