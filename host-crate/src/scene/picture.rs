//! Picture files that become textures.

use super::bounds::{MAX_TEXELS, MAX_TEXTURE_SIDE};
use super::error::SceneError;
use super::source::Source;
use super::texture::{Texture, TextureId};
use image::{DynamicImage, ImageError, ImageFormat, ImageReader, Limits};
use std::collections::HashMap;
use std::io::Cursor;
use std::path::{Path, PathBuf};

/// Memory that decoding one texture may take, in bytes.
const MAX_DECODING_BYTES: u64 = 4 << 30;

/// The textures of a scene as they are gathered.
#[derive(Default)]
pub(super) struct Pictures {
    /// In the order in which they were first asked for.
    pub textures: Vec<Texture>,
    texels: usize,
    loaded: HashMap<PathBuf, TextureId>,
}

impl Pictures {
    /// The texture in a picture file, which is read on the first call.
    pub(super) fn load(
        &mut self,
        source: &dyn Source,
        path: &Path,
    ) -> Result<TextureId, SceneError> {
        if let Some(&id) = self.loaded.get(path) {
            return Ok(id);
        }
        let picture = decode(path, source.read(path)?)?;
        let (width, height) = picture.dimensions();
        self.texels += width as usize * height as usize;
        if self.texels > MAX_TEXELS {
            return Err(SceneError::TooManyTexels { path: path.to_owned(), limit: MAX_TEXELS });
        }
        let id = TextureId(self.textures.len() as u32);
        let texels = picture.pixels().map(|texel| texel.0).collect();
        self.textures.push(Texture { width, height, texels });
        self.loaded.insert(path.to_owned(), id);
        Ok(id)
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
    limits.max_image_width = Some(MAX_TEXTURE_SIDE);
    limits.max_image_height = Some(MAX_TEXTURE_SIDE);
    limits.max_alloc = Some(MAX_DECODING_BYTES);
    reader.limits(limits);
    match reader.decode().map_err(fail)? {
        DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_) => {
            Err(SceneError::LinearTexture { path: path.to_owned() })
        }
        picture => Ok(picture.into_rgba8()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::source::Disk;

    #[test]
    fn a_picture_is_read_once_and_from_the_top() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("two.png");
        // Red above blue.
        let picture = image::RgbImage::from_raw(1, 2, vec![255, 0, 0, 0, 0, 128]).unwrap();
        picture.save(&path).unwrap();
        let mut pictures = Pictures::default();
        assert_eq!(pictures.load(&Disk, &path).unwrap(), TextureId(0));
        assert_eq!(pictures.load(&Disk, &path).unwrap(), TextureId(0));
        let texels = vec![[255, 0, 0, 255], [0, 0, 128, 255]];
        assert_eq!(pictures.textures, [Texture { width: 1, height: 2, texels }]);
    }
}
