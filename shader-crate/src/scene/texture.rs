//! Bilinear, repeating texture lookup.
//!
//! All textures lie in one buffer of words: first the [`DECODE_WORDS`] linear values of the 256
//! sRGB codes (as bits of f32), then for each texture its width, its height and its texels, row by
//! row from the top, 0xAABBGGRR. A texture is named by the index of its width.

use crate::glam::{Vec3, Vec4};
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
        let near = self.neighbours(texture, u, v);
        let upper = self.texel(near.upper_left).lerp(self.texel(near.upper_right), near.across);
        let lower = self.texel(near.lower_left).lerp(self.texel(near.lower_right), near.across);
        upper.lerp(lower, near.down)
    }

    /// The four channels of `texture` at `(u, v)` as they are coded, 0 to 255 as 0 to 1.
    pub fn codes(&self, texture: u32, u: f32, v: f32) -> Vec4 {
        let near = self.neighbours(texture, u, v);
        let upper = self.code(near.upper_left).lerp(self.code(near.upper_right), near.across);
        let lower = self.code(near.lower_left).lerp(self.code(near.lower_right), near.across);
        upper.lerp(lower, near.down)
    }

    fn neighbours(&self, texture: u32, u: f32, v: f32) -> Neighbours {
        let (width, height) = (at(self.words, texture), at(self.words, texture + 1));
        let x = (u - u.floor()) * width as f32 - 0.5;
        let y = (1.0 - (v - v.floor())) * height as f32 - 0.5;
        let (left, top) = (x.floor(), y.floor());
        let (x0, x1) = (wrap(left, width), wrap(left + 1.0, width));
        let (y0, y1) = (wrap(top, height), wrap(top + 1.0, height));
        let first = texture + 2;
        Neighbours {
            upper_left: first + y0 * width + x0,
            upper_right: first + y0 * width + x1,
            lower_left: first + y1 * width + x0,
            lower_right: first + y1 * width + x1,
            across: x - left,
            down: y - top,
        }
    }

    fn texel(&self, index: u32) -> Vec3 {
        let code = at(self.words, index);
        Vec3::new(
            self.decode(code & 0xff),
            self.decode(code >> 8 & 0xff),
            self.decode(code >> 16 & 0xff),
        )
    }

    fn code(&self, index: u32) -> Vec4 {
        let code = at(self.words, index);
        let channel = |shift: u32| (code >> shift & 0xff) as f32 * (1.0 / 255.0);
        Vec4::new(channel(0), channel(8), channel(16), channel(24))
    }

    fn decode(&self, srgb: u32) -> f32 {
        f32::from_bits(at(self.words, srgb))
    }
}

/// The texels around a point: where they lie in the buffer, and how far to go from left to right
/// and down, in [0, 1].
struct Neighbours {
    upper_left: u32,
    upper_right: u32,
    lower_left: u32,
    lower_right: u32,
    across: f32,
    down: f32,
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
