//! The textures of what most principled materials have no textures of: of the cover, of what passes,
//! of what is reflected straight on, and of the grain.
//!
//! Kernels know them by the ability [`LAYER_MAPS`](crate::scene::abilities::LAYER_MAPS).

use super::layers::{Layers, channel, slopes};
use crate::glam::{UVec4, Vec2, Vec3, Vec4};
use crate::memory::access::at;
use crate::memory::device_struct;
use crate::scene::abilities::Abilities;
use crate::scene::texture::{Coordinates, NO_TEXTURE, TextureView};
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

/// Number of the coat's texture in [`LayerMaps::textures`].
pub const COAT: u32 = 0;
/// That of the coat's roughness.
pub const COAT_ROUGHNESS: u32 = 1;
/// That of the sheen's roughness.
pub const SHEEN_ROUGHNESS: u32 = 2;
/// That of the transmission.
pub const TRANSMISSION: u32 = 3;
/// That of the share of light that is reflected at normal incidence.
pub const SPECULAR: u32 = 4;
/// That of the grain: red and green are its direction, blue is its strength.
pub const GRAIN: u32 = 5;
/// That of the sheen's colour.
pub const SHEEN: u32 = 6;
/// That of the colour of light that is reflected at normal incidence.
pub const SPECULAR_COLOUR: u32 = 7;
/// How many there are; those from [`SHEEN`] on are colours.
pub const MAPS: u32 = 8;
/// Bits of [`LayerMaps::channels`] for each number.
pub const CHANNEL_BITS: u32 = 2;

device_struct! {
    /// The textures, each of which is [`NO_TEXTURE`] if there is none. They multiply the numbers of
    /// [`Layers`]. 48 bytes.
    pub struct LayerMaps {
        /// By their numbers.
        pub textures: [u32; MAPS as usize],
        /// Of the coat's normals.
        pub coat_normal: u32,
        /// What the slopes of these are multiplied by.
        pub coat_normal_scale: f32,
        /// Which of its channels, 0 to 3, a texture has that says one number: [`CHANNEL_BITS`] for
        /// each.
        pub channels: u32,
        /// Unused; zero.
        pub pad: u32,
    }
}

impl LayerMaps {
    /// Rows of one.
    pub const ROWS: u32 = 3;
    /// No textures.
    pub const NONE: Self = Self {
        textures: [NO_TEXTURE; MAPS as usize],
        coat_normal: NO_TEXTURE,
        coat_normal_scale: 1.0,
        channels: 0,
        pad: 0,
    };
}

/// Those of one material.
#[derive(Clone, Copy)]
pub struct LayerMapsView<'a> {
    /// The scene's buffer `surfaces`.
    pub rows: &'a [UVec4],
    /// Their first row.
    pub first: u32,
}

impl LayerMapsView<'_> {
    /// The layers at a point, of these texture coordinates, and where the grain heads there.
    pub fn applied<A: Abilities>(
        &self,
        mut layers: Layers,
        textures: &TextureView<'_, A>,
        place: Coordinates,
    ) -> (Layers, Vec2) {
        let mut heading = Vec2::X;
        let channels = self.last_row().z;
        let mut number = 0;
        while number < MAPS {
            let texture = self.texture(number);
            if texture != NO_TEXTURE {
                let says = if number < SHEEN {
                    textures.codes(texture, place)
                } else {
                    textures.reflectance(texture, place).extend(1.0)
                };
                if number == GRAIN {
                    heading = direction(says);
                }
                let bits = channels >> (CHANNEL_BITS * number) & ((1 << CHANNEL_BITS) - 1);
                layers = multiplied(layers, number, channel(says, bits), says.truncate());
            }
            number += 1;
        }
        (layers, heading)
    }

    /// The texture of this number, or [`NO_TEXTURE`].
    fn texture(&self, number: u32) -> u32 {
        let row = at(self.rows, self.first + (number >> 2));
        let column = number & 3;
        if column == 0 {
            row.x
        } else if column == 1 {
            row.y
        } else if column == 2 {
            row.z
        } else {
            row.w
        }
    }

    fn last_row(&self) -> UVec4 {
        at(self.rows, self.first + 2)
    }

    /// The texture of the coat's normals, or [`NO_TEXTURE`].
    pub fn coat_normal(&self) -> u32 {
        self.last_row().x
    }

    /// What that says at a point: its normal in tangent space, of any length.
    pub fn coat_slopes<A: Abilities>(
        &self,
        textures: &TextureView<'_, A>,
        place: Coordinates,
    ) -> Vec3 {
        let row = self.last_row();
        slopes(textures.codes(row.x, place), f32::from_bits(row.y))
    }
}

/// The layers with what the texture of this number says of them: a share, or a colour.
fn multiplied(mut layers: Layers, number: u32, share: f32, colour: Vec3) -> Layers {
    if number == COAT {
        layers.coat *= share;
    } else if number == COAT_ROUGHNESS {
        layers.coat_roughness *= share;
    } else if number == SHEEN_ROUGHNESS {
        layers.sheen_roughness *= share;
    } else if number == TRANSMISSION {
        layers.transmission *= share;
    } else if number == SPECULAR {
        layers.specular *= share;
        layers = layers.with_f90(layers.f90() * share);
    } else if number == GRAIN {
        layers = layers.with_strength(layers.strength() * colour.z);
    } else if number == SHEEN {
        layers.sheen *= colour;
    } else {
        layers.specular *= colour;
    }
    layers
}

/// Where a grain heads by the codes of its texture.
fn direction(codes: Vec4) -> Vec2 {
    let direction = Vec2::new(codes.x, codes.y) * 2.0 - Vec2::ONE;
    let length = direction.length_squared();
    if length > 0.0 { direction / length.sqrt() } else { Vec2::X }
}
