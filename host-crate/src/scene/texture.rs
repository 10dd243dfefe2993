//! Pictures on surfaces.

use crate::color::srgb_decode;
use glam::{DVec3, Mat2, Vec2, Vec3};
use std::sync::Arc;

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

/// What is seen between the centres of a texture's texels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum TextureFilter {
    /// A mixture of the four around.
    #[default]
    Linear,
    /// The nearest one.
    Nearest,
}

/// Which of the texture coordinates of a mesh a texture takes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum CoordinateSet {
    /// [`Mesh::texture_coordinates`](super::Mesh::texture_coordinates).
    #[default]
    First,
    /// [`Mesh::second_coordinates`](super::Mesh::second_coordinates).
    Second,
}

/// Where a texture lies: it is looked up at the `matrix` times the coordinates, plus the `offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// The coordinates.
    pub set: CoordinateSet,
    /// What they are multiplied by, each number in [-1e9, 1e9].
    pub matrix: Mat2,
    /// What is added then, each number in [-1e9, 1e9].
    pub offset: Vec2,
}

impl Default for Placement {
    fn default() -> Self {
        Self { set: CoordinateSet::First, matrix: Mat2::IDENTITY, offset: Vec2::ZERO }
    }
}

impl Placement {
    /// Where a texture is looked up at a point with these coordinates of its set.
    pub fn of(&self, coordinates: Vec2) -> Vec2 {
        self.matrix * coordinates + self.offset
    }

    /// The rows of the matrix, then the offset.
    pub fn numbers(&self) -> [f32; 6] {
        let [a, c, b, d] = self.matrix.to_cols_array();
        [a, b, c, d, self.offset.x, self.offset.y]
    }
}

/// A picture on a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// Width in texels, from 1 to 16384.
    pub width: u32,
    /// Height in texels, from 1 to 16384.
    pub height: u32,
    /// Row by row from the top: `width * height` of them. Textures may share them.
    pub texels: Arc<Texels>,
    /// How it goes on beyond its left and right edges, and beyond its upper and lower ones.
    pub wrap: [Wrap; 2],
    /// What is seen between texels.
    pub filter: TextureFilter,
    /// Where it lies on surfaces.
    pub placement: Placement,
}

/// The texels of a texture. What codes stand for is up to who looks them up: those of colours are
/// sRGB, and a fourth channel has no effect on them.
#[derive(Clone, Debug, PartialEq)]
pub enum Texels {
    /// Codes of red, green, blue and a fourth channel: 0 to 255 stand for 0 to 1.
    Bytes(Vec<[u8; 4]>),
    /// The same, 0 to 65535 for 0 to 1.
    Shorts(Vec<[u16; 4]>),
    /// Red, green and blue, linear Rec.709, each from 0 to 1e12. As colours of surfaces and as
    /// codes, what is above 1 is 1; the fourth channel is 1.
    Floats(Vec<[f32; 3]>),
}

impl Texels {
    /// How many there are.
    pub fn len(&self) -> usize {
        match self {
            Self::Bytes(texels) => texels.len(),
            Self::Shorts(texels) => texels.len(),
            Self::Floats(texels) => texels.len(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// How many words of 4 bytes all of them take on a device.
    pub fn words(&self) -> usize {
        let each = match self {
            Self::Bytes(_) => 1,
            Self::Shorts(_) => 2,
            Self::Floats(_) => 3,
        };
        each * self.len()
    }

    /// A channel of a texel (red, green, blue or alpha: 0 to 3) as the share that its code stands
    /// for, in [0, 1].
    fn share(&self, texel: usize, channel: usize) -> f64 {
        match self {
            Self::Bytes(texels) => f64::from(texels[texel][channel]) / 255.0,
            Self::Shorts(texels) => f64::from(texels[texel][channel]) / 65535.0,
            Self::Floats(texels) => texels[texel].get(channel).map_or(1.0, |c| c.min(1.0).into()),
        }
    }

    /// The linear colours, in order.
    fn colours(&self) -> Box<dyn Iterator<Item = DVec3> + '_> {
        match self {
            Self::Bytes(texels) => {
                let linear: [f64; 256] =
                    std::array::from_fn(|code| srgb_decode(code as f64 / 255.0));
                Box::new(texels.iter().map(move |&[red, green, blue, _]| {
                    DVec3::from([red, green, blue].map(|code| linear[usize::from(code)]))
                }))
            }
            Self::Shorts(texels) => Box::new(texels.iter().map(|&[red, green, blue, _]| {
                let linear = |code| srgb_decode(f64::from(code) / 65535.0);
                DVec3::from([red, green, blue].map(linear))
            })),
            Self::Floats(texels) => {
                Box::new(texels.iter().map(|&texel| Vec3::from(texel).as_dvec3()))
            }
        }
    }
}

impl Texture {
    /// A texture of codes of 8 bits that repeats in both directions and is seen between texels as
    /// a mixture of them; see the fields.
    pub fn new(width: u32, height: u32, texels: Vec<[u8; 4]>) -> Self {
        Self::of(width, height, Texels::Bytes(texels))
    }

    /// The same of any texels.
    pub fn of(width: u32, height: u32, texels: Texels) -> Self {
        Self {
            width,
            height,
            texels: Arc::new(texels),
            wrap: [Wrap::Repeat; 2],
            filter: TextureFilter::Linear,
            placement: Placement::default(),
        }
    }

    /// The mean of a channel (red, green, blue or alpha: 0 to 3) as the share that codes stand
    /// for.
    pub fn mean_code(&self, channel: usize) -> f32 {
        let count = self.texels.len();
        let sum: f64 = (0..count).map(|texel| self.texels.share(texel, channel)).sum();
        (sum / count as f64) as f32
    }

    /// The mean of its colours as shares of light, linear Rec.709, each component in [0, 1].
    pub fn mean(&self) -> Vec3 {
        let sum: DVec3 = self.texels.colours().map(|colour| colour.min(DVec3::ONE)).sum();
        (sum / self.texels.len() as f64).as_vec3()
    }

    /// The mean of its colours as factors of emission, linear Rec.709, which floats may have above
    /// 1.
    pub fn mean_emission(&self) -> Vec3 {
        let sum: DVec3 = self.texels.colours().sum();
        (sum / self.texels.len() as f64).as_vec3()
    }

    /// The largest component of any of its colours, linear Rec.709; 1 for codes.
    pub fn brightest(&self) -> f32 {
        match &*self.texels {
            Texels::Floats(texels) => texels.as_flattened().iter().copied().fold(0.0, f32::max),
            Texels::Bytes(_) | Texels::Shorts(_) => 1.0,
        }
    }

    /// Whether any texel's fourth channel is below its largest code.
    pub fn has_alpha(&self) -> bool {
        match &*self.texels {
            Texels::Bytes(texels) => texels.iter().any(|texel| texel[3] < u8::MAX),
            Texels::Shorts(texels) => texels.iter().any(|texel| texel[3] < u16::MAX),
            Texels::Floats(_) => false,
        }
    }

    /// Whether it lies by itself, so that kernels need the ability
    /// [`PLACED_TEXTURES`](raystream_shaders::scene::abilities::PLACED_TEXTURES).
    pub(crate) fn is_placed(&self) -> bool {
        self.placement != Placement::default()
    }

    /// Whether kernels need the ability
    /// [`WIDE_TEXTURES`](raystream_shaders::scene::abilities::WIDE_TEXTURES) for it.
    pub(crate) fn is_wide(&self) -> bool {
        !matches!(*self.texels, Texels::Bytes(_)) || self.filter != TextureFilter::Linear
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
        let wide = Texture::of(1, 1, Texels::Shorts(vec![[128 * 257; 4]])).mean();
        assert!((wide - grey).abs().max_element() < 1e-6, "{wide}");
    }

    #[test]
    fn floats_are_cut_off_as_shares_and_kept_as_emission() {
        let texture = Texture::of(2, 1, Texels::Floats(vec![[4.0, 0.5, 0.0], [0.0, 0.5, 1.0]]));
        assert_eq!(texture.mean(), Vec3::splat(0.5));
        assert_eq!(texture.mean_emission(), Vec3::new(2.0, 0.5, 0.5));
        assert_eq!((texture.mean_code(0), texture.mean_code(3)), (0.5, 1.0));
        assert_eq!((texture.brightest(), texture.has_alpha()), (4.0, false));
    }
}
