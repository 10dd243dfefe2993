//! PNG files.

use super::replace::replace_file;
use super::{ColorImage, Display, ImageError, Picture, Values};
use crate::color::srgb_decode;
use glam::Vec3;
use image::codecs::png::{CompressionType, FilterType, PngDecoder, PngEncoder};
use image::{DynamicImage, ExtendedColorType, ImageDecoder, ImageEncoder, Limits};
use std::io::Cursor;
use std::path::Path;

/// Writes an 8-bit sRGB PNG of a linear picture as `display` says.
///
/// # Errors
/// [`ImageError`] if the pixels do not fit the picture's size or the file cannot be written. An
/// existing file is then left as it was.
pub fn write_png(path: &Path, image: &ColorImage, display: &Display) -> Result<(), ImageError> {
    ImageError::check_buffer(path, "the colours", image.pixels.len(), image.width, image.height)?;
    let bytes: Vec<u8> = image.pixels.iter().flat_map(|&c| display.srgb8(c)).collect();
    write_rgb8(path, image.width, image.height, &bytes)
}

/// Writes `width * height` pixels of 3 bytes (red, green, blue, sRGB), row by row from the top.
pub fn write_rgb8(path: &Path, width: u32, height: u32, bytes: &[u8]) -> Result<(), ImageError> {
    let mut png = Vec::new();
    PngEncoder::new_with_quality(&mut png, CompressionType::Default, FilterType::Adaptive)
        .write_image(bytes, width, height, ExtendedColorType::Rgb8)
        .map_err(|e| ImageError::Encode {
            path: path.to_owned(),
            format: "PNG",
            reason: e.to_string(),
        })?;
    replace_file(path, &png)
}

/// See [`super::decode_picture`].
pub(super) fn decode_color(path: &Path, bytes: &[u8]) -> Result<Picture, ImageError> {
    let image = decode(bytes).map_err(|e| match e {
        image::ImageError::Unsupported(e) => {
            ImageError::Unsupported { path: path.to_owned(), reason: e.to_string() }
        }
        e => ImageError::Broken { path: path.to_owned(), format: "PNG", reason: e.to_string() },
    })?;
    let (width, height) = (image.width(), image.height());
    let pixels = image
        .into_rgb32f()
        .pixels()
        .map(|p| Vec3::from_array(p.0.map(|encoded| srgb_decode(f64::from(encoded)) as f32)))
        .collect();
    let colors = ColorImage { width, height, pixels };
    Ok(Picture { colors, values: Values::Display, remarks: Vec::new() })
}

fn decode(bytes: &[u8]) -> image::ImageResult<DynamicImage> {
    // A damaged size must not claim all memory: at most what the default of the crate allows, 512
    // MiB.
    let mut decoder = PngDecoder::with_limits(Cursor::new(bytes), Limits::default())?;
    decoder.set_limits(Limits::default())?;
    Limits::default().reserve(decoder.total_bytes())?;
    DynamicImage::from_decoder(decoder)
}

#[cfg(test)]
mod tests {
    use super::super::{ToneMap, read_color as read};
    use super::*;

    fn gradient(width: u32, height: u32) -> ColorImage {
        let value = |i: u32| Vec3::new(i as f32, 0.5, 1.5) / (width * height) as f32;
        ColorImage { width, height, pixels: (0..width * height).map(value).collect() }
    }

    const CLIP: Display = Display { exposure: 0.0, tone_map: ToneMap::Clip };

    #[test]
    fn pixels_are_where_they_belong() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        let pixels =
            vec![Vec3::X, Vec3::Y, Vec3::Z, Vec3::splat(0.5), Vec3::ZERO, Vec3::splat(f32::NAN)];
        write_png(&path, &ColorImage { width: 3, height: 2, pixels }, &CLIP).unwrap();
        let file = image::open(&path).unwrap();
        assert_eq!((file.width(), file.height(), file.color()), (3, 2, image::ColorType::Rgb8));
        #[rustfmt::skip]
        let expected = [
            255, 0, 0,      0, 255, 0,  0, 0, 255,
            188, 188, 188,  0, 0, 0,    0, 0, 0,
        ];
        assert_eq!(file.into_bytes(), expected);
    }

    #[test]
    fn reading_undoes_writing_but_for_rounding() {
        for (width, height) in [(1, 1), (1, 9), (300, 1), (33, 17)] {
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join("a.png");
            let image = gradient(width, height);
            write_png(&path, &image, &CLIP).unwrap();
            let back = read(&path).unwrap();
            assert_eq!((back.width, back.height), (width, height));
            for (a, b) in image.pixels.iter().zip(&back.pixels) {
                assert_eq!(CLIP.srgb8(*a), CLIP.srgb8(*b));
            }
            assert_eq!(
                std::fs::read_dir(folder.path()).unwrap().count(),
                1,
                "no file but the picture"
            );
        }
    }

    #[test]
    fn grey_transparent_and_deep_files_are_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        image::GrayImage::from_raw(1, 1, vec![188]).unwrap().save(&path).unwrap();
        assert!((read(&path).unwrap().pixels[0] - 0.503).abs().max_element() < 1e-3);
        image::RgbaImage::from_raw(1, 1, vec![255, 0, 188, 3]).unwrap().save(&path).unwrap();
        assert!(
            (read(&path).unwrap().pixels[0] - Vec3::new(1.0, 0.0, 0.503)).abs().max_element()
                < 1e-3
        );
        image::ImageBuffer::<image::Rgb<u16>, _>::from_raw(1, 1, vec![65535_u16, 0, 48316])
            .unwrap()
            .save(&path)
            .unwrap();
        assert!(
            (read(&path).unwrap().pixels[0] - Vec3::new(1.0, 0.0, 0.503)).abs().max_element()
                < 1e-3
        );
    }

    #[test]
    fn unfit_pixels_are_refused_and_the_old_file_stays() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        std::fs::write(&path, b"old").unwrap();
        for (width, height) in [(2, 2), (0, 0), (1, u32::MAX)] {
            let image = ColorImage { width, height, pixels: vec![Vec3::ONE; 3] };
            let error = write_png(&path, &image, &CLIP).unwrap_err();
            assert!(matches!(error, ImageError::BufferSize { .. }), "{error}");
        }
        assert_eq!(std::fs::read(&path).unwrap(), b"old");
    }

    #[test]
    fn damage_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        write_png(&path, &gradient(40, 30), &CLIP).unwrap();
        let whole = std::fs::read(&path).unwrap();
        let try_bytes = |bytes: &[u8]| {
            std::fs::write(&path, bytes).unwrap();
            read(&path)
        };
        try_bytes(&whole).unwrap();
        // The last 16 bytes are the end of the pixels' checksum and an empty closing chunk.
        for length in 0..whole.len() - 16 {
            let error = try_bytes(&whole[..length]).expect_err("cut short");
            assert!(error.to_string().contains("a.png"), "{error}");
        }
        for position in 0..whole.len() {
            for bits in [0x01, 0x80, 0xff] {
                let mut damaged = whole.clone();
                damaged[position] ^= bits;
                let _ = try_bytes(&damaged);
            }
        }
    }
}
