//! Picture files that become textures.

use super::bounds::{MAX_TEXELS, MAX_TEXTURE_SIDE};
use super::error::SceneError;
use super::options::LoadOptions;
use super::source::Source;
use super::texture::{Texture, TextureId, Wrap};
use image::{DynamicImage, ImageDecoder, ImageError, ImageFormat, ImageReader, Limits, RgbaImage};
use std::collections::HashMap;
use std::io::Cursor;
use std::path::{Path, PathBuf};

/// The textures of a scene as they are gathered.
pub(super) struct Pictures {
    /// In the order in which they were first asked for.
    pub textures: Vec<Texture>,
    texels: usize,
    loaded: HashMap<(PathBuf, [Wrap; 2]), TextureId>,
    options: LoadOptions,
}

impl Pictures {
    pub(super) fn new(options: LoadOptions) -> Self {
        Self { textures: Vec::new(), texels: 0, loaded: HashMap::new(), options }
    }

    /// The texture in a picture file, which is read on the first call, and repeats.
    pub(super) fn load(
        &mut self,
        source: &dyn Source,
        path: &Path,
    ) -> Result<TextureId, SceneError> {
        let limit = self.options.picture_bytes();
        self.load_by(path, [Wrap::Repeat; 2], || source.read(path, limit))
    }

    /// The texture in the picture that `read` reads on the first call, and which is called `path`.
    pub(super) fn load_by(
        &mut self,
        path: &Path,
        wrap: [Wrap; 2],
        read: impl FnOnce() -> Result<Vec<u8>, SceneError>,
    ) -> Result<TextureId, SceneError> {
        let key = (path.to_owned(), wrap);
        if let Some(&id) = self.loaded.get(&key) {
            return Ok(id);
        }
        let picture = self.decode(path, read()?)?;
        let (width, height) = picture.dimensions();
        self.texels += width as usize * height as usize;
        let id = TextureId(self.textures.len() as u32);
        let texels = picture.pixels().map(|texel| texel.0).collect();
        self.textures.push(Texture { wrap, ..Texture::new(width, height, texels) });
        self.loaded.insert(key, id);
        Ok(id)
    }

    /// The texture of this name.
    pub(super) fn get(&self, texture: TextureId) -> &Texture {
        &self.textures[texture.0 as usize]
    }

    /// Whether any texel of a texture is to be seen through.
    pub(super) fn has_alpha(&self, texture: TextureId) -> bool {
        self.get(texture).texels.iter().any(|texel| texel[3] < 255)
    }

    fn decode(&self, path: &Path, bytes: Vec<u8>) -> Result<RgbaImage, SceneError> {
        let fail = |source: ImageError| SceneError::Texture { path: path.to_owned(), source };
        // By content; by name only what has no signature (TGA).
        let mut reader = ImageReader::new(Cursor::new(bytes))
            .with_guessed_format()
            .map_err(|error| fail(error.into()))?;
        if let (None, Ok(format)) = (reader.format(), ImageFormat::from_path(path)) {
            reader.set_format(format);
        }
        let mut limits = Limits::default();
        limits.max_image_width = Some(MAX_TEXTURE_SIDE);
        limits.max_image_height = Some(MAX_TEXTURE_SIDE);
        limits.max_alloc = Some(self.options.max_memory / 2);
        reader.limits(limits.clone());
        let mut decoder = reader.into_decoder().map_err(fail)?;
        // Before it is decoded: a small file may hold a large picture.
        let (width, height) = decoder.dimensions();
        limits.check_dimensions(width, height).map_err(fail)?;
        limits.reserve(decoder.total_bytes()).map_err(fail)?;
        if self.texels + width as usize * height as usize > MAX_TEXELS {
            return Err(SceneError::TooManyTexels { path: path.to_owned(), limit: MAX_TEXELS });
        }
        decoder.set_limits(limits).map_err(fail)?;
        match DynamicImage::from_decoder(decoder).map_err(fail)? {
            DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_) => {
                Err(SceneError::LinearTexture { path: path.to_owned() })
            }
            picture => Ok(picture.into_rgba8()),
        }
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
        let mut pictures = Pictures::new(LoadOptions::default());
        assert_eq!(pictures.load(&Disk, &path).unwrap(), TextureId(0));
        assert_eq!(pictures.load(&Disk, &path).unwrap(), TextureId(0));
        let texels = vec![[255, 0, 0, 255], [0, 0, 128, 255]];
        assert_eq!(pictures.textures, [Texture::new(1, 2, texels)]);
    }

    #[test]
    fn a_picture_too_large_is_refused_before_it_is_decoded() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("large.bmp");
        image::RgbImage::new(1, 1).save(&path).unwrap();
        let mut bytes = std::fs::read(&path).unwrap();
        // The header promises 16384x16384 pixels.
        bytes[18..26].copy_from_slice(&[0, 0x40, 0, 0, 0, 0x40, 0, 0]);
        std::fs::write(&path, bytes).unwrap();
        let mut pictures =
            Pictures::new(LoadOptions { max_memory: 64 << 20, ..LoadOptions::default() });
        let error = pictures.load(&Disk, &path).unwrap_err().to_string();
        assert!(error.contains("large.bmp") && error.contains("limit"), "{error}");
        let mut full = Pictures { texels: MAX_TEXELS, ..Pictures::new(LoadOptions::default()) };
        assert!(full.load(&Disk, &path).unwrap_err().to_string().contains("texels"));
    }
}
