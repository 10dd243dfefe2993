//! Textures, decoded into one buffer in the layout of [`raystream_shaders::scene::texture`].

use super::SceneError;
use super::source::Source;
use image::{DynamicImage, ImageError, ImageFormat, ImageReader, Limits};
use raystream_shaders::scene::texture::DECODE_WORDS;
use std::collections::HashMap;
use std::io::Cursor;
use std::path::{Path, PathBuf};

/// Widest and highest texture, in texels.
const MAX_SIDE: u32 = 16_384;
/// Texels of all textures together: 1 GiB of them.
const MAX_TEXELS: usize = 1 << 28;
/// Memory that decoding one texture may take, in bytes.
const MAX_DECODING_BYTES: u64 = 4 << 30;

/// The textures of a scene.
pub(super) struct Textures {
    words: Vec<u32>,
    loaded: HashMap<PathBuf, u32>,
}

impl Textures {
    /// No textures yet, only the sRGB table.
    pub(super) fn new() -> Self {
        Self {
            words: (0..DECODE_WORDS).map(|code| srgb_to_linear(code).to_bits()).collect(),
            loaded: HashMap::new(),
        }
    }

    /// The index of the texture in a picture file, which is read on the first call.
    pub(super) fn load(&mut self, source: &dyn Source, path: &Path) -> Result<u32, SceneError> {
        if let Some(&index) = self.loaded.get(path) {
            return Ok(index);
        }
        let picture = decode(path, source.read(path)?)?;
        let texels = picture.width() as usize * picture.height() as usize;
        if self.words.len() + texels > MAX_TEXELS {
            return Err(SceneError::TooManyTexels { path: path.to_owned(), limit: MAX_TEXELS });
        }
        let index = self.words.len() as u32;
        self.words.extend([picture.width(), picture.height()]);
        self.words.extend(picture.pixels().map(|texel| u32::from_le_bytes(texel.0)));
        self.loaded.insert(path.to_owned(), index);
        Ok(index)
    }

    /// The buffer.
    pub(super) fn into_words(self) -> Vec<u32> {
        self.words
    }
}

fn decode(path: &Path, bytes: Vec<u8>) -> Result<image::RgbaImage, SceneError> {
    let fail = |source: ImageError| SceneError::Texture { path: path.to_owned(), source };
    // By content; by name only what has no signature (TGA).
    let mut reader =
        ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(|e| fail(e.into()))?;
    if let (None, Ok(format)) = (reader.format(), ImageFormat::from_path(path)) {
        reader.set_format(format);
    }
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_SIDE);
    limits.max_image_height = Some(MAX_SIDE);
    limits.max_alloc = Some(MAX_DECODING_BYTES);
    reader.limits(limits);
    match reader.decode().map_err(fail)? {
        DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_) => {
            Err(SceneError::LinearTexture { path: path.to_owned() })
        }
        picture => Ok(picture.into_rgba8()),
    }
}

/// The linear value, in [0, 1], of an sRGB code in [0, 255].
fn srgb_to_linear(code: u32) -> f32 {
    crate::color::srgb_decode(f64::from(code) / 255.0) as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::source::Disk;
    use raystream_shaders::scene::texture::TextureView;

    #[test]
    fn texels_are_found_where_the_kernels_look() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("two.png");
        // Red above blue.
        let picture = image::RgbImage::from_raw(1, 2, vec![255, 0, 0, 0, 0, 128]).unwrap();
        picture.save(&path).unwrap();
        let mut textures = Textures::new();
        let index = textures.load(&Disk, &path).unwrap();
        assert_eq!(index, DECODE_WORDS);
        assert_eq!(textures.load(&Disk, &path).unwrap(), index);
        let words = textures.into_words();
        assert_eq!(words[256..], [1, 2, 0xff00_00ff, 0xff80_0000]);
        let view = TextureView::new(&words);
        assert_eq!(view.sample(index, 0.5, 0.75), glam::Vec3::X);
        let blue = view.sample(index, 0.5, 0.25);
        assert!((blue.z - 0.215_860_5).abs() < 1e-6 && blue.x == 0.0, "{blue}");
    }

    #[test]
    fn the_ends_of_the_srgb_table_are_exact() {
        assert_eq!(srgb_to_linear(0), 0.0);
        assert_eq!(srgb_to_linear(255), 1.0);
        assert!((srgb_to_linear(10) - 0.003_035_27).abs() < 1e-8);
    }
}
