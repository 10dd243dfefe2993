//! The numbers of a material in an MTL.

use super::library::Entry;
use crate::scene::bounds;
use crate::scene::error::SceneError;
use crate::scene::text::{shown, words};
use glam::Vec3;

/// A share of light may be out of [0, 1] by this: exporters round.
const ROUNDING: f64 = 0.005;

impl Entry {
    /// The share of light behind a key.
    pub(super) fn reflectance(&self, key: &str, default: Vec3) -> Result<Vec3, SceneError> {
        let Some(colour) = self.colour(key)? else { return Ok(default) };
        let rounded: Vec<_> = colour.iter().map(|&value| rounded(value, 1.0)).collect();
        bounds::reflectance(&rounded).map_err(|what| self.error(key, what))
    }

    /// The share of something else than light behind a key.
    pub(super) fn share(&self, key: &str, default: f64) -> Result<f32, SceneError> {
        let value = rounded(self.number(key)?.unwrap_or(default), 1.0);
        bounds::share(value).map_err(|what| self.error(key, what))
    }

    /// The radiance behind a key.
    pub(super) fn radiance(&self, key: &str) -> Result<Vec3, SceneError> {
        let Some(colour) = self.colour(key)? else { return Ok(Vec3::ZERO) };
        let rounded: Vec<_> = colour.iter().map(|&value| rounded(value, f64::MAX)).collect();
        bounds::radiance(&rounded).map_err(|what| self.error(key, what))
    }

    /// Three numbers; a single one stands for all three. Spectra, which are not read, count as
    /// absent.
    fn colour(&self, key: &str) -> Result<Option<Vec<f64>>, SceneError> {
        let Some(value) = self.keys.get(key).filter(|_| !self.is_spectrum(key)) else {
            return Ok(None);
        };
        let numbers: Vec<f64> = words(&value.text)
            .take(3)
            .map(|word| self.parse(key, word))
            .collect::<Result<_, _>>()?;
        match numbers[..] {
            [grey] => Ok(Some(vec![grey; 3])),
            [_, _, _] => Ok(Some(numbers)),
            _ => {
                Err(self.error(key, format!("must be one or three numbers, has {}", numbers.len())))
            }
        }
    }

    /// The number behind a key.
    pub(super) fn number(&self, key: &str) -> Result<Option<f64>, SceneError> {
        let word = self.keys.get(key).and_then(|value| words(&value.text).next());
        word.map(|word| self.parse(key, word)).transpose()
    }

    /// All numbers behind a key, where they are no more than a hint.
    pub(super) fn hints(&self, key: &str) -> Vec<f64> {
        let Some(value) = self.keys.get(key) else { return Vec::new() };
        words(&value.text)
            .filter_map(|word| std::str::from_utf8(word).ok()?.parse().ok())
            .filter(|number: &f64| number.is_finite())
            .collect()
    }

    /// Whether a colour is given in a way that is not read.
    pub(super) fn is_spectrum(&self, key: &str) -> bool {
        let first = self.keys.get(key).and_then(|value| words(&value.text).next());
        first.is_some_and(|word| word == b"spectral" || word == b"xyz")
    }

    fn parse(&self, key: &str, word: &[u8]) -> Result<f64, SceneError> {
        let number = std::str::from_utf8(word).ok().and_then(|word| word.parse().ok());
        number
            .filter(|number: &f64| number.is_finite())
            .ok_or_else(|| self.error(key, format!("`{}` is not a finite number", shown(word))))
    }

    /// What is wrong with the value of a key.
    pub(super) fn error(&self, key: &str, what: String) -> SceneError {
        let value = self.keys.get(key);
        SceneError::Mtl {
            path: self.path.clone(),
            line: value.map_or(0, |value| value.line),
            material: self.name.to_string(),
            key: value.map_or(key, |value| &value.key).to_owned(),
            what,
        }
    }
}

/// What is just out of [0, `most`] is the end of that.
fn rounded(value: f64, most: f64) -> f64 {
    let nearest = value.clamp(0.0, most);
    if (value - nearest).abs() <= ROUNDING { nearest } else { value }
}
