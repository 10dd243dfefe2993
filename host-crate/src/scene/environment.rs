//! Light from all around, by a picture of it.

use super::bounds::{self, MAX_TEXELS, MAX_TEXTURE_SIDE};
use super::error::SceneError;
use super::options::LoadOptions;
use super::radiances::{EXR, mend};
use super::source::{Disk, Source};
use glam::Vec3;
use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader, Limits};
use std::io::Cursor;
use std::path::Path;

/// How Radiance HDR files begin.
const HDR: &[u8] = b"#?";

/// How warnings end of scenes whose file has no light.
pub(super) const LIT_BY_DEFAULT: &str = "it is lit by a soft studio; give an environment or an \
    emissive material for another light.";

/// An environment: an equirectangular picture of radiances, which lights the scene from all around.
///
/// The top of the picture is the zenith, +y. Without rotation its middle is seen towards -z and its
/// right side towards +x.
#[derive(Clone, Debug, PartialEq)]
pub struct Environment {
    /// Width in texels, from 1 to 16384; twice the height, in most files.
    pub width: u32,
    /// Height in texels, from 1 to 16384.
    pub height: u32,
    /// Radiances, linear Rec.709, each component in [0, 1e12], row by row from the top: `width *
    /// height` of them.
    pub texels: Vec<Vec3>,
    /// How far it is turned about +y, in degrees, counter-clockwise as seen from above.
    pub rotation: f32,
    /// What radiances are multiplied by, from 0 to 1e6.
    pub strength: f32,
}

impl Environment {
    /// An environment of a picture, neither turned nor scaled; see [`Environment::texels`].
    pub fn new(width: u32, height: u32, texels: Vec<Vec3>) -> Self {
        Self { width, height, texels, rotation: 0.0, strength: 1.0 }
    }

    /// Whether any light comes from it.
    pub fn emits(&self) -> bool {
        self.strength > 0.0 && self.texels.iter().any(|texel| texel.max_element() > 0.0)
    }

    /// What is wrong with it, as a sentence about its fields.
    pub(super) fn check(&self) -> Result<(), String> {
        let Self { width, height, .. } = *self;
        if [width, height].iter().any(|side| !(1..=MAX_TEXTURE_SIDE).contains(side)) {
            return Err(format!(
                "width and height must be from 1 to {MAX_TEXTURE_SIDE} texels, are {width} and \
                 {height}"
            ));
        }
        let wanted = width as usize * height as usize;
        if self.texels.len() != wanted {
            return Err(format!("{width}x{height} texels are {wanted}, not {}", self.texels.len()));
        }
        if wanted > MAX_TEXELS / 2 {
            return Err(format!("has {wanted} texels, but may have {}", MAX_TEXELS / 2));
        }
        bounds::rotation(self.rotation.into()).map_err(|what| format!("rotation {what}"))?;
        bounds::strength(self.strength.into()).map_err(|what| format!("strength {what}"))?;
        for (index, texel) in self.texels.iter().enumerate() {
            bounds::radiance(&texel.as_dvec3().to_array())
                .map_err(|what| format!("texels[{index}] {what}"))?;
        }
        Ok(())
    }
}

impl LoadOptions {
    /// Loads an environment from a Radiance HDR or EXR file, whatever it is called, and says what a
    /// user should know of it, a sentence each.
    ///
    /// An EXR is converted to Rec. 709 from the primaries that it has, as
    /// [`read_picture`](crate::image::read_picture) does. Texels that are negative or not a number
    /// become black, infinite ones as bright as the brightest that is not.
    ///
    /// # Errors
    ///
    /// When the file cannot be read, is of another kind, broken or too large.
    pub fn load_environment(&self, path: &Path) -> Result<(Environment, Vec<String>), SceneError> {
        self.read_environment(&Disk, path)
    }

    /// The same of a file in `source`.
    pub(super) fn read_environment(
        &self,
        source: &dyn Source,
        path: &Path,
    ) -> Result<(Environment, Vec<String>), SceneError> {
        let bytes = source.read(path, self.picture_bytes())?;
        let fail = |what| SceneError::Environment { path: path.to_owned(), what };
        let (mut environment, mut warnings) = if bytes.starts_with(&EXR) {
            from_exr(path, &bytes)?
        } else if bytes.starts_with(HDR) {
            (self.decode_hdr(bytes).map_err(fail)?, Vec::new())
        } else {
            return Err(fail("it is neither a Radiance HDR nor an EXR file".to_owned()));
        };
        if let Some(warning) = mend(&mut environment.texels) {
            warnings.push(format!("{}: {warning}", path.display()));
        }
        environment.check().map_err(fail)?;
        Ok((environment, warnings))
    }

    fn decode_hdr(&self, bytes: Vec<u8>) -> Result<Environment, String> {
        let mut limits = Limits::default();
        limits.max_image_width = Some(MAX_TEXTURE_SIDE);
        limits.max_image_height = Some(MAX_TEXTURE_SIDE);
        limits.max_alloc = Some(self.max_memory / 2);
        let reader = ImageReader::with_format(Cursor::new(bytes), ImageFormat::Hdr);
        let mut decoder = reader.into_decoder().map_err(|error| error.to_string())?;
        // Before it is decoded: a small file may hold a large picture.
        let (width, height) = decoder.dimensions();
        let mut room = limits.clone();
        room.check_dimensions(width, height).map_err(|error| error.to_string())?;
        room.reserve(decoder.total_bytes()).map_err(|error| error.to_string())?;
        decoder.set_limits(limits).map_err(|error| error.to_string())?;
        let picture =
            DynamicImage::from_decoder(decoder).map_err(|error| error.to_string())?.into_rgb32f();
        let texels = picture.pixels().map(|texel| Vec3::from_array(texel.0)).collect();
        Ok(Environment::new(width, height, texels))
    }
}

/// The environment of an EXR file.
#[cfg(feature = "exr")]
fn from_exr(path: &Path, bytes: &[u8]) -> Result<(Environment, Vec<String>), SceneError> {
    let picture = crate::image::decode_exr(path, bytes)
        .map_err(|source| SceneError::Picture { source: Box::new(source) })?;
    let remark = |remark: &String| format!("{}: {remark}", path.display());
    let warnings = picture.remarks.iter().map(remark).collect();
    let colors = picture.colors;
    Ok((Environment::new(colors.width, colors.height, colors.pixels), warnings))
}

/// The environment of an EXR file.
#[cfg(not(feature = "exr"))]
fn from_exr(path: &Path, _: &[u8]) -> Result<(Environment, Vec<String>), SceneError> {
    let what = "an EXR file takes the feature `exr`".to_owned();
    Err(SceneError::Environment { path: path.to_owned(), what })
}
