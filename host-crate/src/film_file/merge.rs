//! Films of one render, added up.

use super::FilmFile;
use super::error::FilmFileError;
use super::header::{Header, Part};
use crate::film::exact;
use crate::render::RenderProgress;
use glam::{DVec3, Vec3};
use raystream_shaders::film::FilmPixel;
use raystream_shaders::film::splats::{COMPONENT_WORDS, HEADER_WORDS};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Adds up the films of different parts of one render, in the order of the parts, one after the
/// other: of no more than two are the pixels in memory.
///
/// Counts and what light tracing has found add up exactly. Radiance is added in double precision:
/// each sum is the one of a single render but for the last of its 48 bits.
///
/// # Errors
/// If a film cannot be read, is of no part, of one that another has as well, or of another render.
pub fn merge(paths: &[PathBuf]) -> Result<FilmFile, FilmFileError> {
    let mut films: BTreeMap<Vec<Part>, &Path> = BTreeMap::new();
    let mut first: Option<(&Path, Header)> = None;
    for path in paths {
        let header = FilmFile::read_header(path)?;
        let parts = parts(path, &header)?;
        let (first_path, first_header) = first.get_or_insert_with(|| (path, header.clone()));
        if let Some(difference) = header.difference(first_header) {
            let (path, other) = (path.to_owned(), first_path.to_path_buf());
            return Err(FilmFileError::Differs { path, difference, other });
        }
        let has_one = |of: &[Part]| of.iter().any(|part| parts.contains(part));
        if let Some((_, other)) = films.iter().find(|(of, _)| has_one(of)) {
            let (path, other) = (path.to_owned(), other.to_path_buf());
            return Err(FilmFileError::Twice { path, other });
        }
        films.insert(parts, path);
    }
    let parts: Vec<Part> = films.keys().flatten().copied().collect();
    let mut films = films.into_values().map(FilmFile::read);
    let mut sum = films.next().ok_or(FilmFileError::Nothing)??;
    let mut sums = sum.checkpoint.radiance.iter().map(Sums::of).collect::<Vec<_>>();
    for film in films {
        let film = film?;
        for (sums, pixel) in sums.iter_mut().zip(&film.checkpoint.radiance) {
            sums.add(&Sums::of(pixel));
        }
        sum.add(film);
    }
    sum.checkpoint.radiance = sums.iter().map(Sums::pixel).collect();
    sum.header.part = None;
    sum.header.merged = parts;
    Ok(sum)
}

/// The parts that a film has.
fn parts(path: &Path, header: &Header) -> Result<Vec<Part>, FilmFileError> {
    let mut parts: Vec<Part> = header.own_parts().collect();
    parts.sort_unstable();
    if parts.is_empty() {
        return Err(FilmFileError::NoPart { path: path.to_owned() });
    }
    Ok(parts)
}

impl FilmFile {
    /// Adds what is not radiance.
    fn add(&mut self, other: Self) {
        self.header.seconds += other.header.seconds;
        if self.header.device != other.header.device {
            self.header.device = "several devices".to_owned();
        }
        if let (Some(own), Some(others)) = (&mut self.checkpoint.splats, &other.checkpoint.splats) {
            add_splats(&mut own.words, &others.words);
        }
        let (own, others) = (self.checkpoint.progress, other.checkpoint.progress);
        self.checkpoint.progress = RenderProgress {
            paths: own.paths + others.paths,
            uniform_samples: own.uniform_samples + others.uniform_samples,
            rounds: own.rounds + others.rounds,
            rest: own.rest,
            skipped_samples: 0,
            feature_samples: own.feature_samples.max(others.feature_samples),
            mean_radiance_bits: own.mean_radiance_bits.or(others.mean_radiance_bits),
        };
        if others.feature_samples > own.feature_samples {
            // All parts see the same first surfaces; some have looked longer.
            self.checkpoint.features = other.checkpoint.features;
        }
    }
}

/// Sums of a pixel, whose words are 24 bits each: the sum of two of them is exact, that of many
/// nearly so.
struct Sums {
    counts: FilmPixel,
    first: DVec3,
    second: DVec3,
    squares: DVec3,
}

impl Sums {
    fn of(pixel: &FilmPixel) -> Self {
        Self {
            counts: *pixel,
            first: exact(pixel.first_sum, pixel.first_low),
            second: exact(pixel.second_sum, pixel.second_low),
            squares: exact(pixel.sum_of_squares, pixel.squares_low),
        }
    }

    fn add(&mut self, other: &Self) {
        self.counts.first_samples += other.counts.first_samples;
        self.counts.second_samples += other.counts.second_samples;
        self.counts.rays = self.counts.rays.wrapping_add(other.counts.rays);
        self.first += other.first;
        self.second += other.second;
        self.squares += other.squares;
    }

    fn pixel(&self) -> FilmPixel {
        let high = |sum: DVec3| sum.as_vec3();
        let low = |sum: DVec3| {
            let low = (sum - sum.as_vec3().as_dvec3()).as_vec3();
            // What is not finite has no rest.
            Vec3::select(low.is_finite_mask(), low, Vec3::ZERO)
        };
        FilmPixel {
            first_sum: high(self.first),
            first_low: low(self.first),
            second_sum: high(self.second),
            second_low: low(self.second),
            sum_of_squares: high(self.squares),
            squares_low: low(self.squares),
            ..self.counts
        }
    }
}

/// Adds numbers of three words each, see [`raystream_shaders::film::splats`].
fn add_splats(words: &mut [u32], others: &[u32]) {
    let header = HEADER_WORDS as usize;
    for (word, other) in words[..header].iter_mut().zip(others) {
        *word = word.saturating_add(*other);
    }
    let component = COMPONENT_WORDS as usize;
    let of_others = others[header..].chunks_exact(component);
    for (sum, other) in words[header..].chunks_exact_mut(component).zip(of_others) {
        let mut carry = 0;
        for (word, other) in sum.iter_mut().zip(other) {
            let total = u64::from(*word) + u64::from(*other) + carry;
            (*word, carry) = (total as u32, total >> 32);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn splats_carry() {
        let mut words = vec![1; HEADER_WORDS as usize];
        let mut others = words.clone();
        words.extend([u32::MAX, u32::MAX, 1]);
        others.extend([1, 0, 2]);
        add_splats(&mut words, &others);
        assert_eq!(words[HEADER_WORDS as usize..], [0, 0, 4]);
        assert!(words[..HEADER_WORDS as usize].iter().all(|&word| word == 2));
    }

    #[test]
    fn sums_keep_both_words() {
        let exact = 1.0 + 2_f64.powi(-40);
        let pixel = FilmPixel {
            first_sum: Vec3::ONE,
            first_low: Vec3::splat(2_f32.powi(-40)),
            first_samples: 3,
            ..FilmPixel::NOTHING
        };
        let mut sums = Sums::of(&pixel);
        sums.add(&Sums::of(&pixel));
        let sum = sums.pixel();
        assert_eq!(f64::from(sum.first_sum.x) + f64::from(sum.first_low.x), 2.0 * exact);
        assert_eq!(sum.first_samples, 6);
        let infinite = FilmPixel { second_sum: Vec3::INFINITY, ..FilmPixel::NOTHING };
        let sum = Sums::of(&infinite).pixel();
        assert_eq!((sum.second_sum, sum.second_low), (Vec3::INFINITY, Vec3::ZERO));
    }
}
