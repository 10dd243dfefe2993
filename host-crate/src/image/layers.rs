//! The layers of a render, as channels of an EXR file.

use super::{ColorImage, ImageError};
use crate::film::Film;
use glam::Vec3;
use std::path::Path;

/// One channel: a number for each pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// `R`, or `layer.R` in a layer.
    pub name: String,
    /// The values, row by row from the top.
    pub values: Vec<f32>,
}

/// A picture of any number of channels, all of one size.
#[derive(Clone, Debug, PartialEq)]
pub struct LayeredImage {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// The channels, each of `width * height` values. Their order means nothing: a file sorts them
    /// by name.
    pub channels: Vec<Channel>,
}

impl LayeredImage {
    /// Everything that a film knows:
    ///
    /// | channels | |
    /// |---|---|
    /// | `R`, `G`, `B` | radiance, linear Rec.709 |
    /// | `plain.R` ... `B` | mean radiance over all samples; only with corrections |
    /// | `variance.R` ... `B` | variance of that mean; infinite for fewer than two samples |
    /// | `first.R` ... `B`, `second.R` ... `B` | mean radiance of the halves; only with two |
    /// | `albedo.R` ... `B` | mean reflectance of the first surface |
    /// | `normal.X` ... `Z` | mean shading normal of the first surface, towards the camera |
    /// | `position.X` ... `Z` | mean position of the first surface, world units |
    /// | `depth.Z` | mean distance of the first surface from the camera, world units |
    /// | `samples.N` | samples of the pixel |
    /// | `filtered.R` ... `B` | the filtered picture, linear Rec.709; only with estimates |
    /// | `denoised.R` ... `B` | the picture after `--denoise`, linear Rec.709; only with that |
    /// | `denoised_error.V` | its estimated squared error, as `error.V` |
    /// | `error.V` | estimated squared error of the radiance, mean over R, G, B; with estimates |
    ///
    /// What light tracing found is in all pictures of radiance, but not in `variance` and `error`.
    ///
    /// `samples.N` is a float as all the others are, which every viewer shows; it is exact up to
    /// 2^24 samples. `path` is named in errors.
    ///
    /// # Errors
    /// [`ImageError::BufferSize`] if a buffer of the film does not fit its size.
    pub fn from_film(path: &Path, film: &Film) -> Result<Self, ImageError> {
        check_film(path, film)?;
        let samples = film.samples().into_iter().map(|n| n as f32).collect();
        let mut channels = Vec::from(rgb("", &film.color()));
        if film.corrections.is_some() {
            channels.extend(rgb("plain.", &film.plain()));
        }
        channels.extend(rgb("variance.", &film.variance()));
        if let Some([first, second]) = film.halves() {
            channels.extend(rgb("first.", &first));
            channels.extend(rgb("second.", &second));
        }
        channels.extend(rgb("albedo.", &film.albedo()));
        channels.extend(xyz("normal.", &film.normal()));
        channels.extend(xyz("position.", &film.position()));
        channels.push(Channel { name: "depth.Z".into(), values: film.depth() });
        channels.push(Channel { name: "samples.N".into(), values: samples });
        if let Some(filtered) = film.filtered() {
            channels.extend(rgb("filtered.", &filtered));
        }
        if let Some(values) = film.squared_error() {
            channels.push(Channel { name: "error.V".into(), values });
        }
        if let Some(denoised) = film.denoised() {
            channels.extend(rgb("denoised.", &denoised));
        }
        if let Some(values) = film.denoised_error() {
            channels.push(Channel { name: "denoised_error.V".into(), values });
        }
        Ok(Self { width: film.width, height: film.height, channels })
    }

    /// The channels `R`, `G`, `B` of a picture.
    pub fn from_color(image: &ColorImage) -> Self {
        Self { width: image.width, height: image.height, channels: rgb("", &image.pixels).into() }
    }

    /// The values of the channel `name`, if there is one.
    pub fn channel(&self, name: &str) -> Option<&[f32]> {
        self.channels.iter().find(|c| c.name == name).map(|c| c.values.as_slice())
    }
}

/// Fails where a buffer of the film does not fit its size; `path` is named in the error.
///
/// # Errors
/// [`ImageError::BufferSize`].
pub fn check_film(path: &Path, film: &Film) -> Result<(), ImageError> {
    let buffers = [
        ("the radiance", Some(film.radiance.len())),
        ("the features", Some(film.features.len())),
        ("the estimates", film.estimates.as_ref().map(Vec::len)),
        ("the corrections", film.corrections.as_ref().map(Vec::len)),
        ("the denoised picture", film.denoised.as_ref().map(Vec::len)),
        ("the splats", film.splats.as_ref().map(Vec::len)),
    ];
    for (what, values) in buffers {
        if let Some(values) = values {
            ImageError::check_buffer(path, what, values, film.width, film.height)?;
        }
    }
    Ok(())
}

fn rgb(prefix: &str, values: &[Vec3]) -> [Channel; 3] {
    split(prefix, ["R", "G", "B"], values)
}

fn xyz(prefix: &str, values: &[Vec3]) -> [Channel; 3] {
    split(prefix, ["X", "Y", "Z"], values)
}

fn split(prefix: &str, components: [&str; 3], values: &[Vec3]) -> [Channel; 3] {
    std::array::from_fn(|i| Channel {
        name: format!("{prefix}{}", components[i]),
        values: values.iter().map(|v| v[i]).collect(),
    })
}
