//! Arrays of words, packed.
//!
//! The first bytes of all words of a kind, then the second ones and so on: exponents of neighbours
//! are alike, and so are the high bytes of counts, which a compressor sees only where they are side
//! by side. Chunks are packed by themselves, so that all processors can be at it.

use bytemuck::Pod;
use flate2::read::ZlibDecoder;
use flate2::{Compress, Compression, FlushCompress, Status};
use rayon::prelude::*;
use std::io::Read;

/// Elements of a chunk.
const CHUNK: usize = 1 << 14;

/// Chunks of `elements` elements.
pub(super) fn chunks(elements: usize) -> usize {
    elements.div_ceil(CHUNK)
}

/// Packs `elements`, whose sizes are multiples of four bytes.
pub(super) fn pack<T: Pod + Sync>(elements: &[T]) -> Vec<Vec<u8>> {
    elements.par_chunks(CHUNK).map(pack_chunk).collect()
}

fn pack_chunk<T: Pod>(elements: &[T]) -> Vec<u8> {
    let words: Vec<u32> = bytemuck::pod_collect_to_vec(elements);
    let per_element = words.len() / elements.len();
    let mut planes = Vec::with_capacity(4 * words.len());
    for column in 0..per_element {
        for byte in 0..4 {
            let of_column = words.iter().skip(column).step_by(per_element);
            planes.extend(of_column.map(|word| word.to_le_bytes()[byte]));
        }
    }
    compressed(&planes)
}

fn compressed(bytes: &[u8]) -> Vec<u8> {
    let mut packer = Compress::new(Compression::fast(), true);
    let mut packed = Vec::new();
    loop {
        packed.reserve(bytes.len() / 2 + 64);
        let rest = &bytes[packer.total_in() as usize..];
        let status = packer.compress_vec(rest, &mut packed, FlushCompress::Finish);
        if matches!(status, Ok(Status::StreamEnd) | Err(_)) {
            return packed;
        }
    }
}

/// What [`pack`] has packed: `elements` elements of `packed` chunks.
///
/// # Errors
/// If that is not what they hold.
pub(super) fn unpack<T: Pod + Send>(packed: &[&[u8]], elements: usize) -> Result<Vec<T>, String> {
    if packed.len() != chunks(elements) {
        return Err("it has another number of chunks".to_owned());
    }
    let counts = (0..elements).step_by(CHUNK).map(|first| CHUNK.min(elements - first));
    let counted: Vec<_> = packed.iter().zip(counts).collect();
    let unpacked = counted.into_par_iter().map(|(packed, count)| unpack_chunk::<T>(packed, count));
    Ok(unpacked.collect::<Result<Vec<_>, String>>()?.concat())
}

fn unpack_chunk<T: Pod>(packed: &[u8], elements: usize) -> Result<Vec<T>, String> {
    let per_element = size_of::<T>() / size_of::<u32>();
    let mut planes = vec![0; elements * size_of::<T>()];
    let mut reader = ZlibDecoder::new(packed);
    let is_whole = reader.read_exact(&mut planes).is_ok();
    if !is_whole || !matches!(reader.read(&mut [0]), Ok(0)) {
        return Err("a chunk does not hold what it should".to_owned());
    }
    let plane = |column: usize, byte: usize| &planes[(4 * column + byte) * elements..];
    let mut unpacked = vec![T::zeroed(); elements];
    let words: &mut [u32] = bytemuck::cast_slice_mut(&mut unpacked);
    for column in 0..per_element {
        let bytes: [&[u8]; 4] = std::array::from_fn(|byte| plane(column, byte));
        for (element, row) in words.chunks_exact_mut(per_element).enumerate() {
            row[column] = u32::from_le_bytes(bytes.map(|plane| plane[element]));
        }
    }
    Ok(unpacked)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_packed_comes_back() {
        let element = |k: u32| [k, k.wrapping_mul(0x9e37_79b9), 0];
        for count in [1, 2, CHUNK - 1, CHUNK, 2 * CHUNK + 3] {
            let elements: Vec<[u32; 3]> = (0..count as u32).map(element).collect();
            let packed = pack(&elements);
            assert_eq!(packed.len(), chunks(count));
            let packed: Vec<&[u8]> = packed.iter().map(Vec::as_slice).collect();
            assert_eq!(unpack::<[u32; 3]>(&packed, count).unwrap(), elements);
            assert!(unpack::<[u32; 3]>(&packed, count + 1).is_err());
            assert!(unpack::<[u32; 2]>(&packed, count).is_err());
        }
        assert!(unpack::<u32>(&[], 0).unwrap().is_empty());
    }

    #[test]
    fn what_is_alike_takes_little_room() {
        let packed = pack(&vec![[0x3f80_0000_u32, 7, 0, 0]; 3 * CHUNK]);
        let bytes: usize = packed.iter().map(Vec::len).sum();
        assert!(bytes < 3 * CHUNK * 16 / 100, "{bytes}");
    }
}
