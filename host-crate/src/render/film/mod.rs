//! The film in a device's memory.

pub mod control;
pub mod splats;

use crate::exec::{Array, ExecError, Executor};
use crate::film::Film;
use crate::scene::FilmSize;
use bytemuck::Zeroable;
use raystream_shaders::film::FilmPixel;
use raystream_shaders::film::tiles::{TILE, pixel_of_rank};
use raystream_shaders::integrator::first_hits::FeaturePixel;
use std::ops::Range;

/// Windows of the film start at multiples of this: its bytes are then a multiple of any device's
/// alignment.
pub const WINDOW_ALIGNMENT: u32 = TILE * TILE;

/// The film, in rank order, cut into as many bands as the device's limit on buffers asks for.
pub struct FilmBuffers<B> {
    size: FilmSize,
    bands: Vec<Band<B>>,
}

/// A range of ranks.
pub struct Band<B> {
    /// Rank of the first pixel.
    pub first_rank: u32,
    /// Radiance.
    pub film: Array<B, FilmPixel>,
    /// First-hit features.
    pub features: Array<B, FeaturePixel>,
}

impl<B> FilmBuffers<B> {
    /// A black film.
    pub fn new<E: Executor<Buffer = B>>(executor: &E, size: FilmSize) -> Result<Self, ExecError> {
        let pixels = size.width * size.height;
        debug_assert!(
            [size_of::<FilmPixel>(), size_of::<FeaturePixel>()].iter().all(|&size| (u64::from(
                WINDOW_ALIGNMENT
            ) * size
                as u64)
                .is_multiple_of(executor.limits().alignment)),
            "windows start where a view may"
        );
        let largest = size_of::<FilmPixel>().max(size_of::<FeaturePixel>()) as u64;
        let fitting =
            (executor.limits().buffer_bytes / largest).min(u64::from(u32::MAX / 2)) as u32;
        let band_pixels = (fitting / WINDOW_ALIGNMENT * WINDOW_ALIGNMENT).max(WINDOW_ALIGNMENT);
        let bands = (0..pixels)
            .step_by(band_pixels as usize)
            .map(|first_rank| {
                let len = band_pixels.min(pixels - first_rank) as usize;
                Ok(Band {
                    first_rank,
                    film: Array::zeroed(executor, "the film", len)?,
                    features: Array::zeroed(executor, "the film's features", len)?,
                })
            })
            .collect::<Result<_, ExecError>>()?;
        Ok(Self { size, bands })
    }

    /// A copy of `film`.
    pub fn from_film<E: Executor<Buffer = B>>(
        executor: &E,
        film: &Film,
    ) -> Result<Self, ExecError> {
        let size = FilmSize { width: film.width, height: film.height };
        let buffers = Self::new(executor, size)?;
        buffers.write(executor, &film.radiance, &film.features)?;
        Ok(buffers)
    }

    /// Makes it what it was when the host got these copies, in rows.
    pub fn write<E: Executor<Buffer = B>>(
        &self,
        executor: &E,
        radiance: &[FilmPixel],
        features: &[FeaturePixel],
    ) -> Result<(), ExecError> {
        for band in &self.bands {
            let rows = band.ranks().map(|rank| row_place(self.size, rank as u32));
            let (radiance, features): (Vec<_>, Vec<_>) =
                rows.map(|p| (radiance[p], features[p])).unzip();
            band.film.write(executor, &radiance)?;
            band.features.write(executor, &features)?;
        }
        Ok(())
    }

    /// Its size in pixels.
    pub fn size(&self) -> FilmSize {
        self.size
    }

    /// The pieces.
    pub fn bands(&self) -> &[Band<B>] {
        &self.bands
    }

    /// Pixels of the film.
    pub fn pixels(&self) -> u32 {
        self.size.width * self.size.height
    }

    /// The bands that have pixels in a range of ranks, each with these pixels' places in it.
    pub fn bands_of(&self, ranks: &Range<u32>) -> impl Iterator<Item = (&Band<B>, Range<u32>)> {
        self.bands.iter().filter_map(|band| {
            let end = band.first_rank + band.film.len() as u32;
            let range = ranks.start.max(band.first_rank)..ranks.end.min(end);
            (!range.is_empty())
                .then(|| (band, range.start - band.first_rank..range.end - band.first_rank))
        })
    }

    /// Copies the film to the host, in rows.
    pub fn read<E: Executor<Buffer = B>>(&self, executor: &E) -> Result<Film, ExecError> {
        let FilmSize { width, height } = self.size;
        let pixels = self.pixels() as usize;
        let mut radiance = vec![FilmPixel::zeroed(); pixels];
        let mut features = vec![FeaturePixel::zeroed(); pixels];
        // Band by band, so that little more than the picture itself is in memory at once.
        for band in &self.bands {
            for (rank, pixel) in (band.first_rank..).zip(band.film.read(executor)?) {
                radiance[row_place(self.size, rank)] = pixel;
            }
            for (rank, pixel) in (band.first_rank..).zip(band.features.read(executor)?) {
                features[row_place(self.size, rank)] = pixel;
            }
        }
        Ok(Film::new(width, height, radiance, features))
    }
}

/// Where the pixel of a rank is in rows.
pub fn row_place(size: FilmSize, rank: u32) -> usize {
    let (x, y) = pixel_of_rank(rank, size.width, size.height);
    (y * size.width + x) as usize
}

/// What is in rank order, one for each pixel, in rows.
pub fn in_rows<T: Zeroable + Copy>(size: FilmSize, ranked: Vec<T>) -> Vec<T> {
    let mut rows = vec![T::zeroed(); ranked.len()];
    for (rank, value) in (0..).zip(ranked) {
        rows[row_place(size, rank)] = value;
    }
    rows
}

impl<B> Band<B> {
    /// The ranks of its pixels.
    pub fn ranks(&self) -> Range<usize> {
        let first = self.first_rank as usize;
        first..first + self.film.len()
    }

    /// The window of at most `pixels` (rounded to [`WINDOW_ALIGNMENT`], at least that) that starts
    /// at `start`, as a range within the band; none at its end.
    pub fn window(&self, start: u32, pixels: u32) -> Option<Range<u32>> {
        let len = self.film.len() as u32;
        let step = (pixels / WINDOW_ALIGNMENT).max(1) * WINDOW_ALIGNMENT;
        (start < len).then(|| start..len.min(start.saturating_add(step)))
    }
}
