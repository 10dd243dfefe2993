//! Inputs of all formats by chance: none panics, hangs, or takes memory without measure.
//!
//! CONTRIBUTING.md says how to try more of them. Those that found something lie in `corpus/`.

mod memory;
mod models;
mod pictures;
mod scenes;

use raystream_tests::fuzz::Target;
use std::path::Path;

/// Feeds what `run` does with inputs made of `seeds`, and of the inputs that found something.
fn fuzz(
    name: &'static str,
    mut seeds: Vec<Vec<u8>>,
    words: &'static [&'static str],
    repair: fn(&mut [u8]),
    run: impl Fn(&[u8]) + Sync,
) {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus").join(name);
    if let Ok(files) = corpus.read_dir() {
        let mut paths: Vec<_> = files.map(|file| file.unwrap().path()).collect();
        paths.sort();
        seeds.extend(paths.iter().map(|path| std::fs::read(path).unwrap()));
    }
    Target { name, seeds, words, repair, run: &run, peak_memory: &memory::peak }.fuzz();
}

/// Nothing to repair.
fn as_it_is(_: &mut [u8]) {}

/// Corrects the checksums of the chunks of a PNG, as far as it can be told where they are.
fn correct_checksums(bytes: &mut [u8]) {
    const SIGNATURE: &[u8; 8] = b"\x89PNG\r\n\x1a\n";
    if !bytes.starts_with(SIGNATURE) {
        return;
    }
    let mut at = SIGNATURE.len();
    while let Some(length) = bytes.get(at..at + 4) {
        let length = length.iter().fold(0, |number, &byte| number << 8 | usize::from(byte));
        let end = at + 8 + length;
        let Some(chunk) = bytes.get(at + 4..end) else { return };
        let checksum = crc32(chunk).to_be_bytes();
        let Some(place) = bytes.get_mut(end..end + 4) else { return };
        place.copy_from_slice(&checksum);
        at = end + 4;
    }
}

/// The checksum of PNG (ISO 3309).
fn crc32(bytes: &[u8]) -> u32 {
    let one = |crc: u32| if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 };
    !bytes.iter().fold(u32::MAX, |crc, &byte| (0..8).fold(crc ^ u32::from(byte), |crc, _| one(crc)))
}

#[test]
fn checksums_are_those_of_png() {
    assert_eq!(crc32(b"123456789"), 0xcbf4_3926);
}
