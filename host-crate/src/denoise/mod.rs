//! Noise out of pictures that are already there: films that were written as EXR files, and pictures
//! of other renderers with what they know of each pixel.
//!
//! ```
//! use raystream::denoise::{Denoising, NoisyPicture, denoise};
//! use raystream::prelude::*;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let color = vec![glam::Vec3::ONE; 16 * 8];
//! let picture = NoisyPicture::new(FilmSize::new(16, 8)?, color);
//! let denoised = denoise(Device::open("cpu")?, &picture, &Denoising::default())?;
//! assert_eq!(denoised.color.len(), 16 * 8);
//! # Ok(())
//! # }
//! ```

mod layers;
mod noise;
mod picture;

pub use picture::{NoisyPicture, NoisyPictureError};

use crate::exec::{ExecError, Executor};
use crate::render::reconstruction::{FilterView, FilteredPicture, Reconstruction};
use crate::render::{FilterKind, FilterSettings};
use glam::Vec3;

/// How noise is taken out of a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Denoising {
    /// The filter.
    pub filter: FilterKind,
    /// Settings of the filter `bilateral`.
    pub bilateral: FilterSettings,
}

/// A picture with less noise, row by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Denoised {
    /// Its colours, linear as those that it was made of. A component that is noisy and dark may be
    /// a little below 0.
    pub color: Vec<Vec3>,
    /// The squared error that is left in each pixel by estimate, the mean over the components.
    pub squared_error: Vec<f32>,
}

/// Filters a picture on a device.
///
/// # Errors
/// If the device fails, has no room for it, or cannot give a kernel so large a picture; or if a
/// library that the filter needs is not there.
pub fn denoise<E: Executor>(
    executor: E,
    picture: &NoisyPicture,
    denoising: &Denoising,
) -> Result<Denoised, ExecError> {
    let Denoising { filter, bilateral } = *denoising;
    let filtered = FilteredPicture::new(&executor, picture.size(), filter, bilateral)?;
    let reconstruction = Reconstruction::new(&executor, filtered)?;
    let inputs = reconstruction.inputs();
    picture.write(&executor, inputs)?;
    let view = FilterView { camera: picture.camera(), mean_radiance: picture.mean_radiance() };
    reconstruction.run_inputs(&executor, &view, picture.has_control_film())?;
    let pixels = reconstruction.read(&executor)?;
    let (color, squared_error) = pixels.iter().map(|p| (p.filtered, p.squared_error)).unzip();
    Ok(Denoised { color, squared_error })
}
