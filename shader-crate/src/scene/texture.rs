//! Bilinear, repeating texture lookup.
//!
//! All textures lie in one buffer of words: first the [`DECODE_WORDS`] linear values of the 256
//! sRGB codes (as bits of f32), then for each texture its width, its height and its texels, row by
//! row from the top, 0xAABBGGRR. A texture is named by the index of its width.

use crate::glam::Vec3;
use crate::memory::access::at;
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

/// Words of the sRGB table that starts the buffer.
pub const DECODE_WORDS: u32 = 256;
/// The texture index of a surface that has none.
pub const NO_TEXTURE: u32 = u32::MAX;

/// The textures of a scene; see the module's text for the layout.
#[derive(Clone, Copy)]
pub struct TextureView<'a> {
    words: &'a [u32],
}

impl<'a> TextureView<'a> {
    /// Wraps the buffer.
    pub fn new(words: &'a [u32]) -> Self {
        Self { words }
    }

    /// Linear Rec.709 reflectance of `texture` at `(u, v)`; `v = 0` is the bottom edge, texel
    /// centres are at half-integers.
    pub fn sample(&self, texture: u32, u: f32, v: f32) -> Vec3 {
        let (width, height) = (at(self.words, texture), at(self.words, texture + 1));
        let x = (u - u.floor()) * width as f32 - 0.5;
        let y = (1.0 - (v - v.floor())) * height as f32 - 0.5;
        let (left, top) = (x.floor(), y.floor());
        let (fx, fy) = (x - left, y - top);
        let (x0, x1) = (wrap(left, width), wrap(left + 1.0, width));
        let (y0, y1) = (wrap(top, height), wrap(top + 1.0, height));
        let first = texture + 2;
        let upper =
            self.texel(first + y0 * width + x0).lerp(self.texel(first + y0 * width + x1), fx);
        let lower =
            self.texel(first + y1 * width + x0).lerp(self.texel(first + y1 * width + x1), fx);
        upper.lerp(lower, fy)
    }

    fn texel(&self, index: u32) -> Vec3 {
        let code = at(self.words, index);
        Vec3::new(
            self.decode(code & 0xff),
            self.decode(code >> 8 & 0xff),
            self.decode(code >> 16 & 0xff),
        )
    }

    fn decode(&self, srgb: u32) -> f32 {
        f32::from_bits(at(self.words, srgb))
    }
}

/// The texel column (or row) of an integral coordinate in [-1, size], repeated.
fn wrap(coordinate: f32, size: u32) -> u32 {
    if coordinate < 0.0 {
        size - 1
    } else {
        let index = coordinate as u32;
        if index >= size { 0 } else { index }
    }
}
