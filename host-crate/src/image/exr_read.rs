//! EXR files, read: our own with everything, those of other tools for their colours.

use super::exr_select::{Selection, select_color, string};
use super::exr_write::SETTING_PREFIX;
use super::guard::catch_panic;
use super::read::read_file;
use super::{Channel, ColorImage, ImageError, LayeredImage};
use exr::block::UncompressedBlock;
use exr::block::lines::LineRef;
use exr::block::reader::{ChunksReader, Reader};
use exr::meta::header::Header;
use exr::prelude::{AttributeValue, SampleType, Vec2, f16};
use glam::Vec3;
use std::collections::BTreeMap;
use std::io::Cursor;
use std::path::Path;

/// Reads every channel of an EXR file (of its first part, if it has several), converted to 32-bit
/// float.
///
/// # Errors
/// [`ImageError`] if the file cannot be read, is broken, deep or subsampled.
pub fn read_layers(path: &Path) -> Result<LayeredImage, ImageError> {
    read_channels(path, |headers| {
        let channels = headers.first().map_or(0, |h| h.channels.list.len());
        Ok(Selection { part: 0, channels: (0..channels).collect() })
    })
}

/// Reads the settings that [`write_layers`](super::write_layers) stored, by key. Empty for files of
/// other tools.
///
/// # Errors
/// [`ImageError`] if the file cannot be read or is broken.
pub fn read_settings(path: &Path) -> Result<BTreeMap<String, String>, ImageError> {
    let bytes = read_file(path)?;
    let reader = open(path, &bytes)?;
    let attributes = reader.headers().iter().flat_map(|h| &h.own_attributes.other);
    Ok(attributes
        .filter_map(|(name, value)| match value {
            AttributeValue::Text(value) => {
                Some((string(name).strip_prefix(SETTING_PREFIX)?.to_owned(), string(value)))
            }
            _ => None,
        })
        .collect())
}

/// See [`super::read_color`].
pub(super) fn read_color(path: &Path) -> Result<ColorImage, ImageError> {
    let image = read_channels(path, |headers| select_color(path, headers))?;
    let [red, green, blue] = image.channels.as_slice() else {
        return Err(broken(path, "red, green and blue are not three channels"));
    };
    let pixels = red.values.iter().zip(&green.values).zip(&blue.values);
    let pixels = pixels.map(|((&r, &g), &b)| Vec3::new(r, g, b)).collect();
    Ok(ColorImage { width: image.width, height: image.height, pixels })
}

/// Decodes the selected channels, in the order of the selection.
fn read_channels(
    path: &Path,
    select: impl FnOnce(&[Header]) -> Result<Selection, ImageError>,
) -> Result<LayeredImage, ImageError> {
    let bytes = read_file(path)?;
    let reader = open(path, &bytes)?;
    let selection = select(reader.headers())?;
    let header = reader
        .headers()
        .get(selection.part)
        .ok_or_else(|| broken(path, "it has no parts"))?
        .clone();
    check_readable(path, &header, bytes.len())?;

    let Vec2(width, height) = header.layer_size;
    let mut planes = vec![vec![0.0; width * height]; selection.channels.len()];
    let mut slots = vec![None; header.channels.list.len()];
    for (slot, &channel) in selection.channels.iter().enumerate() {
        slots[channel] = Some(slot);
    }
    let mut decoded = 0;
    let decode = || {
        let chunks = reader.filter_chunks(false, |_, _, block| {
            block.layer == selection.part && block.level == Vec2(0, 0)
        })?;
        // On this thread, where a panic can be caught.
        chunks.decompress_sequential(false, |_, block: UncompressedBlock| {
            for line in block.lines(&header.channels) {
                let Some(slot) = slots[line.location.channel] else { continue };
                let Vec2(x, y) = line.location.position;
                let first = y * width + x;
                let row = planes[slot].get_mut(first..first + line.location.sample_count);
                let row =
                    row.ok_or(exr::error::Error::Invalid("block outside the picture".into()))?;
                copy_line(&line, header.channels.list[line.location.channel].sample_type, row)?;
                decoded += row.len();
            }
            Ok(())
        })
    };
    catch_panic(decode)
        .ok_or_else(|| broken(path, "its pixels do not decode"))?
        .map_err(|e| from_exr(path, e))?;
    if decoded != width * height * planes.len() {
        return Err(broken(path, "pixels are missing"));
    }
    let names = selection.channels.iter().map(|&c| string(&header.channels.list[c].name));
    let channels = names.zip(planes).map(|(name, values)| Channel { name, values }).collect();
    // `check_readable` bounds both.
    Ok(LayeredImage { width: width as u32, height: height as u32, channels })
}

fn copy_line(line: &LineRef<'_>, kind: SampleType, row: &mut [f32]) -> exr::error::UnitResult {
    match kind {
        SampleType::F16 => {
            row.iter_mut().zip(line.read_samples::<f16>()).try_for_each(|(to, v)| {
                *to = v?.to_f32();
                Ok(())
            })
        }
        SampleType::F32 => {
            row.iter_mut().zip(line.read_samples::<f32>()).try_for_each(|(to, v)| {
                *to = v?;
                Ok(())
            })
        }
        SampleType::U32 => {
            row.iter_mut().zip(line.read_samples::<u32>()).try_for_each(|(to, v)| {
                *to = v? as f32;
                Ok(())
            })
        }
    }
}

/// Refuses what is not read, and sizes that can only be damage, before memory is taken for them.
fn check_readable(path: &Path, header: &Header, file_bytes: usize) -> Result<(), ImageError> {
    let unsupported = |reason: &str| {
        Err(ImageError::Unsupported { path: path.to_owned(), reason: reason.into() })
    };
    if header.deep {
        return unsupported("deep data");
    }
    if header.channels.list.iter().any(|c| c.sampling != Vec2(1, 1)) {
        return unsupported("a subsampled channel");
    }
    let Vec2(width, height) = header.layer_size;
    let pixels = width as u128 * height as u128;
    // No compression of the format gains more, so a larger claim is damage, not a picture.
    let possible = 4096 * (file_bytes as u128 + 4096);
    let claimed = pixels * header.channels.list.len() as u128 * 4;
    if pixels == 0 || pixels > 1 << 30 || claimed > possible {
        return Err(broken(path, &format!("a size of {width}x{height} pixels")));
    }
    Ok(())
}

fn open<'a>(path: &Path, bytes: &'a [u8]) -> Result<Reader<Cursor<&'a [u8]>>, ImageError> {
    catch_panic(|| exr::block::read(Cursor::new(bytes), false))
        .ok_or_else(|| broken(path, "its header does not decode"))?
        .map_err(|e| from_exr(path, e))
}

fn broken(path: &Path, reason: &str) -> ImageError {
    ImageError::Broken { path: path.to_owned(), format: "EXR", reason: reason.to_owned() }
}

fn from_exr(path: &Path, error: exr::error::Error) -> ImageError {
    match error {
        exr::error::Error::NotSupported(what) => {
            ImageError::Unsupported { path: path.to_owned(), reason: what.into_owned() }
        }
        exr::error::Error::Invalid(what) => broken(path, &what),
        other => broken(path, &other.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::super::exr_write::tests::film;
    use super::super::{Display, read_color, write_film_as};
    use super::*;
    use exr::prelude::*;
    use std::path::PathBuf;

    #[test]
    fn half_and_integers_tiles_and_every_compression() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        let size = (37, 21);
        for compression in [
            Compression::Uncompressed,
            Compression::RLE,
            Compression::ZIP1,
            Compression::ZIP16,
            Compression::PIZ,
            Compression::PXR24,
        ] {
            for blocks in [Blocks::ScanLines, Blocks::Tiles(Vec2(16, 8))] {
                let channels = SpecificChannels::build()
                    .with_channel::<f16>("R")
                    .with_channel::<f32>("G")
                    .with_channel::<u32>("B")
                    .with_pixel_fn(|at: Vec2<usize>| {
                        (f16::from_f32(at.0 as f32), at.1 as f32, (at.0 * at.1) as u32)
                    });
                let encoding = Encoding { compression, blocks, line_order: LineOrder::Increasing };
                let layer = Layer::new(size, LayerAttributes::named("x"), encoding, channels);
                Image::from_layer(layer).write().to_file(&path).unwrap();
                let image = read_color(&path).unwrap();
                assert_eq!((image.width, image.height), (37, 21));
                for (i, pixel) in image.pixels.iter().enumerate() {
                    let (x, y) = ((i % 37) as f32, (i / 37) as f32);
                    assert_eq!(*pixel, Vec3::new(x, y, x * y), "{compression:?} {blocks:?}");
                }
            }
        }
    }

    #[test]
    fn missing_files_and_folders() {
        let folder = tempfile::tempdir().unwrap();
        let missing = folder.path().join("missing.exr");
        let error = read_color(&missing).unwrap_err();
        assert!(matches!(error, ImageError::NotFound { .. }));
        assert!(error.to_string().starts_with(missing.to_str().unwrap()));
        let path: PathBuf = folder.path().join("folder.exr");
        std::fs::create_dir(&path).unwrap();
        assert!(matches!(read_color(&path).unwrap_err(), ImageError::IsFolder { .. }));
    }

    /// Every cut must be an error, all other damage an error or, where it hits only pixels, a
    /// picture: never a panic.
    #[test]
    fn damage_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        write_film_as(&path, &film(17, 35), &[("seed".into(), "1".into())], &Display::default())
            .unwrap();
        damage(&path, 101);
        for compression in [
            Compression::Uncompressed,
            Compression::RLE,
            Compression::ZIP1,
            Compression::PIZ,
            Compression::PXR24,
            Compression::B44,
        ] {
            for blocks in [Blocks::ScanLines, Blocks::Tiles(Vec2(16, 8))] {
                let color = |at: Vec2<usize>| {
                    (f16::from_f32(at.0 as f32), (at.0 ^ at.1) as f32, at.1 as f32)
                };
                let channels = SpecificChannels::build()
                    .with_channel::<f16>("R")
                    .with_channel("G")
                    .with_channel("B");
                let encoding = Encoding { compression, blocks, line_order: LineOrder::Increasing };
                let layer = Layer::new(
                    (19, 23),
                    LayerAttributes::named("x"),
                    encoding,
                    channels.with_pixel_fn(color),
                );
                Image::from_layer(layer).write().to_file(&path).unwrap();
                damage(&path, 3);
            }
        }
        std::fs::write(&path, b"not a picture").unwrap();
        assert!(matches!(read_color(&path).unwrap_err(), ImageError::Broken { .. }));
    }

    /// Reads the file at `path` cut short and with bytes changed: everywhere in what may be the
    /// header, each `step`-th byte after it.
    fn damage(path: &Path, step: usize) {
        let whole = std::fs::read(path).unwrap();
        let try_bytes = |bytes: &[u8]| {
            std::fs::write(path, bytes).unwrap();
            let _ = read_settings(path);
            let _ = read_layers(path);
            read_color(path)
        };
        try_bytes(&whole).unwrap();
        for length in (0..whole.len()).step_by(97).chain(whole.len() - 8..whole.len()) {
            let error = try_bytes(&whole[..length]).expect_err("cut short");
            assert!(error.to_string().contains("a.exr"), "{error}");
        }
        let header = whole.len().min(1500);
        for position in (0..header).chain((header..whole.len()).step_by(step)) {
            for bits in [0x01, 0xff] {
                let mut damaged = whole.clone();
                damaged[position] ^= bits;
                let _ = try_bytes(&damaged);
            }
        }
        let mut random = 1_u32;
        for _ in 0..100 {
            let mut damaged = whole.clone();
            for _ in 0..4 {
                random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                damaged[(random >> 8) as usize % header] = random as u8;
            }
            let _ = try_bytes(&damaged);
        }
    }
}
