//! What kernels are able to, beyond what every scene needs: they are compiled for what the scene at
//! hand uses, and lack the rest.
//!
//! A branch that is never taken costs a tracing kernel a tenth of its speed all the same, since its
//! code takes registers and cache. So a kernel asks [`Abilities::has`], and the answer is there
//! when it is compiled: on the GPU the word is a specialisation constant, in whose place the host
//! puts the scene's word before the driver sees the kernel; on the CPU it is a constant parameter.

/// `SpecId` of the constant that holds the word, in every kernel that works on a scene; its default
/// is 0.
pub const ABILITIES: u32 = 0;

/// Surfaces have textures.
pub const TEXTURES: u32 = 1 << 0;

/// An environment lights the scene.
pub const ENVIRONMENT: u32 = 1 << 1;

/// Surfaces are [principled](crate::scene::bsdf::principled).
pub const PRINCIPLED: u32 = 1 << 2;

/// The [camera](crate::scene::camera) is no pinhole.
pub const CAMERAS: u32 = 1 << 3;

/// Some [lights](crate::scene::light::punctual) have no surface.
pub const PUNCTUAL: u32 = 1 << 4;

/// Textures say what surfaces emit.
pub const EMISSION_MAPS: u32 = 1 << 5;

/// Pixels have another [filter](crate::film::pixel_filter) than themselves.
pub const PIXEL_FILTERS: u32 = 1 << 6;

/// Principled surfaces have a [cover](crate::scene::bsdf::cover).
pub const COVER: u32 = 1 << 7;

/// Surfaces have holes, see [`crate::scene::bsdf::layers`].
pub const HOLES: u32 = 1 << 8;

/// Bodies absorb light or have priorities, see [`crate::scene::media`].
pub const MEDIA: u32 = 1 << 9;

/// Principled surfaces are [conductors](crate::scene::bsdf::conductor).
pub const CONDUCTORS: u32 = 1 << 10;

/// Shapes have [instances](crate::scene::bvh::instance).
pub const INSTANCES: u32 = 1 << 11;

/// Textures have more than 8 bits a channel, or show whole texels.
pub const WIDE_TEXTURES: u32 = 1 << 12;

/// Vertices have [colours](crate::scene::triangle::VertexColours).
pub const VERTEX_COLOURS: u32 = 1 << 13;

/// Principled surfaces are [anisotropic](crate::scene::bsdf::anisotropic).
pub const ANISOTROPY: u32 = 1 << 14;

/// Lights are chosen by a [tree](crate::scene::light::tree).
pub const LIGHT_TREE: u32 = 1 << 15;

/// Corners have [tangents](crate::scene::triangle::Tangents) of their own.
pub const TANGENTS: u32 = 1 << 16;

/// Textures [lie by themselves](crate::scene::texture): they say where, or there are two sets of
/// texture coordinates.
pub const PLACED_TEXTURES: u32 = 1 << 17;

/// Textures say more of principled surfaces, see [`crate::scene::bsdf::layer_maps`].
pub const LAYER_MAPS: u32 = 1 << 18;

/// Coats have a normal of [their own](crate::scene::bsdf::cover).
pub const COAT_NORMALS: u32 = 1 << 19;

/// Maps bend [normals](crate::scene::normals).
pub const NORMAL_MAPS: u32 = 1 << 20;

/// Surfaces may reflect less than all light at grazing angles, see [`crate::scene::bsdf::layers`].
pub const F90: u32 = 1 << 21;

/// What most scenes use no more than: the CPU has loops for these, and loops for [`ALL`].
pub const BASIC: u32 = TEXTURES;
/// Every ability.
pub const ALL: u32 = u32::MAX;

/// The abilities that a kernel is compiled for: at least those that its scene uses.
pub trait Abilities: Copy + Send + Sync {
    /// Whether `ability` is one of them, a bit.
    fn has(self, ability: u32) -> bool;
}

/// The abilities in a word that a GPU's driver knows when it compiles the kernel.
#[derive(Clone, Copy)]
pub struct Specialised(pub u32);

impl Abilities for Specialised {
    #[inline(always)]
    fn has(self, ability: u32) -> bool {
        self.0 & ability != 0
    }
}

/// The abilities in the word `WORD`.
#[derive(Clone, Copy)]
pub struct Fixed<const WORD: u32>;

impl<const WORD: u32> Abilities for Fixed<WORD> {
    #[inline(always)]
    fn has(self, ability: u32) -> bool {
        WORD & ability != 0
    }
}
