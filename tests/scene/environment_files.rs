//! Files of environments, good and bad.

use glam::Vec3;
use image::codecs::hdr::HdrEncoder;
use raystream::image::{ColorImage, Display, write_color};
use raystream::scene::{Environment, LoadOptions};
use std::path::Path;

const WIDTH: u32 = 24;
const HEIGHT: u32 = 12;

/// Radiances of mantissas that both formats have.
fn texels() -> Vec<Vec3> {
    (0..WIDTH * HEIGHT).map(|k| Vec3::new((k % 7) as f32, 0.5, (k / 24) as f32 * 8.0)).collect()
}

fn hdr() -> Vec<u8> {
    let mut bytes = Vec::new();
    let pixels: Vec<_> = texels().iter().map(|texel| image::Rgb(texel.to_array())).collect();
    HdrEncoder::new(&mut bytes).encode(&pixels, WIDTH as usize, HEIGHT as usize).unwrap();
    bytes
}

fn exr(folder: &Path, pixels: Vec<Vec3>) -> Vec<u8> {
    let path = folder.join("written.exr");
    let picture = ColorImage { width: WIDTH, height: HEIGHT, pixels };
    write_color(&path, &picture, &[], &Display::default()).unwrap();
    std::fs::read(path).unwrap()
}

fn load(folder: &Path, bytes: &[u8]) -> Result<(Environment, Vec<String>), String> {
    // By content: the name says nothing.
    let path = folder.join("sky");
    std::fs::write(&path, bytes).unwrap();
    LoadOptions::default().load_environment(&path).map_err(|error| error.to_string())
}

#[test]
fn both_formats_are_read_from_the_top() {
    let folder = tempfile::tempdir().unwrap();
    for bytes in [hdr(), exr(folder.path(), texels())] {
        let (environment, warnings) = load(folder.path(), &bytes).unwrap();
        assert_eq!((environment.width, environment.height), (WIDTH, HEIGHT));
        assert_eq!((environment.rotation, environment.strength), (0.0, 1.0));
        assert_eq!(environment.texels, texels());
        assert!(warnings.is_empty(), "{warnings:?}");
    }
}

#[test]
fn what_is_no_radiance_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let mut pixels = texels();
    pixels[3] = Vec3::new(f32::NAN, -1.0, f32::INFINITY);
    let (environment, warnings) = load(folder.path(), &exr(folder.path(), pixels)).unwrap();
    assert_eq!(environment.texels[3], Vec3::new(0.0, 0.0, 88.0));
    assert!(warnings.len() == 1 && warnings[0].contains("sky: 1 texels"), "{warnings:?}");
}

#[test]
fn other_files_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let mut png = std::io::Cursor::new(Vec::new());
    image::RgbImage::new(2, 1).write_to(&mut png, image::ImageFormat::Png).unwrap();
    let large = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 16000 +X 20000\n".to_vec();
    for (bytes, says) in [
        (png.into_inner(), "neither a Radiance HDR nor an EXR"),
        (Vec::new(), "neither a Radiance HDR nor an EXR"),
        (b"#?RADIANCE\n".to_vec(), "not a usable environment"),
        (large, "not a usable environment"),
        (vec![0x76, 0x2f, 0x31, 0x01, 2, 0], "not a valid EXR"),
    ] {
        let error = load(folder.path(), &bytes).unwrap_err();
        assert!(error.contains("sky: ") && error.contains(says), "{error}");
    }
    let missing = folder.path().join("missing.hdr");
    let error = LoadOptions::default().load_environment(&missing).unwrap_err().to_string();
    assert!(error.contains("missing.hdr: cannot be read"), "{error}");
    let small = LoadOptions { max_memory: 4096, ..LoadOptions::default() };
    std::fs::write(folder.path().join("sky"), hdr()).unwrap();
    let error = small.load_environment(&folder.path().join("sky")).unwrap_err().to_string();
    assert!(error.contains("sky"), "{error}");
}

/// A file cut anywhere, or with any byte changed, is an error that names it, or another picture.
#[test]
fn damaged_files_are_errors() {
    let folder = tempfile::tempdir().unwrap();
    for bytes in [hdr(), exr(folder.path(), texels())] {
        let (mut cut, mut changed) = (0, 0);
        for end in (0..bytes.len()).step_by(7) {
            if let Err(error) = load(folder.path(), &bytes[..end]) {
                assert!(error.contains("sky"), "{error}");
                cut += 1;
            }
        }
        assert!(cut > bytes.len() / 16, "{cut} of {}", bytes.len());
        for place in (0..bytes.len()).step_by(5) {
            for byte in [0, 0xff, bytes[place] ^ 0x80] {
                let mut damaged = bytes.clone();
                damaged[place] = byte;
                if let Err(error) = load(folder.path(), &damaged) {
                    assert!(error.contains("sky"), "{error}");
                    changed += 1;
                }
            }
        }
        assert!(changed > 10, "{changed}");
    }
}
