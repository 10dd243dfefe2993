//! What a principled material has beside [`Material`](super::Material): its record in memory, and
//! what textures make of that at a point.

use crate::glam::{UVec4, Vec2, Vec3, Vec4};
use crate::math::angles::sin_cos_of_turns;
use crate::math::packed::{NO_TANGENT, Tangent};
use crate::memory::device_struct;
use crate::memory::rows::{float, vector};
use crate::scene::abilities::{Abilities, LAYER_MAPS};
use crate::scene::texture::{Coordinates, NO_TEXTURE, TextureView};
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

/// [`Layers::flags`]: what passes does not enter a body.
pub const THIN: u32 = 1 << 0;
/// [`Layers::flags`]: what is less opaque than [`Layers::cutoff`] is a hole.
pub const MASK: u32 = 1 << 1;
/// [`Layers::flags`]: what is not opaque is a hole by chance.
pub const BLEND: u32 = 1 << 2;

/// See [`Layers::flags`].
pub const STRENGTH_BIT: u32 = 4;
/// See [`Layers::flags`].
pub const ROTATION_BIT: u32 = 18;
/// See [`Layers::flags`].
pub const GRAIN_STEPS: u32 = 0x3fff;

/// See [`Layers::channels`].
pub const F90_BIT: u32 = 16;
/// See [`Layers::channels`].
pub const F90_STEPS: u32 = 0xffff;

device_struct! {
    /// The record. 96 bytes.
    pub struct Layers {
        /// Share of reflection at normal incidence that a dielectric surface has, as a factor of
        /// what its index of refraction says, linear Rec.709.
        pub specular: Vec3,
        /// Share of metal, in [0, 1].
        pub metallic: f32,
        /// Roughness, in [0, 1]; see [`Ggx::of_roughness`](super::ggx::Ggx::of_roughness).
        pub roughness: f32,
        /// Share of light that the base lets pass rather than reflects diffusely, in [0, 1].
        pub transmission: f32,
        /// The texture that multiplies the roughness, or
        /// [`NO_TEXTURE`].
        pub roughness_map: u32,
        /// The texture that multiplies the share of metal, or [`NO_TEXTURE`].
        pub metallic_map: u32,
        /// The texture of normals, or [`NO_TEXTURE`].
        pub normal_map: u32,
        /// What that texture's slopes are multiplied by.
        pub normal_scale: f32,
        /// Which of its texture's channels, 0 to 3, the roughness has, and, 8 bits further, the
        /// share of metal; from bit [`F90_BIT`] on the share of light that a dielectric surface
        /// reflects at grazing angles, 0 to [`F90_STEPS`] for 0 to 1.
        pub channels: u32,
        /// Rows from the albedos of surfaces to those of the boundary, where light passes.
        pub boundary_albedos: u32,
        /// Colour of the sheen, linear Rec.709 in [0, 1].
        pub sheen: Vec3,
        /// Roughness of the sheen, in [0, 1]; see [`super::sheen`].
        pub sheen_roughness: f32,
        /// Share of the surface that has a coat, in [0, 1].
        pub coat: f32,
        /// Roughness of the coat, in [0, 1].
        pub coat_roughness: f32,
        /// Rows from the albedos of surfaces to those of sheen, where there is any.
        pub sheen_albedos: u32,
        /// [`THIN`], [`MASK`], [`BLEND`], or none; from bit [`STRENGTH_BIT`] on how anisotropic it
        /// is, 0 to [`GRAIN_STEPS`] for 0 to 1, and from bit [`ROTATION_BIT`] on how its grain is
        /// turned, so many steps of a whole turn.
        pub flags: u32,
        /// Opacity, in [0, 1], which the alpha of the reflectance's texture multiplies.
        pub alpha: f32,
        /// The least opacity of what is no hole, in [0, 1].
        pub cutoff: f32,
        /// The texture that multiplies the emission, or [`NO_TEXTURE`].
        pub emission_map: u32,
        /// Rows from the albedos of surfaces to the [metal](super::conductor), whose reflectance at
        /// normal incidence is the base's colour; 0 where that colour is all that is known.
        pub conductor: u32,
    }
}

impl Layers {
    /// Rows of one.
    pub const ROWS: u32 = 6;
    /// Those of other materials.
    pub const NONE: Self = Self {
        specular: Vec3::ONE,
        metallic: 0.0,
        roughness: 0.0,
        transmission: 0.0,
        roughness_map: NO_TEXTURE,
        metallic_map: NO_TEXTURE,
        normal_map: NO_TEXTURE,
        normal_scale: 1.0,
        channels: 0,
        boundary_albedos: 0,
        sheen: Vec3::ZERO,
        sheen_roughness: 0.0,
        coat: 0.0,
        coat_roughness: 0.0,
        sheen_albedos: 0,
        flags: 0,
        alpha: 1.0,
        cutoff: 0.0,
        emission_map: NO_TEXTURE,
        conductor: 0,
    };

    /// Unpacks the six rows, which are the struct's memory.
    pub fn from_rows(rows: [UVec4; 6]) -> Self {
        Self {
            specular: vector(rows[0]),
            metallic: float(rows[0]),
            roughness: f32::from_bits(rows[1].x),
            transmission: f32::from_bits(rows[1].y),
            roughness_map: rows[1].z,
            metallic_map: rows[1].w,
            normal_map: rows[2].x,
            normal_scale: f32::from_bits(rows[2].y),
            channels: rows[2].z,
            boundary_albedos: rows[2].w,
            sheen: vector(rows[3]),
            sheen_roughness: float(rows[3]),
            coat: f32::from_bits(rows[4].x),
            coat_roughness: f32::from_bits(rows[4].y),
            sheen_albedos: rows[4].z,
            flags: rows[4].w,
            alpha: f32::from_bits(rows[5].x),
            cutoff: f32::from_bits(rows[5].y),
            emission_map: rows[5].z,
            conductor: rows[5].w,
        }
    }

    /// Whether what passes does not enter a body.
    pub fn is_thin(&self) -> bool {
        self.flags & THIN != 0
    }

    /// How anisotropic it is, in [0, 1].
    pub fn strength(&self) -> f32 {
        (self.flags >> STRENGTH_BIT & GRAIN_STEPS) as f32 * (1.0 / GRAIN_STEPS as f32)
    }

    /// The layers with another [`Self::strength`], in [0, 1].
    pub fn with_strength(mut self, strength: f32) -> Self {
        let steps = (strength * GRAIN_STEPS as f32 + 0.5) as u32;
        self.flags = self.flags & !(GRAIN_STEPS << STRENGTH_BIT) | steps << STRENGTH_BIT;
        self
    }

    /// The share of light that a dielectric surface reflects at grazing angles, in [0, 1].
    pub fn f90(&self) -> f32 {
        (self.channels >> F90_BIT) as f32 * (1.0 / F90_STEPS as f32)
    }

    /// The layers with another [`Self::f90`], in [0, 1].
    pub fn with_f90(mut self, f90: f32) -> Self {
        let steps = (f90 * F90_STEPS as f32 + 0.5) as u32;
        self.channels = self.channels & !(F90_STEPS << F90_BIT) | steps << F90_BIT;
        self
    }

    /// The direction along which it is rougher than across: unit length, across the `normal`; zero
    /// where there is none. `tangent` is a packed one of the triangle; a texture turns that to
    /// `heading`, of unit length, in the basis of tangent and bitangent.
    pub fn grain<A: Abilities>(
        &self,
        tangent: u32,
        heading: Vec2,
        normal: Vec3,
        abilities: A,
    ) -> Vec3 {
        if self.flags >> STRENGTH_BIT & GRAIN_STEPS == 0 || tangent == NO_TANGENT {
            return Vec3::ZERO;
        }
        let Tangent { direction, is_mirrored } = Tangent::unpack(tangent);
        let along = direction - normal * normal.dot(direction);
        let length = along.length_squared();
        if length <= 0.0 {
            return Vec3::ZERO;
        }
        let along = along / length.sqrt();
        let across = normal.cross(along);
        let across = if is_mirrored { -across } else { across };
        let turns = (self.flags >> ROTATION_BIT) as f32 * (1.0 / GRAIN_STEPS as f32);
        let (sine, cosine) = sin_cos_of_turns(turns);
        if abilities.has(LAYER_MAPS) {
            let x = heading.x * cosine - heading.y * sine;
            let y = heading.x * sine + heading.y * cosine;
            return (along * x + across * y).normalize();
        }
        (along * cosine + across * sine).normalize()
    }

    /// Whether it may have holes.
    pub fn has_holes(&self) -> bool {
        self.flags & (MASK | BLEND) != 0
    }

    /// Whether there is a hole where the opacity is `alpha`, in [0, 1], by a number of chance in
    /// [0, 1).
    pub fn is_hole(&self, alpha: f32, chance: f32) -> bool {
        if self.flags & MASK != 0 { alpha < self.cutoff } else { alpha <= chance }
    }

    /// The layers at a point, of these texture coordinates.
    pub fn textured<A: Abilities>(
        mut self,
        textures: &TextureView<'_, A>,
        place: Coordinates,
    ) -> Self {
        if self.roughness_map != NO_TEXTURE {
            let codes = textures.codes(self.roughness_map, place);
            self.roughness *= channel(codes, self.channels & 0xff);
        }
        if self.metallic_map != NO_TEXTURE {
            let codes = textures.codes(self.metallic_map, place);
            self.metallic *= channel(codes, self.channels >> 8 & 0xff);
        }
        self
    }

    /// What the map of normals says at a point, of these texture coordinates: its normal in tangent
    /// space, of any length.
    pub fn slopes<A: Abilities>(&self, textures: &TextureView<'_, A>, place: Coordinates) -> Vec3 {
        slopes(textures.codes(self.normal_map, place), self.normal_scale)
    }
}

/// The normal in tangent space, of any length, of the codes of a map of normals whose slopes are
/// multiplied by `scale`.
pub(super) fn slopes(codes: Vec4, scale: f32) -> Vec3 {
    let normal = Vec3::new(codes.x, codes.y, codes.z) * 2.0 - Vec3::ONE;
    Vec3::new(normal.x * scale, normal.y * scale, normal.z)
}

/// The channel of this number.
pub(super) fn channel(codes: Vec4, number: u32) -> f32 {
    if number == 0 {
        codes.x
    } else if number == 1 {
        codes.y
    } else if number == 2 {
        codes.z
    } else {
        codes.w
    }
}
