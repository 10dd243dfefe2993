//! Films of one render, added up.

use super::FilmFile;
use super::error::FilmFileError;
use super::header::{Header, Part};
use crate::render::RenderProgress;
use glam::UVec4;
use rayon::prelude::*;
use raystream_shaders::film::splats::HEADER_WORDS;
use raystream_shaders::math::fixed;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Adds up the films of different parts of one render, in the order of the parts, one after the
/// other: of no more than two are the pixels in memory.
///
/// Sums add up exactly: films of parts of the same samples are the film of one render of them.
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
    for film in films {
        sum.add(film?);
    }
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
    /// Adds the film of another part.
    fn add(&mut self, other: Self) {
        let pixels = &mut self.checkpoint.radiance;
        pixels.par_iter_mut().zip(&other.checkpoint.radiance).for_each(|(p, q)| p.add_sums(q));
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

/// Adds the words of films of light tracing, see [`raystream_shaders::film::splats`].
fn add_splats(words: &mut [u32], others: &[u32]) {
    let header = HEADER_WORDS as usize;
    for (word, other) in words[..header].iter_mut().zip(others) {
        *word = word.saturating_add(*other);
    }
    let component = fixed::WORDS as usize;
    let of_others = others[header..].chunks_exact(component);
    for (sum, other) in words[header..].chunks_exact_mut(component).zip(of_others) {
        let total = fixed::add(UVec4::from_slice(sum), UVec4::from_slice(other));
        total.write_to_slice(sum);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn splats_carry() {
        let mut words = vec![1; HEADER_WORDS as usize];
        let mut others = words.clone();
        words.extend([u32::MAX, u32::MAX, 1, 7]);
        others.extend([1, 0, 2, 0]);
        add_splats(&mut words, &others);
        assert_eq!(words[HEADER_WORDS as usize..], [0, 0, 4, 7]);
        assert!(words[..HEADER_WORDS as usize].iter().all(|&word| word == 2));
    }
}
