//! Picture files that become textures.

use super::bounds::{MAX_TEXELS, MAX_TEXTURE_SIDE};
use super::error::SceneError;
use super::options::LoadOptions;
use super::radiances::{EXR, mend};
use super::source::Source;
use super::texture::{CoordinateSet, Placement, Texels, Texture, TextureFilter, TextureId, Wrap};
use glam::Vec3;
use image::{DynamicImage, ImageDecoder, ImageError, ImageFormat, ImageReader, Limits};
use std::collections::HashMap;
use std::io::Cursor;
use std::path::{Path, PathBuf};

/// The textures of a scene as they are gathered.
pub(super) struct Pictures {
    /// In the order in which they were first asked for.
    pub textures: Vec<Texture>,
    /// What the user should know of them.
    pub warnings: Vec<String>,
    /// What they take, in words of 4 bytes.
    words: usize,
    loaded: HashMap<(PathBuf, Sampler), TextureId>,
    /// Those that lie elsewhere, by the one that does not and the bits of their place.
    placed: HashMap<(TextureId, bool, [u32; 6]), TextureId>,
    options: LoadOptions,
}

/// How a picture is looked up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub(super) struct Sampler {
    /// See [`Texture::wrap`].
    pub wrap: [Wrap; 2],
    /// See [`Texture::filter`].
    pub filter: TextureFilter,
}

/// What a picture file holds: width, height and texels.
type Decoded = (u32, u32, Texels);

impl Pictures {
    pub(super) fn new(options: &LoadOptions) -> Self {
        Self {
            textures: Vec::new(),
            warnings: Vec::new(),
            words: 0,
            loaded: HashMap::new(),
            placed: HashMap::new(),
            options: options.clone(),
        }
    }

    /// The texture in a picture file, which is read on the first call, and repeats.
    pub(super) fn load(
        &mut self,
        source: &dyn Source,
        path: &Path,
        filter: TextureFilter,
    ) -> Result<TextureId, SceneError> {
        let limit = self.options.picture_bytes();
        let sampler = Sampler { filter, ..Sampler::default() };
        self.load_by(path, sampler, || source.read(path, limit))
    }

    /// The texture in the picture that `read` reads on the first call, and which is called `path`.
    pub(super) fn load_by(
        &mut self,
        path: &Path,
        sampler: Sampler,
        read: impl FnOnce() -> Result<Vec<u8>, SceneError>,
    ) -> Result<TextureId, SceneError> {
        let key = (path.to_owned(), sampler);
        if let Some(&id) = self.loaded.get(&key) {
            return Ok(id);
        }
        let bytes = read()?;
        let (width, height, texels) = if bytes.starts_with(&EXR) {
            self.decode_exr(path, &bytes)?
        } else {
            self.decode(path, bytes)?
        };
        self.words += texels.words();
        let id = TextureId(self.textures.len() as u32);
        let Sampler { wrap, filter } = sampler;
        self.textures.push(Texture { wrap, filter, ..Texture::of(width, height, texels) });
        self.loaded.insert(key, id);
        Ok(id)
    }

    /// The same texture at a place of its own. They share their texels.
    pub(super) fn placed(&mut self, texture: TextureId, placement: Placement) -> TextureId {
        if placement == Placement::default() {
            return texture;
        }
        let bits = placement.numbers().map(f32::to_bits);
        let key = (texture, placement.set == CoordinateSet::Second, bits);
        if let Some(&id) = self.placed.get(&key) {
            return id;
        }
        let id = TextureId(self.textures.len() as u32);
        self.textures.push(Texture { placement, ..self.get(texture).clone() });
        self.placed.insert(key, id);
        id
    }

    /// The texture of this name.
    pub(super) fn get(&self, texture: TextureId) -> &Texture {
        &self.textures[texture.0 as usize]
    }

    /// Whether a texture looks like one of normals in tangent space, most of them upright: more blue
    /// than anything else.
    pub(super) fn is_of_normals(&self, texture: TextureId) -> bool {
        const MORE: f32 = 0.2;
        let [red, green, blue] = [0, 1, 2].map(|channel| self.get(texture).mean_code(channel));
        blue > red.max(green) + MORE
    }

    /// Whether any texel of a texture is to be seen through.
    pub(super) fn has_alpha(&self, texture: TextureId) -> bool {
        self.get(texture).has_alpha()
    }

    fn decode(&mut self, path: &Path, bytes: Vec<u8>) -> Result<Decoded, SceneError> {
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
        let channels = decoder.color_type().channel_count();
        let words = match decoder.color_type().bytes_per_pixel() / channels {
            1 => 1,
            2 => 2,
            _ => 3,
        };
        self.check_room(path, [width, height], words)?;
        decoder.set_limits(limits).map_err(fail)?;
        let texels = match DynamicImage::from_decoder(decoder).map_err(fail)? {
            picture @ (DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_)) => {
                let has_alpha = picture.color().has_alpha();
                if has_alpha {
                    self.warn(path, "its alpha is left out, as of all pictures of floats.");
                }
                let pixels = picture.into_rgb32f();
                self.floats(path, pixels.pixels().map(|pixel| Vec3::from(pixel.0)).collect())
            }
            picture if words == 2 => shorts(picture),
            picture => Texels::Bytes(picture.into_rgba8().pixels().map(|pixel| pixel.0).collect()),
        };
        Ok((width, height, texels))
    }

    /// The colours of an EXR file, as any of this crate is read.
    #[cfg(feature = "exr")]
    fn decode_exr(&mut self, path: &Path, bytes: &[u8]) -> Result<Decoded, SceneError> {
        let picture = crate::image::decode_exr(path, bytes)
            .map_err(|source| SceneError::Picture { source: Box::new(source) })?;
        for remark in &picture.remarks {
            self.warn(path, remark);
        }
        let crate::image::ColorImage { width, height, pixels, .. } = picture.colors;
        if [width, height].iter().any(|side| !(1..=MAX_TEXTURE_SIDE).contains(side)) {
            let what = format!("it has {width}x{height} texels, {MAX_TEXTURE_SIDE} a side at most");
            return Err(SceneError::UnusableTexture { path: path.to_owned(), what });
        }
        self.check_room(path, [width, height], 3)?;
        Ok((width, height, self.floats(path, pixels)))
    }

    /// Says that EXR files are not read.
    #[cfg(not(feature = "exr"))]
    fn decode_exr(&mut self, path: &Path, _: &[u8]) -> Result<Decoded, SceneError> {
        let what = "an EXR file takes the feature `exr`".to_owned();
        Err(SceneError::UnusableTexture { path: path.to_owned(), what })
    }

    /// Fails if there is no room for a picture of so many `words` a texel.
    fn check_room(&self, path: &Path, size: [u32; 2], words: usize) -> Result<(), SceneError> {
        let [width, height] = size.map(|side| side as usize);
        if self.words + words * width * height > MAX_TEXELS {
            return Err(SceneError::TooManyTexels { path: path.to_owned(), limit: MAX_TEXELS });
        }
        Ok(())
    }

    /// Texels of numbers, once they are none but radiances.
    fn floats(&mut self, path: &Path, mut pixels: Vec<Vec3>) -> Texels {
        if let Some(what) = mend(&mut pixels) {
            self.warn(path, &what);
        }
        Texels::Floats(pixels.iter().map(Vec3::to_array).collect())
    }

    fn warn(&mut self, path: &Path, what: &str) {
        self.warnings.push(format!("{}: {what}", path.display()));
    }
}

/// Texels of 16 bits a channel; of 8 if that loses nothing.
fn shorts(picture: DynamicImage) -> Texels {
    const BYTES_PER_CODE: u16 = 257;
    let picture = picture.into_rgba16();
    if picture.as_raw().iter().all(|code| code % BYTES_PER_CODE == 0) {
        let byte = |code: u16| (code / BYTES_PER_CODE) as u8;
        return Texels::Bytes(picture.pixels().map(|pixel| pixel.0.map(byte)).collect());
    }
    Texels::Shorts(picture.pixels().map(|pixel| pixel.0).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::source::Disk;

    const LINEAR: TextureFilter = TextureFilter::Linear;

    #[test]
    fn a_picture_is_read_once_and_from_the_top() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("two.png");
        // Red above blue.
        let picture = image::RgbImage::from_raw(1, 2, vec![255, 0, 0, 0, 0, 128]).unwrap();
        picture.save(&path).unwrap();
        let mut pictures = Pictures::new(&LoadOptions::default());
        assert_eq!(pictures.load(&Disk, &path, LINEAR).unwrap(), TextureId(0));
        assert_eq!(pictures.load(&Disk, &path, LINEAR).unwrap(), TextureId(0));
        let texels = vec![[255, 0, 0, 255], [0, 0, 128, 255]];
        assert_eq!(pictures.textures, [Texture::new(1, 2, texels)]);
        // Shown otherwise, it is another texture.
        let nearest = pictures.load(&Disk, &path, TextureFilter::Nearest).unwrap();
        assert_eq!(pictures.get(nearest).filter, TextureFilter::Nearest);
    }

    /// What is read of a picture that has this name.
    fn read_back(name: &str, picture: impl Into<DynamicImage>) -> (Texels, Vec<String>) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        picture.into().save(&path).unwrap();
        let mut pictures = Pictures::new(&LoadOptions::default());
        pictures.load(&Disk, &path, LINEAR).unwrap();
        (Texels::clone(&pictures.textures.remove(0).texels), pictures.warnings)
    }

    #[test]
    fn pictures_of_16_bits_keep_them_where_they_have_more_than_8() {
        let picture =
            |codes: Vec<u16>| image::ImageBuffer::<image::Rgb<u16>, _>::from_raw(1, 1, codes);
        let (wide, _) = read_back("wide.png", picture(vec![1, 256, 40_000]).unwrap());
        assert_eq!(wide, Texels::Shorts(vec![[1, 256, 40_000, u16::MAX]]));
        let (narrow, _) = read_back("narrow.png", picture(vec![0, 257, 65_535]).unwrap());
        assert_eq!(narrow, Texels::Bytes(vec![[0, 1, 255, 255]]));
        let grey = image::ImageBuffer::<image::Luma<u16>, _>::from_raw(1, 1, vec![300_u16]);
        let (grey, _) = read_back("grey.png", grey.unwrap());
        assert_eq!(grey, Texels::Shorts(vec![[300, 300, 300, u16::MAX]]));
    }

    #[test]
    fn pictures_of_floats_keep_what_is_above_1_and_say_what_is_no_radiance() {
        let picture = |values: Vec<f32>| image::Rgb32FImage::from_raw(1, 1, values).unwrap();
        let (bright, warnings) = read_back("bright.hdr", picture(vec![8.0, 0.5, 0.0]));
        assert_eq!((bright, warnings.len()), (Texels::Floats(vec![[8.0, 0.5, 0.0]]), 0));
        let (fine, warnings) = read_back("fine.tiff", picture(vec![1e-7, 0.1, 12.3]));
        assert_eq!((fine, warnings.len()), (Texels::Floats(vec![[1e-7, 0.1, 12.3]]), 0));
        let (mended, warnings) = read_back("odd.tiff", picture(vec![f32::NAN, -1.0, 2.0]));
        assert_eq!(mended, Texels::Floats(vec![[0.0, 0.0, 2.0]]));
        assert!(warnings.len() == 1 && warnings[0].contains("odd.tiff: 1 texels"), "{warnings:?}");
        let rgba = image::Rgba32FImage::from_raw(1, 1, vec![1.0, 1.0, 1.0, 0.5]).unwrap();
        let (_, warnings) = read_back("alpha.tiff", rgba);
        assert!(warnings.len() == 1 && warnings[0].contains("alpha"), "{warnings:?}");
    }

    #[cfg(feature = "exr")]
    #[test]
    fn an_exr_is_a_texture_and_a_broken_one_an_error() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.exr");
        let pixels = vec![Vec3::new(3.5, 0.25, 0.0), Vec3::ONE];
        let picture = crate::image::ColorImage { width: 2, height: 1, pixels };
        crate::image::write_color(&path, &picture, &[], &crate::image::Display::default()).unwrap();
        let mut pictures = Pictures::new(&LoadOptions::default());
        pictures.load(&Disk, &path, LINEAR).unwrap();
        let expected = vec![[3.5, 0.25, 0.0], [1.0; 3]];
        assert_eq!(pictures.textures, [Texture::of(2, 1, Texels::Floats(expected))]);
        let mut bytes = std::fs::read(&path).unwrap();
        bytes.truncate(bytes.len() / 2);
        std::fs::write(&path, bytes).unwrap();
        let mut pictures = Pictures::new(&LoadOptions::default());
        let error = pictures.load(&Disk, &path, LINEAR).unwrap_err().to_string();
        assert!(error.contains("x.exr"), "{error}");
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
            Pictures::new(&LoadOptions { max_memory: 64 << 20, ..LoadOptions::default() });
        let error = pictures.load(&Disk, &path, LINEAR).unwrap_err().to_string();
        assert!(error.contains("large.bmp") && error.contains("limit"), "{error}");
        let mut full = Pictures { words: MAX_TEXELS, ..Pictures::new(&LoadOptions::default()) };
        assert!(full.load(&Disk, &path, LINEAR).unwrap_err().to_string().contains("texels"));
    }
}
