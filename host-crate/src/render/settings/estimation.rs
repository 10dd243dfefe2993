//! What users can set about the estimators.

use crate::names::named;
use crate::render::scene::camera::pinhole;
use crate::render::settings::reconstruction::FilterKind;
use bytemuck::Zeroable;
use raystream_shaders::estimator::ErrorForm;
use raystream_shaders::estimator::bilateral::FilterParams;
use raystream_shaders::scene::camera::Camera;

/// What the error of a pixel is taken to be.
///
/// Those that are named like a [filter](FilterKind), but for `axis-aligned`, take it for the squared
/// difference of the measured picture from the filtered one, with what both share of noise.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Estimator {
    /// By the filter `auto`.
    Auto,
    /// The variance of the pixel's mean; but allocators go by rates that say, before any sample,
    /// what a pixel needs: by how far what throws light or shadow on it is (Mehta et al.).
    AxisAligned,
    /// By a joint bilateral filter (Podee et al.), in a kernel of its own.
    #[default]
    Bilateral,
    /// By the filter `features`.
    Features,
    /// By the filter `gem`.
    Gem,
    /// The squared difference of the means over the two halves of the samples.
    Halves,
    /// By the filter `learned`.
    Learned,
    /// By the filter `manifolds`.
    Manifolds,
    /// By the filter `nfor`.
    Nfor,
    /// By the filter `nlm`.
    Nlm,
    /// The variance of the pixel's mean.
    Variance,
}

named! {
    Estimator {
        Auto: "auto",
        AxisAligned: "axis-aligned",
        Bilateral: "bilateral",
        Features: "features",
        Gem: "gem",
        Halves: "halves",
        Learned: "learned",
        Manifolds: "manifolds",
        Nfor: "nfor",
        Nlm: "nlm",
        Variance: "variance",
    }
}

impl Estimator {
    /// The filter whose picture it looks at; none for those with a kernel of their own.
    pub const fn filter(self) -> Option<FilterKind> {
        Some(match self {
            Self::Auto => FilterKind::Auto,
            Self::Features => FilterKind::Features,
            Self::Gem => FilterKind::Gem,
            Self::Learned => FilterKind::Learned,
            Self::Manifolds => FilterKind::Manifolds,
            Self::Nfor => FilterKind::Nfor,
            Self::Nlm => FilterKind::Nlm,
            Self::AxisAligned | Self::Bilateral | Self::Halves | Self::Variance => return None,
        })
    }

    /// Whether it needs the samples in two independent halves.
    pub const fn needs_halves(self) -> bool {
        matches!(self, Self::Halves) || self.filter().is_some()
    }
}

/// How estimators look at a pixel's neighbours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EstimationSettings {
    /// The filter of the estimator `bilateral`.
    pub filter: FilterSettings,
    /// Whether `halves` and `variance` average squared errors over 3x3 pixels: the variance of a
    /// few samples is itself very uncertain, and 0 where a rare bright path is still to be found.
    pub smooth: bool,
}

/// A joint bilateral filter: weights are products of Gaussians, each with its standard deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilterSettings {
    /// Neighbours that the filter sees to each side; it takes `(2 radius + 1)^2` reads a pixel. The
    /// Gaussian of pixel distance has the standard deviation `radius / 2`. 0 filters nothing.
    pub radius: u32,
    /// Standard deviation of world distance, in units of what `radius` pixels cover on the surface;
    /// above 0. Thus a flat wall is filtered alike at any distance, and edges in depth are what is
    /// deep beside what a pixel covers.
    pub position_sigma: f32,
    /// Standard deviation of the difference of unit normals, about an angle in radians; above 0.
    pub normal_sigma: f32,
    /// Standard deviation of the difference of albedos, as vectors of RGB; above 0.
    pub albedo_sigma: f32,
    /// Whether differences of colour beyond the noise of both pixels count as edges, of shadows for
    /// one, and noise that the filter leaves is made up for by the variance. Without it the filter
    /// is that of Podee et al.
    pub color: bool,
}

impl EstimationSettings {
    /// What nobody has to set.
    pub const DEFAULT: Self = Self { filter: FilterSettings::DEFAULT, smooth: true };
}

impl Default for EstimationSettings {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl Default for FilterSettings {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl FilterSettings {
    /// What nobody has to set.
    pub const DEFAULT: Self =
        Self { radius: 5, position_sigma: 1.0, normal_sigma: 0.1, albedo_sigma: 0.05, color: true };

    /// The filter of Podee et al., which looks at features alone.
    pub fn paper() -> Self {
        Self { color: false, ..Self::DEFAULT }
    }

    /// A kernel's parameters for the camera's picture, but for the pixels that a launch takes.
    pub(in crate::render) fn parameters(&self, camera: &Camera, form: ErrorForm) -> FilterParams {
        let radius = self.radius as f32;
        let (origin, pixel_pitch) = pinhole(camera);
        FilterParams {
            width: camera.width,
            height: camera.height,
            origin,
            pixel_pitch,
            form,
            radius: self.radius,
            color: u32::from(self.color),
            pixel_sigma: 0.5 * radius,
            position_sigma: self.position_sigma * radius,
            normal_sigma: self.normal_sigma,
            albedo_sigma: self.albedo_sigma,
            ..FilterParams::zeroed()
        }
    }
}
