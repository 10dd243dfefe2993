//! How light that falls beside a pixel's centre counts.

use crate::names::named;
use raystream_shaders::film::pixel_filter as shaders;

/// The filter of pixels: each is the mean of radiance over the film, weighed by it. See
/// [`raystream_shaders::film::pixel_filter`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelFilter {
    /// How the weight falls off.
    pub shape: PixelFilterShape,
    /// Width in pixels, from side to side; above 0, at most 16.
    pub width: f32,
}

/// How the weight of light falls off from a pixel's centre.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum PixelFilterShape {
    /// Not at all, up to the edge of a square.
    #[default]
    Box,
    /// In a straight line along both axes.
    Tent,
    /// As a normal distribution, whose standard deviation is a sixth of the width.
    Gaussian,
    /// As Blackman and Harris's window along both axes: sharper than a Gaussian of that width, and
    /// as smooth.
    BlackmanHarris,
}

named! {
    PixelFilterShape {
        Box: "box",
        Tent: "tent",
        Gaussian: "gaussian",
        BlackmanHarris: "blackman-harris",
    }
}

impl PixelFilterShape {
    /// The width that suits the shape: 1 for a box, 2 for a tent, 3 for the smooth ones.
    pub fn usual_width(self) -> f32 {
        match self {
            Self::Box => 1.0,
            Self::Tent => 2.0,
            Self::Gaussian | Self::BlackmanHarris => 3.0,
        }
    }
}

impl Default for PixelFilter {
    /// The pixel itself: a box of width 1.
    fn default() -> Self {
        Self::of(PixelFilterShape::Box)
    }
}

impl PixelFilter {
    /// The widest one, in pixels.
    pub const MAX_WIDTH: f32 = 2.0 * shaders::MAX_RADIUS;

    /// A filter of this shape and its usual width.
    pub fn of(shape: PixelFilterShape) -> Self {
        Self { shape, width: shape.usual_width() }
    }

    /// Whether it is the pixel itself.
    pub fn is_pixel(&self) -> bool {
        *self == Self::default()
    }

    /// What kernels call it.
    pub(in crate::render) fn kernels(&self) -> shaders::PixelFilter {
        let kind = match self.shape {
            _ if self.is_pixel() => shaders::PIXEL,
            PixelFilterShape::Box => shaders::BOX,
            PixelFilterShape::Tent => shaders::TENT,
            PixelFilterShape::Gaussian => shaders::GAUSSIAN,
            PixelFilterShape::BlackmanHarris => shaders::BLACKMAN_HARRIS,
        };
        // Not a number, or 0, is as narrow as can be.
        let radius = (0.5 * self.width).max(f32::MIN_POSITIVE.sqrt());
        shaders::PixelFilter { kind, radius: radius.min(shaders::MAX_RADIUS) }
    }
}
