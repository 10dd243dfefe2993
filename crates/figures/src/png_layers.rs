//! The layers of a render as pictures that a person can read.

use super::color_map::ColorMap;
use super::error::FigureError;
use glam::Vec3;
use raystream::film::Film;
use raystream::image::{ColorImage, Display, ToneMap, check_film, write_png, write_rgb8};
use std::path::{Path, PathBuf};

/// A layer that has a picture of its own.
#[derive(Clone, Copy)]
enum Layer {
    Filtered,
    Error,
    Samples,
    Albedo,
    Normal,
    Depth,
}

impl Layer {
    /// All of them; without estimates, those that need none.
    fn all(estimates: bool) -> &'static [Layer] {
        const ALL: [Layer; 6] = [
            Layer::Filtered,
            Layer::Error,
            Layer::Samples,
            Layer::Albedo,
            Layer::Normal,
            Layer::Depth,
        ];
        if estimates { &ALL } else { &ALL[2..] }
    }

    /// Beside `picture.png`: `picture.samples.png`.
    fn path(self, picture: &Path) -> PathBuf {
        let name = match self {
            Layer::Filtered => "filtered",
            Layer::Error => "error",
            Layer::Samples => "samples",
            Layer::Albedo => "albedo",
            Layer::Normal => "normal",
            Layer::Depth => "depth",
        };
        picture.with_extension(format!("{name}.png"))
    }
}

/// The files that [`write_png_layers`] writes for the picture at `path`; `estimates` says whether
/// the film will have any.
pub fn png_layer_paths(path: &Path, estimates: bool) -> Vec<PathBuf> {
    Layer::all(estimates).iter().map(|layer| layer.path(path)).collect()
}

/// Writes the layers of a film as PNGs beside the picture at `path`, and gives their paths
/// ([`png_layer_paths`]). Beside `picture.png`:
///
/// | file | |
/// |---|---|
/// | `picture.filtered.png` | the filtered picture, as `display` says; only with estimates |
/// | `picture.error.png` | root of the estimated squared error, in radiance; only with estimates |
/// | `picture.samples.png` | samples of the pixel |
/// | `picture.albedo.png` | mean reflectance of the first surface, sRGB; black where none is |
/// | `picture.normal.png` | 0.5 + 0.5 n of the mean shading normal n, as RGB; grey where none is |
/// | `picture.depth.png` | mean distance of the first surface, world units; black where none is |
///
/// Error, samples and depth are drawn with a legend, as by
/// [`write_color_map`](super::write_color_map).
///
/// # Errors
/// [`FigureError`] if a buffer of the film does not fit its size or a file cannot be written. That
/// file is then left as it was; of the others, some may have been written.
pub fn write_png_layers(
    path: &Path,
    film: &Film,
    display: &Display,
) -> Result<Vec<PathBuf>, FigureError> {
    check_film(path, film)?;
    let layers = Layer::all(film.estimates.is_some());
    layers
        .iter()
        .map(|layer| {
            let path = layer.path(path);
            write_layer(*layer, &path, film, display)?;
            Ok(path)
        })
        .collect()
}

fn write_layer(
    layer: Layer,
    path: &Path,
    film: &Film,
    display: &Display,
) -> Result<(), FigureError> {
    let (width, height) = (film.width, film.height);
    let colors = |pixels: Vec<Vec3>, display: &Display| {
        Ok(write_png(path, &ColorImage { width, height, pixels }, display)?)
    };
    let numbers = |values: &[f32], title: &str, zero: Option<&str>| {
        ColorMap { width, height, values, title, range: None, zero }.write(path)
    };
    match layer {
        Layer::Filtered => colors(film.filtered().unwrap_or_default(), display),
        Layer::Error => {
            let error: Vec<f32> =
                film.squared_error().unwrap_or_default().into_iter().map(f32::sqrt).collect();
            numbers(
                &error,
                "estimated error of the mean radiance (root of the squared error)",
                None,
            )
        }
        Layer::Samples => {
            let counts: Vec<f32> = film.samples().into_iter().map(|n| n as f32).collect();
            numbers(&counts, "samples per pixel", None)
        }
        Layer::Albedo => colors(film.albedo(), &Display { exposure: 0.0, tone_map: ToneMap::Clip }),
        Layer::Normal => {
            // A byte that is no number becomes 0.
            let byte = |component: f32| ((0.5 + 0.5 * component) * 255.0).round() as u8;
            let bytes: Vec<u8> =
                film.normal().iter().flat_map(|n| n.to_array().map(byte)).collect();
            Ok(write_rgb8(path, width, height, &bytes)?)
        }
        Layer::Depth => {
            numbers(&film.depth(), "distance from the camera, world units", Some("no surface"))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::RgbImage;
    use raystream_shaders::estimator::Estimate;
    use raystream_shaders::film::FilmPixel;
    use raystream_shaders::integrator::first_hits::FeaturePixel;

    /// A film without estimates whose pixels differ; pixel 0 has no sample.
    fn film(width: u32, height: u32) -> Film {
        let radiance = |i: u32| FilmPixel {
            first_sum: Vec3::new(0.1, 1.7, 900.3) * i as f32,
            first_samples: i,
            ..Default::default()
        };
        let features = |i: u32| FeaturePixel {
            albedo: Vec3::splat(i as f32 / 2.0),
            hits: i / 2,
            normal: Vec3::new(0.0, 0.6, -0.8) * i as f32,
            depth: i as f32 / 3.0,
            samples: i,
            ..Default::default()
        };
        let pixels = width * height;
        Film::new(
            width,
            height,
            (0..pixels).map(radiance).collect(),
            (0..pixels).map(features).collect(),
        )
    }

    /// [`film`], with estimates that differ.
    fn film_with_estimates(width: u32, height: u32) -> Film {
        let estimate = |i: u32| Estimate {
            filtered: Vec3::new(0.2, 1.9, 700.1) * i as f32,
            squared_error: (i * i) as f32 / 7.0,
        };
        Film { estimates: Some((0..width * height).map(estimate).collect()), ..film(width, height) }
    }

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<_> = std::fs::read_dir(folder)
            .unwrap()
            .map(|e| e.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn every_layer_has_a_file_beside_the_picture() {
        for (film, expected) in [
            (film(16, 12), &["albedo", "depth", "normal", "samples"][..]),
            (
                film_with_estimates(16, 12),
                &["albedo", "depth", "error", "filtered", "normal", "samples"],
            ),
        ] {
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join("a.b.PNG");
            let written = write_png_layers(&path, &film, &Display::default()).unwrap();
            assert_eq!(written, png_layer_paths(&path, film.estimates.is_some()));
            let expected: Vec<_> =
                expected.iter().map(|layer| format!("a.b.{layer}.png")).collect();
            assert_eq!(names(folder.path()), expected);
            for path in written {
                let image = image::open(&path).unwrap();
                assert!(
                    image.width() == 16 && image.height() == 12
                        || image.width() == 240 && image.height() > 30
                );
            }
        }
    }

    /// Two pixels: one with samples of a surface, one without any.
    fn two_pixels() -> Film {
        let seen =
            FilmPixel { first_sum: Vec3::splat(2.0), first_samples: 4, ..Default::default() };
        let surface = FeaturePixel {
            albedo: Vec3::new(4.0, 2.0, 0.0),
            hits: 4,
            normal: Vec3::new(4.0, -4.0, 0.0),
            depth: 12.0,
            samples: 4,
            ..Default::default()
        };
        let estimate =
            |squared_error| Estimate { filtered: Vec3::new(0.5, 0.0, 1.0), squared_error };
        Film {
            estimates: Some(vec![estimate(0.25), estimate(f32::INFINITY)]),
            ..Film::new(
                2,
                1,
                vec![seen, FilmPixel::default()],
                vec![surface, FeaturePixel::default()],
            )
        }
    }

    #[test]
    fn layers_show_what_they_should() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        let display = Display { exposure: 0.0, tone_map: ToneMap::Clip };
        write_png_layers(&path, &two_pixels(), &display).unwrap();
        let pixels = |layer: &str| {
            let image: RgbImage =
                image::open(folder.path().join(format!("a.{layer}.png"))).unwrap().into_rgb8();
            [0, 1].map(|x| image.get_pixel(x, 0).0)
        };
        let (dark, middle, bright) =
            ([68, 1, 84], colorous::VIRIDIS.eval_continuous(0.5).as_array(), [253, 231, 37]);
        assert_eq!(pixels("filtered"), [[188, 0, 255]; 2]);
        assert_eq!(pixels("error"), [middle, [255, 0, 255]]);
        assert_eq!(pixels("samples"), [bright, dark]);
        assert_eq!(pixels("albedo"), [[255, 188, 0], [0; 3]]);
        assert_eq!(pixels("normal"), [[255, 0, 128], [128; 3]]);
        assert_eq!(pixels("depth"), [middle, [0; 3]]);
    }

    #[test]
    fn a_film_without_samples() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        let film =
            Film::new(4, 3, vec![FilmPixel::default(); 12], vec![FeaturePixel::default(); 12]);
        assert_eq!(write_png_layers(&path, &film, &Display::default()).unwrap().len(), 4);
    }

    #[test]
    fn unfit_films_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        let mut film = two_pixels();
        film.estimates.as_mut().unwrap().pop();
        let error = write_png_layers(&path, &film, &Display::default()).unwrap_err();
        assert!(error.to_string().contains("the estimates has 1 values"), "{error}");
        assert_eq!(names(folder.path()), [""; 0]);
    }
}
