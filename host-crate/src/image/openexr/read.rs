//! EXR files, read.

use super::guard::catch_panic;
use super::luminance::{color, interpolate};
use super::primaries::Primaries;
use super::select::{Colors, Selection, select_color, string};
use super::subsampling::{Line, Samplings, decompress, hide, invalid, restore};
use super::window::Window;
use super::write::SETTING_PREFIX;
use crate::image::read::read_file;
use crate::image::{Channel, ColorImage, ImageError, LayeredImage, Picture, Values};
use exr::block::reader::Reader;
use exr::meta::header::Header;
use exr::prelude::{AttributeValue, SampleType, Vec2, f16};
use glam::{DMat3, Vec3};
use std::collections::{BTreeMap, HashSet};
use std::io::Cursor;
use std::path::Path;

/// Reads every channel of an EXR file (of its first part, if it has several), converted to 32-bit
/// float. The picture is the display window: pixels that the file has outside it are left out,
/// those that it has not are 0. Channels with a value at every second pixel are interpolated.
///
/// # Errors
/// [`ImageError`] if the file cannot be read, is broken or deep, or has channels with fewer values.
pub fn read_layers(path: &Path) -> Result<LayeredImage, ImageError> {
    let file = decode(path, &read_file(path)?, |headers| {
        let channels = headers.first().map_or(0, |h| h.channels.list.len());
        Ok(Selection { part: 0, channels: (0..channels).collect(), colors: Colors::Rgb })
    })?;
    let display = file.display;
    let place = |channel: Channel| Channel {
        values: file.data.show_in(&display, channel.values),
        name: channel.name,
    };
    let channels = file.channels.into_iter().map(place).collect();
    // `check_readable` bounds both.
    Ok(LayeredImage { width: display.width as u32, height: display.height as u32, channels })
}

/// Reads the settings that [`write_layers`](super::write_layers) stored, by key. Empty for files of
/// other tools.
///
/// # Errors
/// [`ImageError`] if the file cannot be read or is broken.
pub fn read_settings(path: &Path) -> Result<BTreeMap<String, String>, ImageError> {
    let bytes = read_file(path)?;
    let (bytes, _) = hide(&bytes);
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

/// See [`decode_picture`](crate::image::decode_picture).
pub(in crate::image) fn decode_color(path: &Path, bytes: &[u8]) -> Result<Picture, ImageError> {
    let file = decode(path, bytes, |headers| select_color(path, headers))?;
    let mut remarks = Vec::new();
    let (data, display) = (file.data, file.display);
    if !data.covers(&display) {
        remarks.push(format!("has {data}, but shows {display}; those that it has not count as 0"));
    }
    let convert = file.conversion(&mut remarks);
    let planes: Vec<Vec<f32>> = file.channels.into_iter().map(|channel| channel.values).collect();
    let weights = file.primaries.luminance_weights();
    let weights = weights.or(Primaries::REC_709.luminance_weights()).unwrap_or_default();
    let pixel = |index: usize| match (file.colors, planes.as_slice()) {
        (Colors::Rgb, [r, g, b]) => Vec3::new(r[index], g[index], b[index]),
        (Colors::LuminanceChroma, [y, ry, by]) => color(y[index], [ry[index], by[index]], weights),
        (_, planes) => Vec3::splat(planes.first().map_or(0.0, |luminance| luminance[index])),
    };
    let convert = |color: Vec3| match convert {
        // What is not finite stays so in its own component.
        Some(matrix) if color.is_finite() => (matrix * color.as_dvec3()).as_vec3(),
        _ => color,
    };
    let pixels = (0..data.width * data.height).map(|index| convert(pixel(index))).collect();
    drop(planes);
    let pixels = data.show_in(&display, pixels);
    let (width, height) = (display.width as u32, display.height as u32);
    Ok(Picture { colors: ColorImage { width, height, pixels }, values: Values::Radiance, remarks })
}

/// What is read of a file.
struct File {
    /// Where the pixels lie.
    data: Window,
    /// Which of them are the picture.
    display: Window,
    /// What the selected channels are.
    colors: Colors,
    /// Which colours they mean.
    primaries: Primaries,
    /// The selected channels, of the data window, in the order of the selection.
    channels: Vec<Channel>,
}

impl File {
    /// What makes Rec. 709 of its colours, if they are not that already; and a remark on it.
    fn conversion(&self, remarks: &mut Vec<String>) -> Option<DMat3> {
        let primaries = self.primaries;
        // Grey is white, but for its brightness, in all primaries.
        if self.colors == Colors::Luminance || primaries.are_rec_709() {
            return None;
        }
        let matrix = primaries.to_rec_709();
        remarks.push(match matrix {
            Some(_) => format!("has the primaries {primaries}; converted to Rec. 709"),
            None => format!("has primaries that make no colours, {primaries}; taken as Rec. 709"),
        });
        matrix
    }
}

/// Decodes the selected channels.
fn decode(
    path: &Path,
    bytes: &[u8],
    select: impl FnOnce(&[Header]) -> Result<Selection, ImageError>,
) -> Result<File, ImageError> {
    let (shown, samplings) = hide(bytes);
    let reader = open(path, &shown)?;
    let selection = select(reader.headers())?;
    let mut header = reader
        .headers()
        .get(selection.part)
        .ok_or_else(|| broken(path, "it has no parts"))?
        .clone();
    let none = Samplings::new();
    let samplings = samplings.get(selection.part).unwrap_or(&none);
    restore(&mut header, samplings).map_err(|e| from_exr(path, e))?;
    let data = Window::new(header.data_window());
    let display = Window::new(header.shared_attributes.display_window);
    check_readable(path, &header, &data, &display, bytes.len())?;

    let mut planes: Vec<Vec<f32>> =
        selection.channels.iter().map(|&c| vec![0.0; samples(&header, c)]).collect();
    let part = selection.part;
    catch_panic(|| fill(reader, part, &mut header, &selection.channels, &mut planes))
        .ok_or_else(|| broken(path, "its pixels do not decode"))?
        .map_err(|e| from_exr(path, e))?;
    let channels = selection.channels.iter().zip(planes).map(|(&index, values)| {
        let channel = &header.channels.list[index];
        let Vec2(x, y) = channel.sampling;
        let values = interpolate(values, data.width / x, [x > 1, y > 1]);
        Channel { name: string(&channel.name), values }
    });
    let channels = channels.collect();
    let primaries = Primaries::of(header.shared_attributes.chromaticities);
    Ok(File { data, display, colors: selection.colors, primaries, channels })
}

/// How many samples a channel has.
fn samples(header: &Header, channel: usize) -> usize {
    let Vec2(x, y) = header.channels.list[channel].sampling;
    (header.layer_size.0 / x) * (header.layer_size.1 / y)
}

/// Decodes the channels of `selected` into `planes`, each block once.
fn fill(
    reader: Reader<Cursor<&[u8]>>,
    part: usize,
    header: &mut Header,
    selected: &[usize],
    planes: &mut [Vec<f32>],
) -> exr::error::UnitResult {
    let channels: Vec<_> = header.channels.list.iter().map(|c| c.sample_type).collect();
    let mut slots = vec![None; channels.len()];
    for (slot, &channel) in selected.iter().enumerate() {
        slots[channel] = Some(slot);
    }
    let mut decoded = HashSet::new();
    let mut missing: usize = planes.iter().map(Vec::len).sum();
    // On this thread, where a panic can be caught.
    let chunks = reader
        .filter_chunks(false, |_, _, block| block.layer == part && block.level == Vec2(0, 0))?;
    for chunk in chunks {
        let chunk = chunk?;
        if chunk.layer_index != part {
            return Err(invalid("a block of another part"));
        }
        decompress(chunk, header, |line: &Line<'_>| {
            let Some(slot) = slots[line.channel] else { return Ok(()) };
            let kind = channels[line.channel];
            let count = line.bytes.len() / kind.bytes_per_sample();
            let row = planes[slot].get_mut(line.first..line.first + count);
            let row = row.ok_or_else(|| invalid("block outside the picture"))?;
            if count > 0 && !decoded.insert((slot, line.first)) {
                return Err(invalid("a block twice"));
            }
            missing -= count;
            copy_line(line.bytes, kind, row)
        })?;
    }
    if missing > 0 {
        return Err(invalid("pixels are missing"));
    }
    Ok(())
}

/// Converts samples in the byte order of this machine.
fn copy_line(mut bytes: &[u8], kind: SampleType, row: &mut [f32]) -> exr::error::UnitResult {
    use exr::io::Data;
    for to in row {
        *to = match kind {
            SampleType::F16 => f16::read_ne(&mut bytes)?.to_f32(),
            SampleType::F32 => f32::read_ne(&mut bytes)?,
            SampleType::U32 => u32::read_ne(&mut bytes)? as f32,
        };
    }
    Ok(())
}

/// Refuses what is not read, and sizes that can only be damage, before memory is taken for them.
fn check_readable(
    path: &Path,
    header: &Header,
    data: &Window,
    display: &Window,
    file_bytes: usize,
) -> Result<(), ImageError> {
    let unsupported =
        |reason: String| Err(ImageError::Unsupported { path: path.to_owned(), reason });
    if header.deep {
        return unsupported("deep data".into());
    }
    // No compression of the format gains more, so a larger claim is damage, not a picture.
    let possible = 4096 * (file_bytes as u128 + 4096);
    let claimed = data.pixels() * header.channels.list.len() as u128 * 4;
    if data.pixels() == 0 || data.pixels() > MAX_PIXELS || claimed > possible {
        return Err(broken(path, &format!("a size of {}x{} pixels", data.width, data.height)));
    }
    let limit = MAX_EMPTY_PIXELS.max(data.pixels().saturating_mul(16)).min(MAX_PIXELS);
    if display.pixels() == 0 || display.pixels() > limit {
        return unsupported(format!("a display window of {display} around {data}"));
    }
    Ok(())
}

/// The most pixels that are read.
const MAX_PIXELS: u128 = 1 << 30;
/// The most pixels of a display window that is nearly empty.
const MAX_EMPTY_PIXELS: u128 = 1 << 26;

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
    use super::super::write::tests::film;
    use super::*;
    use crate::image::{Display, read_color, read_picture, write_film_as};
    use exr::meta::attribute::{Chromaticities, IntegerBounds};
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

    /// A file of a layer at `position`, with the channels `names` of equal values, shown in a
    /// window.
    fn write(
        path: &Path,
        names: &[&str],
        position: [i32; 2],
        display: IntegerBounds,
        primaries: Option<Chromaticities>,
    ) {
        let values: Vec<f32> = (1..=12).map(|value| value as f32).collect();
        let channels =
            names.iter().map(|name| AnyChannel::new(*name, FlatSamples::F32(values.clone())));
        let channels = AnyChannels::sort(channels.collect());
        let position = Vec2(position[0], position[1]);
        let attributes = LayerAttributes::default().with_position(position);
        let layer = Layer::new((4, 3), attributes, Encoding::UNCOMPRESSED, channels);
        let mut image = Image::from_layer(layer);
        image.attributes.display_window = display;
        image.attributes.chromaticities = primaries;
        image.write().to_file(path).unwrap();
    }

    fn red(path: &Path) -> Vec<f32> {
        read_color(path).unwrap().pixels.iter().map(|pixel| pixel.x).collect()
    }

    #[test]
    fn pixels_lie_where_the_file_says() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        let display = IntegerBounds::new((-1, 2), (3, 2));
        let rgb = ["R", "G", "B"];
        for (position, expected) in [
            ([-1, 2], [1.0, 2.0, 3.0, 5.0, 6.0, 7.0]),
            ([-2, 1], [6.0, 7.0, 8.0, 10.0, 11.0, 12.0]),
            ([0, 3], [0.0, 0.0, 0.0, 0.0, 1.0, 2.0]),
            ([2, 2], [0.0; 6]),
            ([-100, 50], [0.0; 6]),
        ] {
            write(&path, &rgb, position, display, None);
            assert_eq!(red(&path), expected, "{position:?}");
            let layers = read_layers(&path).unwrap();
            assert_eq!((layers.width, layers.height), (3, 2));
            assert_eq!(layers.channel("R").unwrap(), expected);
            let remarks = read_picture(&path).unwrap().remarks;
            assert_eq!(remarks.is_empty(), !expected.contains(&0.0), "{remarks:?}");
        }
        write(&path, &rgb, [0, 0], IntegerBounds::new((0, 0), (60_000, 60_000)), None);
        let error = read_color(&path).unwrap_err().to_string();
        assert!(error.contains("60000x60000 pixels at (0, 0)"), "{error}");
    }

    #[test]
    fn luminance_is_grey_and_primaries_are_converted() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        let display = IntegerBounds::new((0, 0), (4, 3));
        let wide = Chromaticities {
            red: Vec2(0.708, 0.292),
            green: Vec2(0.17, 0.797),
            blue: Vec2(0.131, 0.046),
            white: Vec2(0.3127, 0.329),
        };
        for names in [&["Y"][..], &["A", "Y"]] {
            write(&path, names, [0, 0], display, Some(wide));
            let picture = read_picture(&path).unwrap();
            assert_eq!(picture.colors.pixels[11], Vec3::splat(12.0));
            assert!(picture.remarks.is_empty());
        }
        // RY and BY are what Y is, so red and blue are Y * (Y + 1).
        write(&path, &["BY", "RY", "Y"], [0, 0], display, None);
        let pixel = read_color(&path).unwrap().pixels[2];
        let green = (3.0 - 12.0 * 0.2126 - 12.0 * 0.0722) / 0.7152;
        assert!(pixel.abs_diff_eq(Vec3::new(12.0, green, 12.0), 0.01), "{pixel}");

        write(&path, &["B", "G", "R"], [0, 0], display, Some(wide));
        let picture = read_picture(&path).unwrap();
        assert!(picture.colors.pixels[0].abs_diff_eq(Vec3::ONE, 1e-5));
        assert!(picture.remarks[0].contains("Rec. 2020: red (0.7080, 0.2920)"));
        let same = Chromaticities { green: wide.red, ..wide };
        write(&path, &["B", "G", "R"], [0, 0], display, Some(same));
        let picture = read_picture(&path).unwrap();
        assert_eq!(picture.colors.pixels[2], Vec3::splat(3.0));
        assert!(picture.remarks[0].contains("taken as Rec. 709"));
    }
}
