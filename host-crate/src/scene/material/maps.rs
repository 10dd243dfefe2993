//! The textures of what surfaces are made of.

use crate::scene::texture::TextureId;

/// The textures of a principled material. What a texture says is multiplied by the number that the
/// material has without it. All meshes of a material with any texture have texture coordinates.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Maps {
    /// Of the base's colour, as sRGB.
    pub base_colour: Option<TextureId>,
    /// Of the roughness.
    pub roughness: Option<Channel>,
    /// Of the share of metal.
    pub metallic: Option<Channel>,
    /// Of shading normals.
    pub normal: Option<NormalMap>,
    /// Of heights, in place of normals.
    pub bump: Option<BumpMap>,
    /// Of the emission, as sRGB.
    pub emission: Option<TextureId>,
    /// Of the coat.
    pub coat: Option<Channel>,
    /// Of the coat's roughness.
    pub coat_roughness: Option<Channel>,
    /// Of the coat's normals. Those of what is below (`normal`, `bump`) do not bend the coat.
    pub coat_normal: Option<NormalMap>,
    /// Of the sheen's colour, as sRGB.
    pub sheen: Option<TextureId>,
    /// Of the sheen's roughness.
    pub sheen_roughness: Option<Channel>,
    /// Of the share of light that passes.
    pub transmission: Option<Channel>,
    /// Of `specular` and of `f90`, a share.
    pub specular: Option<Channel>,
    /// Of `specular`, a colour, as sRGB.
    pub specular_colour: Option<TextureId>,
    /// Of the anisotropy: red and green are the direction of the grain in the tangent space of
    /// texture coordinates, codes 0 to 255 standing for -1 to 1, which its rotation turns; blue
    /// multiplies its strength.
    pub anisotropy: Option<TextureId>,
}

/// One channel of a texture, whose codes 0 to 255 stand for 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Channel {
    /// The texture.
    pub texture: TextureId,
    /// Red, green, blue or alpha: 0 to 3.
    pub channel: u32,
}

/// A texture of normals in the tangent space of texture coordinates: red along `u`, green along
/// `v`, blue along the surface's normal; codes 0 to 255 stand for -1 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalMap {
    /// The texture.
    pub texture: TextureId,
    /// What red and green are multiplied by, in [-1e4, 1e4].
    pub scale: f32,
}

/// A texture of heights, by which a surface is shaded: the mean of red, green and blue, linear,
/// where codes stand for 0 to 1. It becomes a map of normals of the same texels, by the differences
/// of those on both sides. Its texture repeats or clamps.
///
/// How steep it is follows from how large the texture lies on the surfaces of the material, in the
/// mean over their area: where it lies larger it is as steep, and its heights are larger, too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BumpMap {
    /// The texture.
    pub texture: TextureId,
    /// How high above 0 the surface is where the texture is 1, in world units (of a shape that has
    /// instances, in its own), in [-1e4, 1e4].
    pub height: f32,
}

impl Maps {
    /// All textures.
    pub fn textures(&self) -> impl Iterator<Item = TextureId> + use<> {
        let shares = self.shares().map(|map| map.map(|map| map.texture));
        let normals = [self.normal, self.coat_normal].map(|map| map.map(|map| map.texture));
        let bump = self.bump.map(|map| map.texture);
        let colours = [self.base_colour, self.emission, self.sheen, self.specular_colour];
        let others = [bump, self.anisotropy];
        colours.into_iter().chain(shares).chain(normals).chain(others).flatten()
    }

    /// Those that say one number each.
    pub(in crate::scene) fn shares(&self) -> [Option<Channel>; 7] {
        [
            self.roughness,
            self.metallic,
            self.coat,
            self.coat_roughness,
            self.sheen_roughness,
            self.transmission,
            self.specular,
        ]
    }

    /// Whether kernels need the ability
    /// [`LAYER_MAPS`](raystream_shaders::scene::abilities::LAYER_MAPS) for them.
    pub(crate) fn has_layers(&self) -> bool {
        let usual = Self {
            base_colour: self.base_colour,
            roughness: self.roughness,
            metallic: self.metallic,
            normal: self.normal,
            bump: self.bump,
            emission: self.emission,
            ..Self::default()
        };
        *self != usual
    }

    /// The texture in whose tangent space the normals and the grain of a surface are; none for that
    /// of its first texture coordinates.
    pub(crate) fn tangent_space(&self) -> Option<TextureId> {
        let normals = self.normal.map(|map| map.texture);
        let bumps = self.bump.map(|map| map.texture);
        let coat = self.coat_normal.map(|map| map.texture);
        normals.or(bumps).or(coat).or(self.anisotropy)
    }
}
