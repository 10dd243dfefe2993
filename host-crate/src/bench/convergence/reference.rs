//! The picture that errors are measured against, rendered once and kept.

use super::identity::{Identity, pixels_digest};
use crate::bench::BenchError;
use crate::exec::Executor;
use crate::film::Film;
use crate::image::{Channel, ColorImage, ImageError, LayeredImage, read_layers, read_settings, write_layers};
use crate::render::{Budget, PreparedScene, Progress, Renderer, Sampling, Settings, run};
use glam::Vec3;
use std::path::Path;

/// The seed of references, unlike that of any measured render.
pub const REFERENCE_SEED: u32 = 0x7265_6665;

/// A picture of many samples and how sure it is.
#[derive(Clone, Debug, PartialEq)]
pub struct Reference {
    /// Mean radiance.
    pub image: ColorImage,
    /// Variance of each pixel's mean, taking samples as independent: an upper bound where they are stratified.
    pub variance: Vec<Vec3>,
    /// Samples per pixel.
    pub samples: u32,
}

/// The channels that are stored.
const CHANNELS: [&str; 6] = ["R", "G", "B", "variance.R", "variance.G", "variance.B"];
/// The header's key for the digest of the pixels.
const PIXELS: &str = "pixels";

impl Reference {
    /// What a reference is rendered with where `settings` are measured.
    pub fn settings(settings: &Settings) -> Settings {
        Settings { seed: REFERENCE_SEED, sampling: Sampling::UNIFORM, ..*settings }
    }

    /// Renders one of `samples` per pixel, at least 2. `settings` are those of [`Self::settings`].
    pub fn render<E: Executor>(
        executor: &E,
        scene: &PreparedScene,
        settings: &Settings,
        samples: u32,
        observe: &mut dyn FnMut(&Progress),
    ) -> Result<Self, BenchError> {
        let mut renderer = Renderer::new(executor, scene, settings)?;
        run(&mut renderer, Budget { samples: Some(samples), time: None }, &|| false, observe)?;
        Ok(Self::of_film(&renderer.film()?, samples))
    }

    fn of_film(film: &Film, samples: u32) -> Self {
        Self { image: ColorImage::from_film(film), variance: film.variance(), samples }
    }

    /// Root of the mean variance over pixels and components: the RMSE that the reference itself has, at most.
    pub fn noise(&self) -> f64 {
        let sum: f64 = self.variance.iter().map(|v| v.as_dvec3().element_sum()).sum();
        (sum / (3.0 * self.variance.len().max(1) as f64)).sqrt()
    }

    /// Writes it to the EXR file `path` with `identity`.
    pub fn store(&self, path: &Path, identity: &Identity) -> Result<(), ImageError> {
        let component = |vectors: &[Vec3], c: usize| vectors.iter().map(|v| v[c]).collect();
        let channels = CHANNELS
            .iter()
            .enumerate()
            .map(|(i, name)| Channel {
                name: (*name).to_owned(),
                values: component(if i < 3 { &self.image.pixels } else { &self.variance }, i % 3),
            })
            .collect();
        let image = LayeredImage { width: self.image.width, height: self.image.height, channels };
        let mut header = identity.0.clone();
        header.push((PIXELS.into(), pixels_digest(&image)));
        write_layers(path, &image, &header)
    }

    /// Reads what [`Self::store`] wrote; nothing if there is no such file.
    ///
    /// # Errors
    /// Why the file cannot be used: it cannot be read, is damaged, or is a picture of something else.
    pub fn load(path: &Path, identity: &Identity, samples: u32) -> Result<Option<Self>, String> {
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
        let channel = |name: &str| image.channel(name).ok_or_else(|| format!("it has no channel {name}"));
        let vectors = |names: &[&str]| -> Result<Vec<Vec3>, String> {
            let [x, y, z] = [channel(names[0])?, channel(names[1])?, channel(names[2])?];
            Ok(x.iter().zip(y).zip(z).map(|((&x, &y), &z)| Vec3::new(x, y, z)).collect())
        };
        let pixels = vectors(&CHANNELS[..3])?;
        let variance = vectors(&CHANNELS[3..])?;
        Ok(Some(Self { image: ColorImage { width: image.width, height: image.height, pixels }, variance, samples }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reference() -> Reference {
        let vectors = |scale: f32| (0..6).map(|i| Vec3::new(1.0, 2.0, 3.0) * scale * i as f32).collect();
        Reference {
            image: ColorImage { width: 3, height: 2, pixels: vectors(0.5) },
            variance: vectors(0.1),
            samples: 9,
        }
    }

    fn identity(value: &str) -> Identity {
        Identity(vec![("scene".into(), value.into()), ("seed".into(), "1".into())])
    }

    #[test]
    fn noise_is_the_root_of_the_mean_variance() {
        let mean = 0.1 * (1.0 + 2.0 + 3.0) / 3.0 * 2.5;
        assert!((reference().noise() - f64::sqrt(mean)).abs() < 1e-7);
    }

    #[test]
    fn what_was_stored_comes_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        assert_eq!(Reference::load(&path, &identity("one"), 9), Ok(None));
        reference().store(&path, &identity("one")).unwrap();
        assert_eq!(Reference::load(&path, &identity("one"), 9), Ok(Some(reference())));
        assert_eq!(Reference::load(&path, &identity("two"), 9), Err("it differs in scene".into()));
    }

    #[test]
    fn damage_is_found_wherever_it_is() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        reference().store(&path, &identity("one")).unwrap();
        let whole = std::fs::read(&path).unwrap();
        for length in 0..whole.len() {
            std::fs::write(&path, &whole[..length]).unwrap();
            assert!(Reference::load(&path, &identity("one"), 9).is_err(), "cut to {length} bytes");
        }
        for position in 0..whole.len() {
            let mut damaged = whole.clone();
            damaged[position] ^= 0x10;
            std::fs::write(&path, &damaged).unwrap();
            // Some bytes mean nothing to the pixels (the name of the software, say).
            if let Ok(found) = Reference::load(&path, &identity("one"), 9) {
                assert_eq!(found, Some(reference()), "byte {position}");
            }
        }
    }
}
