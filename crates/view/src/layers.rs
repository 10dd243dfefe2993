//! The layers of a film as pictures for a screen.

use glam::Vec3;
use raystream::film::Film;
use raystream::image::{Display, ToneMap};
use raystream_figures::ColorScale;

/// What of a film is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Layer {
    /// The picture.
    #[default]
    Beauty,
    /// The picture without noise.
    Denoised,
    /// Samples of the pixel.
    Samples,
    /// The estimated error of the pixel.
    Error,
    /// Reflectance of the first surface.
    Albedo,
    /// Shading normal of the first surface.
    Normal,
    /// Distance of the first surface.
    Depth,
}

impl Layer {
    /// All of them, in the order of their keys, 1 to 7.
    pub const ALL: [Self; 7] = [
        Self::Beauty,
        Self::Denoised,
        Self::Samples,
        Self::Error,
        Self::Albedo,
        Self::Normal,
        Self::Depth,
    ];

    /// What it is called.
    pub fn name(self) -> &'static str {
        match self {
            Self::Beauty => "Beauty",
            Self::Denoised => "Denoised",
            Self::Samples => "Samples",
            Self::Error => "Error",
            Self::Albedo => "Albedo",
            Self::Normal => "Normal",
            Self::Depth => "Depth",
        }
    }

    /// The layer of this name, whatever the case.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|layer| layer.name().eq_ignore_ascii_case(name))
    }

    /// What it shows of `film`, in a sentence for a legend.
    pub fn title(self, film: &Film) -> &'static str {
        match self {
            Self::Beauty => "radiance",
            Self::Denoised => "radiance after the filter",
            Self::Samples => "samples per pixel",
            Self::Error if film.estimates.is_some() => "estimated error of the radiance",
            Self::Error => "standard error of the radiance, by the variance of the samples",
            Self::Albedo => "reflectance of the first surface",
            Self::Normal => "normal of the first surface: red +x, green +y, blue +z",
            Self::Depth => "distance from the camera, world units",
        }
    }

    /// Whether exposure and tone map have an effect.
    pub fn is_radiance(self) -> bool {
        matches!(self, Self::Beauty | Self::Denoised)
    }

    /// Whether a film must have all that can be computed of it.
    pub fn wants_all(self) -> bool {
        matches!(self, Self::Denoised | Self::Albedo | Self::Normal | Self::Depth)
    }

    /// Its numbers, if it has one for each pixel.
    pub fn numbers(self, film: &Film) -> Option<Vec<f32>> {
        match self {
            Self::Samples => Some(film.samples().into_iter().map(|n| n as f32).collect()),
            Self::Error => Some(errors(film)),
            Self::Depth => Some(film.depth()),
            _ => None,
        }
    }

    /// The colours that its numbers get, the same in all `films`; None for a layer of colours.
    pub fn scale(self, films: &[&Film]) -> Option<ColorScale> {
        let numbers: Option<Vec<_>> = films.iter().map(|film| self.numbers(film)).collect();
        // A depth of 0 is no depth.
        let zero_is_value = self != Self::Depth;
        numbers.map(|numbers| ColorScale::of(numbers.into_iter().flatten(), zero_is_value))
    }

    /// The pixels of a film, sRGB, row by row from the top; None if it does not have the layer.
    /// `scale` is for layers of numbers.
    pub fn paint(
        self,
        film: &Film,
        display: &Display,
        scale: Option<&ColorScale>,
    ) -> Option<Vec<[u8; 3]>> {
        const TRUE: Display = Display { exposure: 0.0, tone_map: ToneMap::Clip };
        Some(match self {
            Self::Beauty => each(&film.color(), |c| display.srgb8(*c)),
            Self::Denoised => each(&film.denoised()?, |c| display.srgb8(*c)),
            Self::Albedo => each(&film.albedo(), |c| TRUE.srgb8(*c)),
            // A byte that is no number becomes 0.
            Self::Normal => each(&film.normal(), |n| {
                n.to_array().map(|component| ((0.5 + 0.5 * component) * 255.0).round() as u8)
            }),
            Self::Samples | Self::Error | Self::Depth => {
                let scale = scale?;
                each(&self.numbers(film)?, |number| scale.color(*number))
            }
        })
    }
}

/// Errors of the pixels as radiance: by an estimator, or else by the variance.
fn errors(film: &Film) -> Vec<f32> {
    match film.squared_error() {
        Some(squared) => squared.into_iter().map(f32::sqrt).collect(),
        None => film.variance().into_iter().map(deviation).collect(),
    }
}

/// The root of a variance, the mean over the components; 0 where nothing is known of it yet.
fn deviation(variance: Vec3) -> f32 {
    if variance.is_finite() { (variance.dot(Vec3::ONE) / 3.0).sqrt() } else { 0.0 }
}

/// Threads that large pictures are cut for; a renderer on the CPU has the others. A browser's
/// WebAssembly has one.
const PAINTERS: usize = if cfg!(target_family = "wasm") { 1 } else { 4 };

/// Applies `paint` to each value, in several threads where there are many. They are none of those
/// that render: these may be at a batch for a tenth of a second.
fn each<T: Sync>(values: &[T], paint: impl Fn(&T) -> [u8; 3] + Sync) -> Vec<[u8; 3]> {
    let mut painted = vec![[0; 3]; values.len()];
    let part = values.len().div_ceil(PAINTERS).max(1 << 15);
    let paint_part = |to: &mut [[u8; 3]], from: &[T]| {
        to.iter_mut().zip(from).for_each(|(to, from)| *to = paint(from));
    };
    std::thread::scope(|scope| {
        let mut parts = painted.chunks_mut(part).zip(values.chunks(part));
        let own = parts.next();
        for (to, from) in parts {
            scope.spawn(|| paint_part(to, from));
        }
        if let Some((to, from)) = own {
            paint_part(to, from);
        }
    });
    painted
}

#[cfg(test)]
mod tests {
    use super::*;
    use raystream_shaders::estimator::Estimate;
    use raystream_shaders::film::FilmPixel;
    use raystream_shaders::integrator::first_hits::FeaturePixel;

    fn film(width: u32, height: u32) -> Film {
        let radiance = |i: u32| FilmPixel {
            first_sum: Vec3::new(0.1, 1.7, 9.3) * i as f32,
            first_samples: i + 2,
            sum_of_squares: Vec3::splat(1000.0 * i as f32),
            ..FilmPixel::default()
        };
        let features = |i: u32| FeaturePixel {
            albedo: Vec3::splat(0.5),
            hits: i.min(1),
            normal: Vec3::new(0.0, 1.0, -0.5),
            depth: i as f32,
            samples: 1,
            ..FeaturePixel::default()
        };
        let pixels = 0..width * height;
        Film::new(
            width,
            height,
            pixels.clone().map(radiance).collect(),
            pixels.map(features).collect(),
        )
    }

    fn paint(layer: Layer, film: &Film) -> Option<Vec<[u8; 3]>> {
        let scale = layer.scale(&[film]);
        layer.paint(film, &Display::default(), scale.as_ref())
    }

    #[test]
    fn the_picture_is_that_of_a_png() {
        // Enough for several threads.
        let film = film(300, 250);
        let display = Display { exposure: -1.0, tone_map: ToneMap::Aces };
        let painted = Layer::Beauty.paint(&film, &display, None).unwrap();
        assert_eq!(painted.len(), 300 * 250);
        for (pixel, color) in painted.iter().zip(film.color()) {
            assert_eq!(*pixel, display.srgb8(color));
        }
    }

    #[test]
    fn every_layer_has_a_pixel_for_each_of_the_film() {
        let film = film(4, 3);
        for layer in Layer::ALL {
            let painted = paint(layer, &film);
            if layer == Layer::Denoised {
                assert_eq!(painted, None, "there is no filter");
            } else {
                assert_eq!(painted.unwrap().len(), 12, "{layer:?}");
            }
            assert_eq!(Layer::named(&layer.name().to_uppercase()), Some(layer));
        }
        assert_eq!(Layer::named("beaut"), None);
    }

    #[test]
    fn normals_are_bytes_about_the_middle() {
        assert_eq!(paint(Layer::Normal, &film(1, 1)).unwrap(), [[128, 255, 64]]);
    }

    #[test]
    fn numbers_have_the_same_colours_in_both_films() {
        let (one, other) = (film(2, 1), film(9, 1));
        let scale = Layer::Samples.scale(&[&one, &other]).unwrap();
        assert_eq!(scale.range(), Some((2.0, 10.0)));
        let [a, b] = [&one, &other]
            .map(|film| Layer::Samples.paint(film, &Display::default(), Some(&scale)).unwrap());
        assert_eq!(a[1], b[1]);
        assert_ne!(a[1], b[8]);
    }

    #[test]
    fn a_depth_of_nothing_has_no_place_among_the_colours() {
        let film = film(3, 1);
        let scale = Layer::Depth.scale(&[&film]).unwrap();
        assert_eq!(scale.range(), Some((1.0, 2.0)));
        assert_eq!(paint(Layer::Depth, &film).unwrap()[0], [0; 3]);
    }

    #[test]
    fn errors_are_by_the_estimator_if_there_is_one() {
        let mut film = film(2, 1);
        let by_variance = Layer::Error.numbers(&film).unwrap();
        // 3 samples, squares of 1000 in all: the means' squares are small beside that.
        let mean = Vec3::new(0.1, 1.7, 9.3) / 3.0;
        let squared = (Vec3::splat(1000.0 / 3.0) - mean * mean) / 2.0;
        let expected = (squared.dot(Vec3::ONE) / 3.0).sqrt();
        assert!((by_variance[1] - expected).abs() < 1e-3, "{by_variance:?} {expected}");
        film.radiance[0].first_samples = 1;
        assert_eq!(Layer::Error.numbers(&film).unwrap()[0], 0.0, "nothing is known of it");
        film.estimates = Some(vec![Estimate { filtered: Vec3::ONE, squared_error: 0.25 }; 2]);
        assert_eq!(Layer::Error.numbers(&film).unwrap(), [0.5, 0.5]);
    }
}
