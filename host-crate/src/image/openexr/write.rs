//! EXR files, written.

use crate::image::replace::replace_file;
use crate::image::{ImageError, LayeredImage};
use exr::meta::attribute::Chromaticities;
use exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Compression, Encoding, FlatSamples, Image, LineOrder,
    Text, Vec2, WritableImage,
};
use std::io::Cursor;
use std::path::Path;

/// What the names of our settings in a header begin with.
pub(super) const SETTING_PREFIX: &str = "raystream.";

/// Writes an EXR file of one part with 32-bit float channels, ZIP compressed, under their full
/// names (`layer.channel`): the form that most programs read. Each of `settings` (key, value)
/// becomes the text attribute `raystream.<key>` of the header, UTF-8.
///
/// The pixels of equal pictures are equal bytes; the attributes of the header are in no fixed
/// order.
///
/// # Errors
/// [`ImageError`] if a channel does not fit the picture's size, a key is empty, used twice or not
/// made of ASCII letters, digits, `.`, `_`, `-`, or the file cannot be written. An existing file is
/// then left as it was.
pub fn write_layers(
    path: &Path,
    image: &LayeredImage,
    settings: &[(String, String)],
) -> Result<(), ImageError> {
    replace_file(path, &encode(path, image, settings)?)
}

/// The bytes of the file; `path` is named in errors.
fn encode(
    path: &Path,
    image: &LayeredImage,
    settings: &[(String, String)],
) -> Result<Vec<u8>, ImageError> {
    let size = Vec2(image.width as usize, image.height as usize);
    let mut channels = Vec::new();
    for channel in &image.channels {
        let what = format!("the channel {}", channel.name);
        ImageError::check_buffer(path, &what, channel.values.len(), image.width, image.height)?;
        channels
            .push(AnyChannel::new(text(&channel.name), FlatSamples::F32(channel.values.clone())));
    }
    let encoding = Encoding {
        compression: Compression::ZIP16,
        line_order: LineOrder::Increasing,
        blocks: exr::image::Blocks::ScanLines,
    };
    let mut file = Image::from_encoded_channels(size, encoding, AnyChannels::sort(channels.into()));
    file.attributes.chromaticities = Some(REC_709);
    let attributes = &mut file.layer_data.attributes;
    attributes.software_name = Some(text(concat!("Raystream ", env!("CARGO_PKG_VERSION"))));
    for (key, value) in settings {
        let legal = |c: char| c.is_ascii_alphanumeric() || matches!(c, '.' | '_' | '-');
        let name = text(&format!("{SETTING_PREFIX}{key}"));
        let used = attributes.other.contains_key(&name);
        if key.is_empty() || key.len() > 200 || !key.chars().all(legal) || used {
            return Err(ImageError::SettingKey { path: path.to_owned(), key: key.clone() });
        }
        attributes.other.insert(name, AttributeValue::Text(text(value)));
    }
    let mut bytes = Cursor::new(Vec::new());
    file.write().to_buffered(&mut bytes).map_err(|e| ImageError::Encode {
        path: path.to_owned(),
        format: "EXR",
        reason: e.to_string(),
    })?;
    Ok(bytes.into_inner())
}

/// UTF-8 as it is: the crate's own conversion panics beyond Latin-1.
fn text(string: &str) -> Text {
    Text::from_slice_unchecked(string.as_bytes())
}

const REC_709: Chromaticities = Chromaticities {
    red: Vec2(0.64, 0.33),
    green: Vec2(0.30, 0.60),
    blue: Vec2(0.15, 0.06),
    white: Vec2(0.3127, 0.3290),
};

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::film::Film;
    use crate::image::{
        ColorImage, Display, read_color, read_layers, read_settings, write_color, write_film_as,
    };
    use glam::Vec3;
    use raystream_shaders::estimator::Estimate;
    use raystream_shaders::film::FilmPixel;
    use raystream_shaders::integrator::first_hits::FeaturePixel;

    /// A film without estimates whose every number differs; pixel 0 has no sample, pixel 1 only
    /// one.
    pub fn film(width: u32, height: u32) -> Film {
        let vector = |i: u32, k: u32| Vec3::new(0.1, 1.7, 900.3) * (i * 31 + k) as f32 / 7.0;
        let radiance = |i: u32| FilmPixel {
            first_sum: vector(i, 1),
            first_samples: i / 2,
            second_sum: vector(i, 3) / 3.0,
            second_samples: i - i / 2,
            sum_of_squares: vector(i, 2) * 1e3,
            rays: i,
        };
        let features = |i: u32| FeaturePixel {
            albedo: vector(i, 4),
            hits: i / 2,
            normal: -vector(i, 5),
            depth: i as f32 / 3.0,
            position: vector(i, 6),
            samples: i,
        };
        let pixels = width * height;
        Film::new(
            width,
            height,
            (0..pixels).map(radiance).collect(),
            (0..pixels).map(features).collect(),
        )
    }

    /// [`film`], with estimates, corrections and splats whose every number differs.
    pub fn film_with_estimates(width: u32, height: u32) -> Film {
        let estimate = |i: u32| Estimate {
            filtered: Vec3::new(0.2, 1.9, 700.1) * (i * 17 + 1) as f32 / 3.0,
            squared_error: (i * i) as f32 / 7.0,
        };
        let correction = |i: u32| Vec3::new(0.01, -0.3, 20.3) * i as f32;
        let splat = |i: u32| Vec3::new(0.7, 0.03, 11.0) * i as f32;
        Film {
            estimates: Some((0..width * height).map(estimate).collect()),
            corrections: Some((0..width * height).map(correction).collect()),
            splats: Some((0..width * height).map(splat).collect()),
            ..film(width, height)
        }
    }

    fn bits(values: impl IntoIterator<Item = f32>) -> Vec<u32> {
        values.into_iter().map(f32::to_bits).collect()
    }

    fn pairs(settings: &[(&str, &str)]) -> Vec<(String, String)> {
        settings.iter().map(|(k, v)| (k.to_string(), v.to_string())).collect()
    }

    /// The channels that a film should have in a file.
    fn channels(film: &Film) -> Vec<(String, Vec<f32>)> {
        let mut expected = vec![
            ("depth.Z".to_owned(), film.depth()),
            ("samples.N".to_owned(), film.samples().iter().map(|&n| n as f32).collect()),
        ];
        let mut vectors = vec![
            ("", "RGB", film.color()),
            ("variance.", "RGB", film.variance()),
            ("albedo.", "RGB", film.albedo()),
            ("normal.", "XYZ", film.normal()),
            ("position.", "XYZ", film.position()),
        ];
        for (layer, values) in
            ["first.", "second."].into_iter().zip(film.halves().into_iter().flatten())
        {
            vectors.push((layer, "RGB", values));
        }
        if film.corrections.is_some() {
            vectors.push(("plain.", "RGB", film.plain()));
        }
        if let (Some(estimates), Some(filtered)) = (&film.estimates, film.filtered()) {
            expected
                .push(("error.V".to_owned(), estimates.iter().map(|e| e.squared_error).collect()));
            vectors.push(("filtered.", "RGB", filtered));
        }
        for (layer, components, values) in vectors {
            for (i, component) in components.chars().enumerate() {
                expected
                    .push((format!("{layer}{component}"), values.iter().map(|v| v[i]).collect()));
            }
        }
        expected
    }

    #[test]
    fn every_layer_comes_back_bit_for_bit() {
        let sizes = [(1, 1), (1, 37), (53, 1), (19, 33)];
        let films = sizes
            .map(|(w, h)| film(w, h))
            .into_iter()
            .chain(sizes.map(|(w, h)| film_with_estimates(w, h)));
        for film in films {
            let (width, height) = (film.width, film.height);
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join("film.exr");
            write_film_as(&path, &film, &[], &Display::default()).unwrap();
            let read = read_layers(&path).unwrap();
            assert_eq!((read.width, read.height), (width, height));

            assert_eq!(film.halves().is_some(), width * height > 1);
            let expected = channels(&film);
            assert_eq!(read.channels.len(), expected.len());
            for (name, values) in expected {
                let channel = read.channel(&name).unwrap_or_else(|| panic!("no {name}"));
                assert_eq!(bits(channel.iter().copied()), bits(values), "{name}");
            }
            let color = read_color(&path).unwrap();
            assert_eq!((color.width, color.height), (width, height));
            let flat = |pixels: &[Vec3]| bits(pixels.iter().flat_map(Vec3::to_array));
            assert_eq!(flat(&color.pixels), flat(&film.color()));
            assert_eq!(
                std::fs::read_dir(folder.path()).unwrap().count(),
                1,
                "no file but the picture"
            );
        }
    }

    #[test]
    fn strange_numbers_survive() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("strange.exr");
        let strange = Vec3::new(f32::NAN, f32::NEG_INFINITY, -0.0);
        let image = ColorImage {
            width: 2,
            height: 1,
            pixels: vec![strange, Vec3::new(f32::MAX, 1e-45, -1.0)],
        };
        write_color(&path, &image, &[], &Display::default()).unwrap();
        let flat = |image: &ColorImage| bits(image.pixels.iter().flat_map(Vec3::to_array));
        assert_eq!(flat(&read_color(&path).unwrap()), flat(&image));
        assert_eq!(read_layers(&path).unwrap().channels.len(), 3);
    }

    #[test]
    fn settings_are_in_the_header() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        let long = "x".repeat(5000);
        let settings = pairs(&[
            ("scene", "Šibenik 大聖堂 \"a\\b\"\n"),
            ("seed", "7"),
            ("empty", ""),
            ("a.long-key_0", &long),
        ]);
        write_film_as(&path, &film(3, 2), &settings, &Display::default()).unwrap();
        assert_eq!(read_settings(&path).unwrap(), settings.iter().cloned().collect());
        let bytes = std::fs::read(&path).unwrap();
        assert!(bytes.windows(14).any(|w| w == b"raystream.seed"), "under the documented name");
    }

    #[test]
    fn unfit_keys_and_buffers_are_refused_and_the_old_file_stays() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        std::fs::write(&path, b"old").unwrap();
        let long = "k".repeat(201);
        for keys in [&[""][..], &["a b"], &["ü"], &["a\0"], &["a", "a"], &[&long]] {
            let settings: Vec<_> = keys.iter().map(|k| (k.to_string(), "v".to_string())).collect();
            let error =
                write_film_as(&path, &film(1, 1), &settings, &Display::default()).unwrap_err();
            assert!(matches!(error, ImageError::SettingKey { .. }), "{error}");
        }
        let mut short = film(3, 2);
        short.features.pop();
        let error = write_film_as(&path, &short, &[], &Display::default()).unwrap_err().to_string();
        assert!(
            error.contains("a.exr")
                && error.contains("the features has 5 values")
                && error.contains("3x2")
        );
        let mut short = film_with_estimates(3, 2);
        short.estimates.as_mut().unwrap().pop();
        let error = write_film_as(&path, &short, &[], &Display::default()).unwrap_err().to_string();
        assert!(error.contains("the estimates has 5 values"), "{error}");
        write_film_as(&path, &film(0, 0), &[], &Display::default()).unwrap_err();
        assert_eq!(std::fs::read(&path).unwrap(), b"old");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}
