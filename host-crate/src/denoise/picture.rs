//! A noisy picture, and what filters are given of it.

use super::layers::Layers;
use super::noise::estimate_variance;
use crate::exec::{ExecError, Executor};
use crate::image::LayeredImage;
use crate::render::film::row_place;
use crate::render::reconstruction::FilterInputs;
use crate::scene::FilmSize;
use glam::{Vec3, Vec4};
use raystream_shaders::estimator::guide::{Guide, NO_SURFACE, pack_normal};
use raystream_shaders::reconstruction::halves::UNMEASURED;
use raystream_shaders::scene::abilities::{BASIC, Fixed};
use raystream_shaders::scene::camera::{Camera, PINHOLE};
use std::path::{Path, PathBuf};

/// The tangent of half the angle of view that is taken for the camera's, 45 degrees from top to
/// bottom. Filters ask only whether surfaces are flat, which hardly depends on it.
const HALF_VIEW: f32 = 0.414_213_57;

/// A picture, row by row from the top, and what is known of its pixels. Only colours are needed.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct NoisyPicture {
    size: FilmSize,
    /// Colours, linear: means over the pixels' samples. What is not finite is not measured.
    pub color: Vec<Vec3>,
    /// Variance of these, the mean over the components; what is infinite is taken to be as large as
    /// the colour. Without it, noise is estimated from the picture.
    pub variance: Option<Vec<f32>>,
    /// Two independent pictures, of which `color` is the mean by the number of their samples.
    pub halves: Option<[Vec<Vec3>; 2]>,
    /// The part of a pixel's samples that are of the first half, from 0 to 1; one half without it.
    pub share_of_first: Option<Vec<f32>>,
    /// Whether the first half is a control film: the one whose mean is right.
    pub is_controlled: bool,
    /// Samples of each pixel, above 0.
    pub samples: Option<Vec<f32>>,
    /// Mean reflectance of the first surface.
    pub albedo: Option<Vec<Vec3>>,
    /// Normal of the first surface, of any length; zero where there is none.
    pub normal: Option<Vec<Vec3>>,
    /// Distance of the first surface from the camera; 0 or not finite where there is none.
    pub depth: Option<Vec<f32>>,
}

/// Why a file's layers are no picture to denoise.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum NoisyPictureError {
    /// No channels are the picture.
    #[error(
        "{}: no channels R, G, B or of a layer such as Combined; the file has: {channels}; name a \
         file with the picture that is to be denoised",
        path.display()
    )]
    NoColor {
        /// The file.
        path: PathBuf,
        /// Its channels.
        channels: String,
    },
    /// The picture has no pixels, or too many.
    #[error("{}: {reason}; use a smaller picture", path.display())]
    Size {
        /// The file.
        path: PathBuf,
        /// What is wrong with its size.
        reason: String,
    },
}

impl NoisyPicture {
    /// A picture of which nothing but its colours is known.
    ///
    /// # Panics
    /// If there are not as many colours as pixels.
    pub fn new(size: FilmSize, color: Vec<Vec3>) -> Self {
        assert_eq!(color.len() as u64, u64::from(size.width) * u64::from(size.height));
        Self {
            size,
            color,
            variance: None,
            halves: None,
            share_of_first: None,
            is_controlled: false,
            samples: None,
            albedo: None,
            normal: None,
            depth: None,
        }
    }

    /// What the layers of a file say; `path` is named in errors. Raystream's own are known
    /// altogether. Of other renderers it takes the picture, albedo, normal and depth, as Cycles,
    /// pbrt and Mitsuba call them.
    ///
    /// # Errors
    /// [`NoisyPictureError`] if there is no picture among them.
    pub fn from_layers(path: &Path, image: &LayeredImage) -> Result<Self, NoisyPictureError> {
        let layers = Layers::of(image);
        let size = FilmSize::new(image.width.into(), image.height.into())
            .map_err(|reason| NoisyPictureError::Size { path: path.to_owned(), reason })?;
        let color = layers.color().ok_or_else(|| {
            let names: Vec<&str> = image.channels.iter().map(|c| c.name.as_str()).collect();
            NoisyPictureError::NoColor { path: path.to_owned(), channels: names.join(", ") }
        })?;
        let mut picture = Self {
            albedo: layers.albedo(),
            normal: layers.normal(),
            depth: layers.depth(),
            ..Self::new(size, color)
        };
        // Other renderers' variances are of samples or of means, and files do not say which.
        let Some(samples) = layers.samples() else { return Ok(picture) };
        picture.variance =
            layers.own("variance").map(|v| v.iter().map(|v| v.element_sum() / 3.0).collect());
        picture.is_controlled = layers.own("plain").is_some();
        if let (Some(first), Some(second)) = (layers.own("first"), layers.own("second")) {
            if picture.is_controlled {
                picture.share_of_first =
                    Some(control_shares(&picture.color, &first, &second, samples));
            }
            picture.halves = Some([first, second]);
        }
        picture.samples = Some(samples.iter().map(|n| n.max(1.0)).collect());
        Ok(picture)
    }

    /// Its size.
    pub fn size(&self) -> FilmSize {
        self.size
    }

    /// What is known of it beside its colours, for people.
    pub fn known(&self) -> Vec<&'static str> {
        let known = [
            ("variance", self.variance.is_some()),
            ("halves", self.halves.is_some()),
            ("albedo", self.albedo.is_some()),
            ("normal", self.normal.is_some()),
            ("depth", self.depth.is_some()),
        ];
        known.into_iter().filter(|(_, is_known)| *is_known).map(|(name, _)| name).collect()
    }

    /// Whether its mean is to be that of the first half.
    pub(super) fn has_control_film(&self) -> bool {
        self.is_controlled && self.halves.is_some()
    }

    /// Its mean over pixels and components, of what is finite; at least 0.
    pub(super) fn mean_radiance(&self) -> f32 {
        let finite = self.color.iter().filter(|c| c.is_finite());
        let (sum, count) =
            finite.fold((0.0, 0), |(sum, n), c| (sum + f64::from(c.element_sum()), n + 1));
        (sum / f64::from(3 * count.max(1))).max(0.0) as f32
    }

    /// A camera for it: at the origin, looking along -z.
    pub(super) fn camera(&self) -> Camera {
        let FilmSize { width, height } = self.size;
        let pitch = 2.0 * HALF_VIEW / height as f32;
        let corner = Vec3::new(-0.5 * width as f32, 0.5 * height as f32, 0.0) * pitch;
        Camera {
            origin: Vec3::ZERO,
            width,
            top_left: corner + Vec3::NEG_Z,
            height,
            right: Vec3::X * pitch,
            projection: PINHOLE,
            down: Vec3::NEG_Y * pitch,
            lens_radius: 0.0,
        }
    }

    /// Copies it to the device, before variances are calibrated.
    pub(super) fn write<E: Executor>(
        &self,
        executor: &E,
        inputs: &FilterInputs<E::Buffer>,
    ) -> Result<(), ExecError> {
        let FilmSize { width, height } = self.size;
        let estimated = self.variance.is_none();
        let estimate = || estimate_variance(width, height, &self.color);
        let variances = self.variance.clone().unwrap_or_else(estimate);
        let camera = self.camera();
        let pixels = (0..width * height).map(|rank| {
            let p = row_place(self.size, rank);
            let guide = self.guide(&camera, p, variances[p]);
            (guide, self.halves_of(p, &guide))
        });
        let (guides, halves): (Vec<Guide>, Vec<[Vec4; 2]>) = pixels.unzip();
        inputs.guides.write(executor, &guides)?;
        inputs.first.write(executor, &halves.iter().map(|h| h[0]).collect::<Vec<_>>())?;
        inputs.second.write(executor, &halves.iter().map(|h| h[1]).collect::<Vec<_>>())?;
        // An estimate from the picture is of the right size already.
        let noise = (0..variances.len())
            .map(|p| if estimated { Vec4::ZERO } else { self.measured_noise(p, variances[p]) });
        inputs.rows.write(executor, &noise.collect::<Vec<_>>())
    }

    fn guide(&self, camera: &Camera, p: usize, variance: f32) -> Guide {
        let (x, y) = (p as u32 % self.size.width, p as u32 / self.size.width);
        let color = self.color[p];
        let is_measured = color.is_finite();
        let albedo = self.albedo.as_ref().map_or(Vec3::ZERO, |albedo| albedo[p]);
        let normal = self.normal.as_ref().map_or(Vec3::Z, |normal| normal[p]);
        let depth = self.depth.as_ref().map_or(1.0, |depth| depth[p]);
        let has_features = self.normal.is_some() || self.depth.is_some() || self.albedo.is_some();
        // Renderers write 0, infinity or a very large number where there is nothing.
        let is_near = depth > 0.0 && depth < 1e9;
        let has_surface = has_features
            && is_near
            && albedo.is_finite()
            && normal.is_finite()
            && normal != Vec3::ZERO;
        let samples = self.samples.as_ref().map_or(1.0, |samples| samples[p]);
        Guide {
            color: if is_measured { color } else { Vec3::ZERO },
            variance: self.variance_of(p, variance),
            position: if has_surface {
                let place = [x as f32 + 0.5, y as f32 + 0.5];
                camera.ray(Fixed::<BASIC>, place, [0.0; 2]).direction.normalize() * depth
            } else {
                Vec3::ZERO
            },
            normal: if has_surface { pack_normal(normal) } else { NO_SURFACE },
            albedo: if has_surface { albedo } else { Vec3::ZERO },
            samples: if is_measured { samples.max(1.0) as u32 } else { 0 },
        }
    }

    /// One sample says nothing about its spread: taken to be as large as itself.
    fn variance_of(&self, p: usize, variance: f32) -> f32 {
        let own = self.color[p].length_squared() / 3.0;
        if variance.is_finite() {
            variance.max(0.0)
        } else if own.is_finite() {
            own
        } else {
            0.0
        }
    }

    fn share(&self, p: usize) -> f32 {
        self.share_of_first.as_ref().map_or(0.5, |shares| shares[p])
    }

    fn halves_of(&self, p: usize, guide: &Guide) -> [Vec4; 2] {
        if !guide.is_measured() {
            return [Vec3::ZERO.extend(UNMEASURED); 2];
        }
        let whole = guide.color.extend(guide.variance);
        let Some([first, second]) = &self.halves else { return [whole; 2] };
        let share = self.share(p);
        let has_both = share > 0.0 && share < 1.0;
        if !has_both || !first[p].is_finite() || !second[p].is_finite() {
            return [whole; 2];
        }
        let variances = [guide.variance / share, guide.variance / (1.0 - share)];
        [first[p].extend(variances[0]), second[p].extend(variances[1])]
    }

    /// The variance by the difference of the halves, and as it is said to be.
    fn measured_noise(&self, p: usize, variance: f32) -> Vec4 {
        let Some([first, second]) = &self.halves else { return Vec4::ZERO };
        let share = self.share(p);
        let difference = (first[p] - second[p]).length_squared() / 3.0;
        let measured = difference * share * (1.0 - share);
        if measured.is_finite() && variance.is_finite() && share > 0.0 && share < 1.0 {
            Vec4::new(measured, variance, 0.0, 0.0)
        } else {
            Vec4::ZERO
        }
    }
}

/// The part that a control film has in each pixel's samples: its number of samples, the same for
/// all pixels, by the pixel's. It follows from where the mean lies between those of the halves.
fn control_shares(mean: &[Vec3], first: &[Vec3], second: &[Vec3], samples: &[f32]) -> Vec<f32> {
    let number = |p: usize| {
        let (difference, part) = (first[p] - second[p], mean[p] - second[p]);
        samples[p] * difference.dot(part) / difference.length_squared()
    };
    let mut numbers: Vec<f32> = (0..mean.len()).map(number).filter(|n| n.is_finite()).collect();
    let middle = numbers.len() / 2;
    let number = if numbers.is_empty() {
        f32::INFINITY
    } else {
        numbers.select_nth_unstable_by(middle, f32::total_cmp).1.round().max(1.0)
    };
    samples.iter().map(|samples| (number / samples).min(1.0)).collect()
}
