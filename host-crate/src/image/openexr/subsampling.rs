//! Channels that have values at every second pixel only, as chroma usually does.
//!
//! The crate `exr` decompresses them, but refuses headers that have them. So it is given headers
//! that do not say so, and told what they said where it matters.

use exr::block::chunk::{Chunk, CompressedBlock, CompressedScanLineBlock, CompressedTileBlock};
use exr::compression::Compression;
use exr::error::{Error, Result};
use exr::math::Vec2;
use exr::meta::attribute::{ChannelDescription, ChannelList, IntegerBounds, SampleType};
use exr::meta::header::Header;
use std::borrow::Cow;

/// A part's channels by name, each with the distance of its samples in pixels, x and y.
pub(super) type Samplings = Vec<(Vec<u8>, [usize; 2])>;

/// The bytes of a file whose channels have a value at every pixel, as the header then says; and for
/// each part what it said before, where that can be told.
pub(super) fn hide(bytes: &[u8]) -> (Cow<'_, [u8]>, Vec<Samplings>) {
    let mut parts = Vec::new();
    let mut places = Vec::new();
    // A header that is not understood here is left for the crate to judge.
    let _ = find(bytes, &mut parts, &mut places);
    let mut bytes = Cow::Borrowed(bytes);
    for place in places {
        bytes.to_mut()[place..place + 8].copy_from_slice(&[1, 0, 0, 0, 1, 0, 0, 0]);
    }
    (bytes, parts)
}

/// The samplings of all parts, and where in the file those stand that are not 1.
fn find(bytes: &[u8], parts: &mut Vec<Samplings>, places: &mut Vec<usize>) -> Option<()> {
    let version = u32::from_le_bytes(bytes.get(4..8)?.try_into().ok()?);
    let is_multipart = version & 0x1000 != 0;
    let mut at = 8;
    while bytes.get(at).is_some_and(|&first| first != 0) {
        let mut part = Samplings::new();
        loop {
            let name = text(bytes, &mut at)?;
            if name.is_empty() {
                break;
            }
            let _kind = text(bytes, &mut at)?;
            let size = usize::try_from(integer(bytes, &mut at)?).ok()?;
            let end = at.checked_add(size)?;
            if name == b"channels" {
                part = channels(bytes.get(..end)?, at, places)?;
            }
            at = end;
        }
        parts.push(part);
        if !is_multipart {
            break;
        }
    }
    Some(())
}

/// The channels of the list at `at`.
fn channels(bytes: &[u8], mut at: usize, places: &mut Vec<usize>) -> Option<Samplings> {
    let mut channels = Vec::new();
    loop {
        let name = text(bytes, &mut at)?;
        if name.is_empty() {
            return Some(channels);
        }
        // The type of the values, and how they are quantised.
        at += 8;
        let place = at;
        let sampling = [integer(bytes, &mut at)?, integer(bytes, &mut at)?];
        // Only these are read: what else there is shall be refused.
        if sampling.iter().all(|step| (1..=2).contains(step)) {
            if sampling != [1, 1] {
                places.push(place);
            }
            channels.push((name.to_owned(), sampling.map(|step| step as usize)));
        }
    }
}

/// Bytes up to a zero, which is passed.
fn text<'a>(bytes: &'a [u8], at: &mut usize) -> Option<&'a [u8]> {
    let rest = bytes.get(*at..)?;
    let length = rest.iter().take(256).position(|&byte| byte == 0)?;
    *at += length + 1;
    Some(&rest[..length])
}

fn integer(bytes: &[u8], at: &mut usize) -> Option<i32> {
    let value = bytes.get(*at..at.checked_add(4)?)?;
    *at += 4;
    Some(i32::from_le_bytes(value.try_into().ok()?))
}

/// The header of a part with the samplings that it had before [`hide`].
///
/// # Errors
/// Where the crate would have said so: samples that do not lie in the data window as they should.
pub(super) fn restore(header: &mut Header, samplings: &[(Vec<u8>, [usize; 2])]) -> Result<()> {
    let position = header.own_attributes.layer_position;
    for (name, sampling) in samplings {
        let channel = header.channels.list.iter_mut().find(|c| c.name.as_slice() == *name);
        let Some(channel) = channel else { continue };
        let [x, y] = *sampling;
        let is_whole = |place: i32, size: usize, step: usize| {
            place.rem_euclid(step as i32) == 0 && size.is_multiple_of(step)
        };
        let Vec2(width, height) = header.layer_size;
        if !is_whole(position.0, width, x) || !is_whole(position.1, height, y) {
            return Err(invalid("a channel's sampling does not divide the data window"));
        }
        let is_flat = matches!(header.blocks, exr::meta::BlockDescription::ScanLines);
        if !is_flat && sampling != &[1, 1] {
            return Err(invalid("a subsampled channel in tiles"));
        }
        channel.sampling = Vec2(x, y);
    }
    Ok(())
}

/// Decompresses a block of a part, whose `header` has its true samplings, and tells `copy` each of
/// its lines.
///
/// # Errors
/// Where the block is damaged, deep or not of the whole picture, or `copy` fails.
pub(super) fn decompress(
    chunk: Chunk,
    header: &mut Header,
    mut copy: impl FnMut(&Line<'_>) -> Result<()>,
) -> Result<()> {
    let coordinates = header.get_block_data_indices(&chunk.compressed_block)?;
    let area = header.get_absolute_block_pixel_coordinates(coordinates)?;
    area.validate(Some(header.layer_size))?;
    if coordinates.level_index != Vec2(0, 0) {
        return Err(invalid("a block of another level"));
    }
    let (CompressedBlock::ScanLine(CompressedScanLineBlock { compressed_pixels_le, .. })
    | CompressedBlock::Tile(CompressedTileBlock { compressed_pixels_le, .. })) =
        chunk.compressed_block
    else {
        return Err(Error::NotSupported("deep data".into()));
    };
    let places = places(header, area)?;
    let size = places.last().map_or(0, |place| place.bytes.end);
    let is_subsampled = header.channels.list.iter().any(|c| c.sampling != Vec2(1, 1));
    let is_b44 = matches!(header.compression, Compression::B44 | Compression::B44A);
    let bytes = if is_subsampled && is_b44 && compressed_pixels_le.len() != size {
        decompress_b44(header, &compressed_pixels_le, area, &places)?
    } else {
        decompress_whole(header, compressed_pixels_le, area, size)?
    };
    for place in places {
        let bytes = bytes.get(place.bytes).ok_or_else(|| invalid("a block cut short"))?;
        copy(&Line { channel: place.channel, first: place.first, bytes })?;
    }
    Ok(())
}

/// The bytes of a block, `size` in all.
fn decompress_whole(
    header: &mut Header,
    compressed: Vec<u8>,
    area: IntegerBounds,
    size: usize,
) -> Result<Vec<u8>> {
    let pixels = area.size.area().max(1);
    if !size.is_multiple_of(pixels) {
        return Err(Error::NotSupported("a subsampled channel of this type".into()));
    }
    // The crate takes the size of a block to be this many bytes for each pixel.
    header.channels.bytes_per_pixel = size / pixels;
    header.compression.decompress_image_section_from_le(header, compressed, area, false)
}

/// The bytes of a block in B44, whose channels lie one after the other: each is decompressed by
/// itself, since the crate miscounts the samples of those that are subsampled.
fn decompress_b44(
    header: &Header,
    mut compressed: &[u8],
    area: IntegerBounds,
    places: &[Place],
) -> Result<Vec<u8>> {
    let mut bytes = vec![0; places.last().map_or(0, |place| place.bytes.end)];
    for (index, channel) in header.channels.list.iter().enumerate() {
        let size = area.size / channel.sampling;
        let mut alone = header.clone();
        let sampling = Vec2(1, 1);
        let channels = [ChannelDescription { sampling, ..channel.clone() }];
        alone.channels = ChannelList::new(channels.into_iter().collect());
        let length = b44_length(compressed, channel.sample_type, size);
        let (own, rest) = compressed.split_at_checked(length).ok_or_else(cut_short)?;
        compressed = rest;
        let raw = size.area() * channel.sample_type.bytes_per_sample();
        let mut own = own.to_vec();
        if own.len() == raw && channel.sample_type == SampleType::F16 {
            // The crate takes a block of this length for one that is not compressed.
            own.push(0);
        }
        let area = IntegerBounds::new(Vec2(0, 0), size);
        let plane = decompress_whole(&mut alone, own, area, raw)?;
        let mut rest = plane.as_slice();
        for place in places.iter().filter(|place| place.channel == index) {
            let (row, below) = rest.split_at_checked(place.bytes.len()).ok_or_else(cut_short)?;
            bytes[place.bytes.clone()].copy_from_slice(row);
            rest = below;
        }
    }
    Ok(bytes)
}

/// How many bytes a channel takes in B44: half floats in groups of 4x4, of 14 bytes or of 3 where
/// all are alike; all else as it is.
fn b44_length(compressed: &[u8], kind: SampleType, size: Vec2<usize>) -> usize {
    if kind != SampleType::F16 {
        return size.area() * kind.bytes_per_sample();
    }
    let groups = size.0.div_ceil(4) * size.1.div_ceil(4);
    (0..groups).fold(0, |at, _| {
        let is_flat = compressed.get(at + 2).is_some_and(|&third| third >= 13 << 2);
        at + if is_flat { 3 } else { 14 }
    })
}

/// A file is damaged, and how.
pub(super) fn invalid(what: &'static str) -> Error {
    Error::Invalid(what.into())
}

fn cut_short() -> Error {
    invalid("a block cut short")
}

/// The samples of one channel in one row.
pub(super) struct Line<'a> {
    /// Index of the channel.
    pub channel: usize,
    /// Where it begins in the plane of the channel's samples.
    pub first: usize,
    /// The samples, in the byte order of this machine.
    pub bytes: &'a [u8],
}

/// Where a line lies in a block, in bytes, and in its plane.
struct Place {
    channel: usize,
    first: usize,
    bytes: std::ops::Range<usize>,
}

/// The lines of a block, in their order.
fn places(header: &Header, area: IntegerBounds) -> Result<Vec<Place>> {
    let Vec2(left, top) = area.position.to_usize("a block's position")?;
    let mut places = Vec::new();
    let mut end = 0;
    for y in top..top + area.size.1 {
        for (index, channel) in header.channels.list.iter().enumerate() {
            let Vec2(step_x, step_y) = channel.sampling;
            if !y.is_multiple_of(step_y) {
                continue;
            }
            let begin = end;
            end += area.size.0 / step_x * channel.sample_type.bytes_per_sample();
            let first = y / step_y * (header.layer_size.0 / step_x) + left / step_x;
            places.push(Place { channel: index, first, bytes: begin..end });
        }
    }
    Ok(places)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{read_color, read_layers};
    use exr::prelude::f16;
    use glam::Vec3;

    /// The channels, in the order of a file, and the distance of their samples.
    const STEPS: [(&str, usize); 3] = [("BY", 2), ("RY", 2), ("Y", 1)];

    /// A file of half floats whose chroma has a value at every second pixel, that begins at
    /// `left`, `top` and is shown from (0, 0) on.
    fn file(compression: Compression, [left, top]: [i32; 2], size: [usize; 2]) -> Vec<u8> {
        let bytes = header(compression, [left, top], size);
        let (shown, _) = hide(&bytes);
        let reader = exr::block::read(std::io::Cursor::new(&*shown), false).unwrap();
        let lines = compression.scan_lines_per_block();
        let firsts = (0..size[1]).step_by(lines);
        let blocks = firsts.map(|first| {
            let rows = first..size[1].min(first + lines);
            let block = block(&reader.headers()[0], compression, size[0], rows);
            integers(&[top + first as i32, block.len() as i32]).into_iter().chain(block).collect()
        });
        with_offsets(&bytes, &blocks.collect::<Vec<_>>())
    }

    fn integers(values: &[i32]) -> Vec<u8> {
        values.iter().flat_map(|value| value.to_le_bytes()).collect()
    }

    fn header(compression: Compression, [left, top]: [i32; 2], size: [usize; 2]) -> Vec<u8> {
        let attribute = |name: &str, kind: &str, value: &[u8]| {
            let size = integers(&[value.len() as i32]);
            [name.as_bytes(), b"\0", kind.as_bytes(), b"\0", &size, value].concat()
        };
        let [width, height] = size.map(|size| size as i32);
        let window = |left, top| integers(&[left, top, left + width - 1, top + height - 1]);
        let channels = STEPS.map(|(name, step)| {
            [name.as_bytes(), b"\0", &integers(&[1, 0, step as i32, step as i32])].concat()
        });
        let code = if compression == Compression::B44 { 6 } else { 0 };
        [
            [0x76, 0x2f, 0x31, 0x01, 2, 0, 0, 0].to_vec(),
            attribute("channels", "chlist", &[&*channels.concat(), b"\0"].concat()),
            attribute("compression", "compression", &[code]),
            attribute("dataWindow", "box2i", &window(left, top)),
            attribute("displayWindow", "box2i", &window(0, 0)),
            attribute("lineOrder", "lineOrder", &[0]),
            attribute("pixelAspectRatio", "float", &1.0_f32.to_le_bytes()),
            attribute("screenWindowCenter", "v2f", &[0; 8]),
            attribute("screenWindowWidth", "float", &1.0_f32.to_le_bytes()),
            vec![0],
        ]
        .concat()
    }

    /// The bytes of some rows.
    fn block(
        header: &Header,
        compression: Compression,
        width: usize,
        rows: std::ops::Range<usize>,
    ) -> Vec<u8> {
        if compression == Compression::B44 {
            let channels = STEPS.iter().enumerate().map(|(index, (_, step))| {
                let size = Vec2(width / step, rows.len() / step);
                let mut alone = header.clone();
                let channel = header.channels.list[index].clone();
                alone.channels = ChannelList::new([channel].into_iter().collect());
                let values = [half(index)].repeat(size.area()).concat();
                let area = IntegerBounds::new(Vec2(0, 0), size);
                compression.compress_image_section_to_le(&alone, values, area).unwrap()
            });
            return channels.collect::<Vec<_>>().concat();
        }
        let lines = rows.flat_map(|y| STEPS.iter().enumerate().map(move |line| (y, line)));
        let lines = lines.filter(|(y, (_, (_, step)))| y.is_multiple_of(*step));
        let lines =
            lines.map(|(_, (index, (_, step)))| [half(index)].repeat(width / step).concat());
        lines.collect::<Vec<_>>().concat()
    }

    /// BY, RY, Y of (0.5, 0.25, 0.125), as half floats.
    fn half(channel: usize) -> [u8; 2] {
        let y = 0.2126 * 0.5 + 0.7152 * 0.25 + 0.0722 * 0.125;
        let value: f32 = [(0.125 - y) / y, (0.5 - y) / y, y][channel];
        f16::from_f32(value).to_le_bytes()
    }

    /// A header, the offsets of the blocks, and the blocks.
    fn with_offsets(header: &[u8], blocks: &[Vec<u8>]) -> Vec<u8> {
        let mut bytes = header.to_vec();
        let mut offset = (header.len() + 8 * blocks.len()) as u64;
        for block in blocks {
            bytes.extend(offset.to_le_bytes());
            offset += block.len() as u64;
        }
        bytes.extend(blocks.concat());
        bytes
    }

    #[test]
    fn chroma_at_every_second_pixel_is_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        for compression in [Compression::Uncompressed, Compression::B44] {
            std::fs::write(&path, file(compression, [0, 0], [16, 64])).unwrap();
            let image = read_color(&path).unwrap();
            assert_eq!((image.width, image.height, image.pixels.len()), (16, 64, 1024));
            for pixel in image.pixels {
                assert!(pixel.abs_diff_eq(Vec3::new(0.5, 0.25, 0.125), 1e-3), "{pixel}");
            }
            let layers = read_layers(&path).unwrap();
            assert!(layers.channels.iter().all(|channel| channel.values.len() == 1024));

            std::fs::write(&path, file(compression, [-4, 6], [16, 64])).unwrap();
            let shifted = read_color(&path).unwrap();
            let shown = |x: usize, y: usize| shifted.pixels[y * 16 + x] != Vec3::ZERO;
            let all = (0..64).flat_map(|y| (0..16).map(move |x| (x, y)));
            assert!(all.into_iter().all(|(x, y)| shown(x, y) == (x < 12 && y >= 6)));
        }
    }

    #[test]
    fn samplings_that_do_not_fit_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        let whole = file(Compression::Uncompressed, [0, 0], [10, 36]);
        for (position, size) in [([1, 0], [10, 36]), ([0, 1], [10, 36])] {
            std::fs::write(&path, file(Compression::Uncompressed, position, size)).unwrap();
            let error = read_color(&path).unwrap_err().to_string();
            assert!(error.contains("sampling"), "{error}");
        }
        // In place of 2: three pixels, none, and a negative number of them.
        let place = whole.windows(3).position(|w| w == b"BY\0").unwrap() + 3 + 8;
        for step in [3_i32, 0, -1] {
            let mut damaged = whole.clone();
            damaged[place..place + 4].copy_from_slice(&step.to_le_bytes());
            std::fs::write(&path, damaged).unwrap();
            read_color(&path).unwrap_err();
        }
        for length in 0..whole.len() {
            std::fs::write(&path, &whole[..length]).unwrap();
            read_color(&path).unwrap_err();
        }
    }
}
