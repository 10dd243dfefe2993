//! Texture lookup: bilinear, or the nearest texel.
//!
//! All textures lie in one buffer of words: first the [`DECODE_WORDS`] linear values of the 256
//! sRGB codes (as bits of f32), then for each texture its width, its height and its texels, row by
//! row from the top. A texture is named by the index of its width. Above the 16 bits of width and
//! height stands how the texture goes on along that side, [`REPEAT`], [`CLAMP`] or [`MIRROR`];
//! above that of the width, where kernels have [`WIDE_TEXTURES`], what its texels are and whether
//! they are shown whole:
//!
//! ```text
//! BYTES:  one word a texel, 0xAABBGGRR
//! SHORTS: two words a texel, 0xGGGGRRRR 0xAAAABBBB
//! FLOATS: three words a texel, the bits of linear red, green and blue
//! ```
//!
//! A texture that is [`PLACED`], as the word of its height says, looks up its texels at coordinates
//! that it makes of those of the surface, whose first set it takes, or the [`SECOND`]. Its texels
//! may be those of another texture, and so seven words stand before any: the number of the first
//! texel's word, then the bits of `a`, `b`, `c`, `d`, `x`, `y`. It is looked up at `(a u + b v + x,
//! c u + d v + y)`.

use crate::glam::{Vec2, Vec3, Vec4};
use crate::math::elementary::pow;
use crate::math::packed::{LARGEST_SHORT, shorts};
use crate::memory::access::at;
use crate::scene::abilities::{Abilities, PLACED_TEXTURES, WIDE_TEXTURES};
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
/// The texels are codes of 8 bits.
pub const BYTES: u32 = 0;
/// The texels are codes of 16 bits.
pub const SHORTS: u32 = 1 << 18;
/// The texels are linear numbers of any size.
pub const FLOATS: u32 = 2 << 18;
/// The nearest texel is shown, and not a mixture of four.
pub const NEAREST: u32 = 1 << 20;
/// The texture says where it lies; in the word of the height.
pub const PLACED: u32 = 1 << 18;
/// It takes the second set of texture coordinates; in the word of the height.
pub const SECOND: u32 = 1 << 19;
/// Words between the height and the texels of a texture that is [`PLACED`].
pub const PLACEMENT_WORDS: u32 = 7;
/// The bits of a side's length.
const LENGTH: u32 = 0xffff;
/// The bits that say what texels are.
const FORMAT: u32 = 3 << 18;
/// The bits of a side: its length, and how the texture goes on.
const SIDE: u32 = 0x3_ffff;

/// The texture coordinates of a point, `v` upwards.
#[derive(Clone, Copy)]
pub struct Coordinates {
    /// The first set.
    pub first: Vec2,
    /// The second one, where there is one.
    pub second: Vec2,
}

impl Coordinates {
    /// Both sets alike.
    pub fn both(uv: Vec2) -> Self {
        Self { first: uv, second: uv }
    }
}

/// The textures of a scene; see the module's text for the layout.
#[derive(Clone, Copy)]
pub struct TextureView<'a, A> {
    words: &'a [u32],
    abilities: A,
}

impl<'a, A: Abilities> TextureView<'a, A> {
    /// Wraps the buffer.
    pub fn new(words: &'a [u32], abilities: A) -> Self {
        Self { words, abilities }
    }

    /// Linear Rec.709 colour of `texture` at a point; `v = 0` is the bottom edge, texel centres
    /// are at half-integers. It is in [0, 1], but for textures of floats: these have no upper end.
    pub fn sample(&self, texture: u32, place: Coordinates) -> Vec3 {
        let near = self.neighbours(texture, place);
        let (across, format) = (near.across, near.format);
        let upper = self.texel(near.upper_left, format);
        let upper = upper.lerp(self.texel(near.upper_right, format), across);
        let lower = self.texel(near.lower_left, format);
        let lower = lower.lerp(self.texel(near.lower_right, format), across);
        upper.lerp(lower, near.down)
    }

    /// The same as a share of light, in [0, 1]: what is above is 1.
    pub fn reflectance(&self, texture: u32, place: Coordinates) -> Vec3 {
        let colour = self.sample(texture, place);
        if self.abilities.has(WIDE_TEXTURES) { colour.min(Vec3::ONE) } else { colour }
    }

    /// The four channels of `texture` at a point as they are coded, from 0 to 1. Those of floats
    /// stand for themselves, up to 1, and their fourth channel is 1.
    pub fn codes(&self, texture: u32, place: Coordinates) -> Vec4 {
        let near = self.neighbours(texture, place);
        let (across, format) = (near.across, near.format);
        let upper = self.code(near.upper_left, format);
        let upper = upper.lerp(self.code(near.upper_right, format), across);
        let lower = self.code(near.lower_left, format);
        let lower = lower.lerp(self.code(near.lower_right, format), across);
        upper.lerp(lower, near.down)
    }

    fn neighbours(&self, texture: u32, place: Coordinates) -> Neighbours {
        let (mut across, mut down) = (at(self.words, texture), at(self.words, texture + 1));
        let (mut uv, mut first) = (place.first, texture + 2);
        if self.abilities.has(PLACED_TEXTURES) && down & PLACED != 0 {
            uv = self.placed(texture + 3, if down & SECOND != 0 { place.second } else { uv });
            first = at(self.words, texture + 2);
            down &= SIDE;
        }
        let Vec2 { x: u, y: v } = uv;
        let (mut format, mut is_nearest) = (BYTES, false);
        if self.abilities.has(WIDE_TEXTURES) {
            format = across & FORMAT;
            is_nearest = across & NEAREST != 0;
            across &= SIDE;
        }
        let (width, height) = (across & LENGTH, down & LENGTH);
        let x = fold(u, across) * width as f32 - 0.5;
        let y = (1.0 - fold(v, down)) * height as f32 - 0.5;
        let (left, top) = (x.floor(), y.floor());
        let (x0, x1) = (wrap(left, width, across), wrap(left + 1.0, width, across));
        let (y0, y1) = (wrap(top, height, down), wrap(top + 1.0, height, down));
        // The formats are numbered by their words, less one.
        let words = if self.abilities.has(WIDE_TEXTURES) { 1 + (format >> 18) } else { 1 };
        let (x, y) = (x - left, y - top);
        Neighbours {
            upper_left: first + (y0 * width + x0) * words,
            upper_right: first + (y0 * width + x1) * words,
            lower_left: first + (y1 * width + x0) * words,
            lower_right: first + (y1 * width + x1) * words,
            across: if is_nearest { half_up(x) } else { x },
            down: if is_nearest { half_up(y) } else { y },
            format,
        }
    }

    /// Where a texture is looked up whose `a` is word number `first`.
    fn placed(&self, first: u32, uv: Vec2) -> Vec2 {
        Vec2::new(
            self.number(first) * uv.x + self.number(first + 1) * uv.y + self.number(first + 4),
            self.number(first + 2) * uv.x + self.number(first + 3) * uv.y + self.number(first + 5),
        )
    }

    /// The linear colour of the texel whose first word is number `place`.
    fn texel(&self, place: u32, format: u32) -> Vec3 {
        if self.abilities.has(WIDE_TEXTURES) && format == FLOATS {
            return self.floats(place);
        }
        if self.abilities.has(WIDE_TEXTURES) && format == SHORTS {
            let code = self.shorts(place);
            return Vec3::new(linear(code.x), linear(code.y), linear(code.z));
        }
        let code = at(self.words, place);
        Vec3::new(
            self.decode(code & 0xff),
            self.decode(code >> 8 & 0xff),
            self.decode(code >> 16 & 0xff),
        )
    }

    /// The codes of the texel whose first word is number `place`.
    fn code(&self, place: u32, format: u32) -> Vec4 {
        if self.abilities.has(WIDE_TEXTURES) && format == FLOATS {
            return self.floats(place).min(Vec3::ONE).extend(1.0);
        }
        if self.abilities.has(WIDE_TEXTURES) && format == SHORTS {
            return self.shorts(place) * (1.0 / LARGEST_SHORT);
        }
        let code = at(self.words, place);
        let channel = |shift: u32| (code >> shift & 0xff) as f32 * (1.0 / 255.0);
        Vec4::new(channel(0), channel(8), channel(16), channel(24))
    }

    fn floats(&self, place: u32) -> Vec3 {
        Vec3::new(
            f32::from_bits(at(self.words, place)),
            f32::from_bits(at(self.words, place + 1)),
            f32::from_bits(at(self.words, place + 2)),
        )
    }

    /// Four codes of 16 bits.
    fn shorts(&self, place: u32) -> Vec4 {
        shorts(at(self.words, place), at(self.words, place + 1))
    }

    fn decode(&self, srgb: u32) -> f32 {
        self.number(srgb)
    }

    fn number(&self, word: u32) -> f32 {
        f32::from_bits(at(self.words, word))
    }
}

/// The linear value, in [0, 1], of an sRGB code of 16 bits.
fn linear(code: f32) -> f32 {
    if code <= 0.04045 * LARGEST_SHORT {
        code * (1.0 / (12.92 * LARGEST_SHORT))
    } else {
        pow((code * (1.0 / LARGEST_SHORT) + 0.055) * (1.0 / 1.055), 2.4)
    }
}

/// 1 from a half on, below that 0.
fn half_up(fraction: f32) -> f32 {
    if fraction >= 0.5 { 1.0 } else { 0.0 }
}

/// The texels around a point: where they lie in the buffer, how far to go from left to right and
/// down, in [0, 1], and what they are.
struct Neighbours {
    upper_left: u32,
    upper_right: u32,
    lower_left: u32,
    lower_right: u32,
    across: f32,
    down: f32,
    format: u32,
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
