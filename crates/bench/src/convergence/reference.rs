//! The picture that errors are measured against, rendered once and kept.

use super::identity::{Identity, pixels_digest};
use crate::BenchError;
use glam::Vec3;
use raystream::exec::Executor;
use raystream::film::Film;
use raystream::image::{
    Channel, ColorImage, ImageError, LayeredImage, read_layers, read_settings, write_layers,
};
use raystream::render::{
    Budget, IntegratorKind, PreparedScene, Progress, Renderer, Sampling, Settings, run,
};
use std::path::Path;
use std::time::Instant;

/// The seeds of the two halves of references, unlike those of any measured render.
pub const REFERENCE_SEEDS: [u32; 2] = [0x7265_6665, 0x7265_6666];

/// A picture of many samples and how sure it is: the mean of two independent ones.
#[derive(Clone, Debug, PartialEq)]
pub struct Reference {
    /// Mean radiance.
    pub image: ColorImage,
    /// Variance of each pixel's mean, taking samples as independent: an upper bound where they are
    /// stratified. Errors of different pixels are independent, too, unless the integrator is `lvc`.
    pub variance: Vec<Vec3>,
    /// Half the difference of the two pictures, which errs as much as their mean does.
    pub difference: Vec<Vec3>,
    /// Samples per pixel.
    pub samples: u32,
    /// Who computed it.
    pub integrator: IntegratorKind,
}

/// The channels that are stored.
const CHANNELS: [&str; 9] = [
    "R",
    "G",
    "B",
    "variance.R",
    "variance.G",
    "variance.B",
    "difference.R",
    "difference.G",
    "difference.B",
];
/// The header's key for the digest of the pixels.
const PIXELS: &str = "pixels";

impl Reference {
    /// What a reference is rendered with by `integrator` where `settings` are measured.
    pub fn settings(settings: &Settings, integrator: IntegratorKind) -> Settings {
        Settings { seed: REFERENCE_SEEDS[0], sampling: Sampling::UNIFORM, integrator, ..*settings }
    }

    /// Renders one of `samples` per pixel, at least 4. `settings` are those of [`Self::settings`].
    pub fn render<E: Executor>(
        executor: &E,
        scene: &PreparedScene,
        settings: &Settings,
        samples: u32,
        observe: &mut dyn FnMut(&Progress),
    ) -> Result<Self, BenchError> {
        let start = Instant::now();
        let total_paths = Some(
            u64::from(samples) * u64::from(settings.size.width) * u64::from(settings.size.height),
        );
        let mut done = 0;
        let mut half = |seed, samples| -> Result<Film, BenchError> {
            let mut renderer = Renderer::new(executor, scene, &Settings { seed, ..*settings })?;
            let budget = Budget::samples(samples);
            let outcome = run(&mut renderer, budget, &|| false, &mut |progress| {
                observe(&Progress {
                    paths: done + progress.paths,
                    total_paths,
                    elapsed: start.elapsed(),
                    ..*progress
                });
            })?;
            done += outcome.paths;
            Ok(renderer.film()?)
        };
        let first = half(REFERENCE_SEEDS[0], samples - samples / 2)?;
        let second = half(REFERENCE_SEEDS[1], samples / 2)?;
        Ok(Self::of_halves(&first, &second, samples, settings.integrator))
    }

    fn of_halves(first: &Film, second: &Film, samples: u32, integrator: IntegratorKind) -> Self {
        let share = (samples - samples / 2) as f32 / samples as f32;
        let combine = |a: Vec<Vec3>, b: Vec<Vec3>, of_a: f32, of_b: f32| -> Vec<Vec3> {
            a.into_iter().zip(b).map(|(a, b)| a * of_a + b * of_b).collect()
        };
        Self {
            image: ColorImage {
                width: first.width,
                height: first.height,
                pixels: combine(first.color(), second.color(), share, 1.0 - share),
            },
            variance: combine(
                first.variance(),
                second.variance(),
                share * share,
                (1.0 - share) * (1.0 - share),
            ),
            difference: combine(first.color(), second.color(), 0.5, -0.5),
            samples,
            integrator,
        }
    }

    /// The RMSE that the reference itself has, by the difference of its halves.
    pub fn noise(&self) -> f64 {
        let sum: f64 = self.difference.iter().map(|d| d.as_dvec3().length_squared()).sum();
        (sum / (3.0 * self.difference.len().max(1) as f64)).sqrt()
    }

    /// Writes it to the EXR file `path` with `identity`.
    pub fn store(&self, path: &Path, identity: &Identity) -> Result<(), ImageError> {
        let component = |vectors: &[Vec3], c: usize| vectors.iter().map(|v| v[c]).collect();
        let channels = CHANNELS
            .iter()
            .enumerate()
            .map(|(i, name)| Channel {
                name: (*name).to_owned(),
                values: component(
                    [&self.image.pixels, &self.variance, &self.difference][i / 3],
                    i % 3,
                ),
            })
            .collect();
        let image = LayeredImage { width: self.image.width, height: self.image.height, channels };
        let mut header = identity.0.clone();
        header.push((PIXELS.into(), pixels_digest(&image)));
        write_layers(path, &image, &header)
    }

    /// Reads what [`Self::store`] wrote of a picture of `samples` per pixel by `integrator`;
    /// nothing if there is no such file.
    ///
    /// # Errors
    /// Why the file cannot be used: it cannot be read, is damaged, or is a picture of something
    /// else.
    pub fn load(
        path: &Path,
        identity: &Identity,
        samples: u32,
        integrator: IntegratorKind,
    ) -> Result<Option<Self>, String> {
        if !path.try_exists().map_err(|error| error.to_string())? {
            return Ok(None);
        }
        let settings = read_settings(path).map_err(|error| error.to_string())?;
        let differences = identity.differences(&settings);
        if !differences.is_empty() {
            return Err(format!("it differs in {}", differences.join(", ")));
        }
        let image = read_layers(path).map_err(|error| error.to_string())?;
        if settings.get(PIXELS) != Some(&pixels_digest(&image)) {
            return Err("its pixels are damaged".into());
        }
        let channel =
            |name: &str| image.channel(name).ok_or_else(|| format!("it has no channel {name}"));
        let vectors = |names: &[&str]| -> Result<Vec<Vec3>, String> {
            let [x, y, z] = [channel(names[0])?, channel(names[1])?, channel(names[2])?];
            Ok(x.iter().zip(y).zip(z).map(|((&x, &y), &z)| Vec3::new(x, y, z)).collect())
        };
        let pixels = vectors(&CHANNELS[..3])?;
        let variance = vectors(&CHANNELS[3..6])?;
        let difference = vectors(&CHANNELS[6..])?;
        Ok(Some(Self {
            image: ColorImage { width: image.width, height: image.height, pixels },
            variance,
            difference,
            samples,
            integrator,
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reference() -> Reference {
        let vectors =
            |scale: f32| (0..6).map(|i| Vec3::new(1.0, 2.0, 3.0) * scale * i as f32).collect();
        Reference {
            image: ColorImage { width: 3, height: 2, pixels: vectors(0.5) },
            variance: vectors(0.1),
            difference: vectors(0.2),
            samples: 9,
            integrator: IntegratorKind::Lvc,
        }
    }

    fn identity(value: &str) -> Identity {
        Identity(vec![("scene".into(), value.into()), ("seed".into(), "1".into())])
    }

    fn load(path: &Path, value: &str) -> Result<Option<Reference>, String> {
        Reference::load(path, &identity(value), 9, IntegratorKind::Lvc)
    }

    #[test]
    fn the_halves_tell_the_noise_of_their_mean() {
        use raystream_shaders::film::FilmPixel;
        // Means of 2 samples: 1 and 3, the samples of each 1 apart from their mean.
        let film = |mean: f32| {
            let sum_of_squares = Vec3::splat((mean - 1.0).powi(2) + (mean + 1.0).powi(2));
            let pixel = FilmPixel {
                first_sum: Vec3::splat(2.0 * mean),
                first_samples: 2,
                sum_of_squares,
                ..Default::default()
            };
            Film::new(1, 1, vec![pixel], Vec::new())
        };
        let reference = Reference::of_halves(&film(1.0), &film(3.0), 4, IntegratorKind::Lvc);
        assert_eq!(reference.image.pixels, [Vec3::splat(2.0)]);
        assert_eq!(reference.noise(), 1.0);
        // The variance of a mean of 2 is 1, that of the mean of two such means half of it.
        assert_eq!(reference.variance, [Vec3::splat(0.5)]);
    }

    #[test]
    fn what_was_stored_comes_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        assert_eq!(load(&path, "one"), Ok(None));
        reference().store(&path, &identity("one")).unwrap();
        assert_eq!(load(&path, "one"), Ok(Some(reference())));
        assert_eq!(load(&path, "two"), Err("it differs in scene".into()));
    }

    #[test]
    fn damage_is_found_wherever_it_is() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        reference().store(&path, &identity("one")).unwrap();
        let whole = std::fs::read(&path).unwrap();
        for length in 0..whole.len() {
            std::fs::write(&path, &whole[..length]).unwrap();
            assert!(load(&path, "one").is_err(), "cut to {length} bytes");
        }
        for position in 0..whole.len() {
            let mut damaged = whole.clone();
            damaged[position] ^= 0x10;
            std::fs::write(&path, &damaged).unwrap();
            // Some bytes mean nothing to the pixels (the name of the software, say).
            if let Ok(found) = load(&path, "one") {
                assert_eq!(found, Some(reference()), "byte {position}");
            }
        }
    }
}
