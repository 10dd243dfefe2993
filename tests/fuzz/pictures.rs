//! Pictures to compare: EXR and PNG.

use super::{as_it_is, correct_checksums, fuzz};
use glam::Vec3;
use raystream::image::{
    Channel, ColorImage, Display, LayeredImage, decode_picture, write_color, write_layers,
};
use std::path::Path;

/// The bytes of the file that `write` writes.
fn written(name: &str, write: impl Fn(&Path)) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    write(&path);
    std::fs::read(&path).unwrap()
}

fn colors() -> ColorImage {
    let pixels = (0..12).map(|i| Vec3::new(i as f32, 0.5, 1.0 / (1 + i) as f32)).collect();
    ColorImage { width: 4, height: 3, pixels }
}

fn decode(path: &str, bytes: &[u8]) {
    if let Ok(picture) = decode_picture(Path::new(path), bytes) {
        let image = picture.colors;
        assert_eq!(image.pixels.len(), image.width as usize * image.height as usize);
    }
}

#[test]
fn exr_files_by_chance() {
    let layers = |names: &[&str]| {
        let channel = |name: &&str| Channel { name: (*name).into(), values: vec![0.25; 6] };
        let channels = names.iter().map(channel).collect();
        let image = LayeredImage { width: 3, height: 2, channels };
        written("a.exr", |path| write_layers(path, &image, &[]).unwrap())
    };
    let own = written("a.exr", |path| {
        let settings = [("seed".to_owned(), "7".to_owned())];
        write_color(path, &colors(), &settings, &Display::default()).unwrap();
    });
    let seeds = vec![own, layers(&["Y"]), layers(&["A", "BY", "RY", "Y"]), layers(&["x.R", "x.G"])];
    let words = &[
        "channels\0chlist\0",
        "compression\0",
        "dataWindow\0box2i\0",
        "displayWindow\0box2i\0",
        "lineOrder\0",
        "tiles\0tiledesc\0",
        "chromaticities\0chromaticities\0",
        "type\0string\0",
        "deepscanline",
        "R\0",
        "RY\0",
        "BY\0",
    ];
    fuzz("exr", seeds, words, as_it_is, |bytes| decode("a.exr", bytes));
}

#[test]
fn png_files_by_chance() {
    let own = written("a.png", |path| {
        write_color(path, &colors(), &[], &Display::default()).unwrap();
    });
    let grey = written("a.png", |path| {
        image::ImageBuffer::<image::LumaA<u16>, _>::from_raw(1, 2, vec![1_u16, 2, 3, 4])
            .unwrap()
            .save(path)
            .unwrap();
    });
    let words = &["IHDR", "IDAT", "IEND", "PLTE", "tRNS", "iCCP", "acTL", "fcTL", "zTXt"];
    fuzz("png", vec![own, grey], words, correct_checksums, |bytes| decode("a.png", bytes));
}
