//! Bilinear texture lookup.
//!
//! All textures lie in one buffer of words: first the [`DECODE_WORDS`] linear values of the 256
//! sRGB codes (as bits of f32), then for each texture its width, its height and its texels, row by
//! row from the top, 0xAABBGGRR. A texture is named by the index of its width. Above the 16 bits of
//! width and height stands how the texture goes on along that side, [`REPEAT`], [`CLAMP`] or
//! [`MIRROR`].

use crate::glam::{Vec3, Vec4};
use crate::memory::access::at;
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

/// Words of the sRGB table that starts the buffer.
pub const DECODE_WORDS: u32 = 256;
/// The texture index of a surface that has none.
pub const NO_TEXTURE: u32 = u32::MAX;

/// Beyond its edge a texture begins again.
pub const REPEAT: u32 = 0;
/// Beyond its edge a texture goes on with its outermost texels.
pub const CLAMP: u32 = 1 << 16;
/// Beyond its edge a texture runs back, and forth again.
pub const MIRROR: u32 = 2 << 16;
/// The bits of a side's length.
const LENGTH: u32 = 0xffff;

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
        let (across, down) = (at(self.words, texture), at(self.words, texture + 1));
        let (width, height) = (across & LENGTH, down & LENGTH);
        let x = fold(u, across) * width as f32 - 0.5;
        let y = (1.0 - fold(v, down)) * height as f32 - 0.5;
        let (left, top) = (x.floor(), y.floor());
        let (x0, x1) = (wrap(left, width, across), wrap(left + 1.0, width, across));
        let (y0, y1) = (wrap(top, height, down), wrap(top + 1.0, height, down));
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

/// The coordinate within the texture, in [0, 1], that is looked up instead of any other; `side` is
/// the word of its width or height.
fn fold(coordinate: f32, side: u32) -> f32 {
    if side < CLAMP {
        coordinate - coordinate.floor()
    } else if side < MIRROR {
        coordinate.clamp(0.0, 1.0)
    } else {
        let back_and_forth = coordinate * 0.5;
        1.0 - (1.0 - 2.0 * (back_and_forth - back_and_forth.floor())).abs()
    }
}

/// The texel column (or row) of an integral coordinate in [-1, size]. Where a texture runs back,
/// the texel beyond its edge is the one before it.
fn wrap(coordinate: f32, size: u32, side: u32) -> u32 {
    let last = size - 1;
    let repeats = side < CLAMP;
    if coordinate < 0.0 {
        if repeats { last } else { 0 }
    } else {
        let index = coordinate as u32;
        if index < size {
            index
        } else if repeats {
            0
        } else {
            last
        }
    }
}
