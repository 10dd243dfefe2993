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
        let (width, height) = (film.width, film.height);
        let buffers = Self::new(executor, FilmSize { width, height })?;
        for band in &buffers.bands {
            let rows = (band.first_rank..band.first_rank + band.film.len() as u32).map(|rank| {
                let (x, y) = pixel_of_rank(rank, width, height);
                (y * width + x) as usize
            });
            let (radiance, features): (Vec<_>, Vec<_>) =
                rows.map(|p| (film.radiance[p], film.features[p])).unzip();
            band.film.write(executor, &radiance)?;
            band.features.write(executor, &features)?;
        }
        Ok(buffers)
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
            let in_rows = |offset: usize| {
                let (x, y) = pixel_of_rank(band.first_rank + offset as u32, width, height);
                (y * width + x) as usize
            };
            for (offset, pixel) in band.film.read(executor)?.into_iter().enumerate() {
                radiance[in_rows(offset)] = pixel;
            }
            for (offset, pixel) in band.features.read(executor)?.into_iter().enumerate() {
                features[in_rows(offset)] = pixel;
            }
        }
        Ok(Film::new(width, height, radiance, features))
    }
}

impl<B> Band<B> {
    /// The window of at most `pixels` (rounded to [`WINDOW_ALIGNMENT`], at least that) that starts
    /// at `start`, as a range within the band; none at its end.
    pub fn window(&self, start: u32, pixels: u32) -> Option<Range<u32>> {
        let len = self.film.len() as u32;
        let step = (pixels / WINDOW_ALIGNMENT).max(1) * WINDOW_ALIGNMENT;
        (start < len).then(|| start..len.min(start.saturating_add(step)))
    }
}
