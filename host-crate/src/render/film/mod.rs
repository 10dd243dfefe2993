//! The film in a device's memory.

pub mod control;
pub mod splats;

use crate::exec::{Array, ExecError, Executor};
use crate::film::Film;
use crate::scene::FilmSize;
use bytemuck::{Pod, Zeroable};
use rayon::prelude::*;
use raystream_shaders::film::FilmPixel;
use raystream_shaders::film::sums::PixelSums;
use raystream_shaders::film::tiles::{TILE, pixel_of_rank, rank_of_pixel};
use raystream_shaders::integrator::first_hits::FeaturePixel;
use raystream_shaders::math::fixed::unit_exponent;
use std::ops::Range;

/// Windows of the film start at multiples of this: its bytes are then a multiple of any device's
/// alignment.
pub const WINDOW_ALIGNMENT: u32 = TILE * TILE;

/// The film, in rank order, cut into as many bands as the device's limit on buffers asks for.
pub struct FilmBuffers<B> {
    size: FilmSize,
    unit_exponent: i32,
    bands: Vec<Band<B>>,
}

/// A range of ranks.
pub struct Band<B> {
    /// Rank of the first pixel.
    pub first_rank: u32,
    /// Radiance.
    pub film: Array<B, PixelSums>,
    /// First-hit features.
    pub features: Array<B, FeaturePixel>,
}

impl<B> FilmBuffers<B> {
    /// A black film, whose unit is 2 to the power of `unit_exponent` (see
    /// [`raystream_shaders::math::fixed`]).
    pub fn new<E: Executor<Buffer = B>>(
        executor: &E,
        size: FilmSize,
        unit_exponent: i32,
    ) -> Result<Self, ExecError> {
        let pixels = size.width * size.height;
        debug_assert!(
            [size_of::<PixelSums>(), size_of::<FeaturePixel>()].iter().all(|&size| (u64::from(
                WINDOW_ALIGNMENT
            ) * size
                as u64)
                .is_multiple_of(executor.limits().alignment)),
            "windows start where a view may"
        );
        let largest = size_of::<PixelSums>().max(size_of::<FeaturePixel>()) as u64;
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
        Ok(Self { size, unit_exponent, bands })
    }

    /// A copy of `film`, but for roundings to a unit that suits it.
    pub fn from_film<E: Executor<Buffer = B>>(
        executor: &E,
        film: &Film,
    ) -> Result<Self, ExecError> {
        let size = FilmSize { width: film.width, height: film.height };
        let unit = unit_exponent(brightest(film));
        let sums: Vec<_> =
            film.radiance.iter().map(|pixel| PixelSums::of_pixel(pixel, unit)).collect();
        let buffers = Self::new(executor, size, unit)?;
        buffers.write(executor, &sums, &film.features)?;
        Ok(buffers)
    }

    /// Makes it what it was when the host got these copies, in rows.
    pub fn write<E: Executor<Buffer = B>>(
        &self,
        executor: &E,
        radiance: &[PixelSums],
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

    /// The unit of its sums is 2 to this power.
    pub fn unit_exponent(&self) -> i32 {
        self.unit_exponent
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

    /// Copies to the host, in rows, what the film comes to.
    pub fn read<E: Executor<Buffer = B>>(&self, executor: &E) -> Result<Film, ExecError> {
        let features = self.read_features(executor)?;
        Ok(Film { features, ..self.read_radiance(executor)? })
    }

    /// The same, of a film that has no features yet.
    pub fn read_radiance<E: Executor<Buffer = B>>(&self, executor: &E) -> Result<Film, ExecError> {
        let FilmSize { width, height } = self.size;
        let unit_exponent = self.unit_exponent;
        let to_pixel = move |sums: PixelSums| sums.to_pixel(unit_exponent);
        let radiance = self.read_rows(executor, |band| &band.film, to_pixel)?;
        let features = bytemuck::allocation::zeroed_vec(radiance.len());
        Ok(Film::new(width, height, radiance, features))
    }

    /// Copies the sums to the host, in rows.
    pub fn read_sums<E: Executor<Buffer = B>>(
        &self,
        executor: &E,
    ) -> Result<Vec<PixelSums>, ExecError> {
        self.read_rows(executor, |band| &band.film, |sums| sums)
    }

    /// Copies the sums of a range of ranks to the host.
    pub fn read_ranks<E: Executor<Buffer = B>>(
        &self,
        executor: &E,
        ranks: &Range<u32>,
    ) -> Result<Vec<PixelSums>, ExecError> {
        let mut sums = Vec::with_capacity(ranks.len());
        for (band, places) in self.bands_of(ranks) {
            let places = places.start as usize..places.end as usize;
            sums.extend(band.film.read_range(executor, places)?);
        }
        Ok(sums)
    }

    /// Replaces the sums from a rank on.
    pub fn write_ranks<E: Executor<Buffer = B>>(
        &self,
        executor: &E,
        first: u32,
        sums: &[PixelSums],
    ) -> Result<(), ExecError> {
        let mut rest = sums;
        for (band, places) in self.bands_of(&(first..first + sums.len() as u32)) {
            let (here, others) = rest.split_at(places.len());
            band.film.write_from(executor, places.start as usize, here)?;
            rest = others;
        }
        Ok(())
    }

    /// Adds sums of other samples of the pixels from a rank on.
    pub fn add_ranks<E: Executor<Buffer = B>>(
        &self,
        executor: &E,
        first: u32,
        sums: &[PixelSums],
    ) -> Result<(), ExecError> {
        let mut all = self.read_ranks(executor, &(first..first + sums.len() as u32))?;
        all.par_iter_mut().zip(sums).for_each(|(own, other)| own.add_sums(other));
        self.write_ranks(executor, first, &all)
    }

    /// Copies the features to the host, in rows.
    pub fn read_features<E: Executor<Buffer = B>>(
        &self,
        executor: &E,
    ) -> Result<Vec<FeaturePixel>, ExecError> {
        self.read_rows(executor, |band| &band.features, |features| features)
    }

    fn read_rows<E: Executor<Buffer = B>, T: Pod + Send + Sync, U: Pod + Send>(
        &self,
        executor: &E,
        array: impl Fn(&Band<B>) -> &Array<B, T>,
        value: impl Fn(T) -> U + Sync,
    ) -> Result<Vec<U>, ExecError> {
        let FilmSize { width, height } = self.size;
        let mut rows: Vec<U> = bytemuck::allocation::zeroed_vec(self.pixels() as usize);
        // Band by band, so that little more than the rows themselves is in memory at once.
        for band in &self.bands {
            let (elements, first_rank) = (array(band).read(executor)?, band.first_rank);
            rows.par_chunks_mut(width as usize).zip(0..height).for_each(|(row, y)| {
                for (pixel, x) in row.iter_mut().zip(0..) {
                    let rank = rank_of_pixel(x, y, width, height);
                    let in_band = rank.checked_sub(first_rank);
                    if let Some(element) = in_band.and_then(|place| elements.get(place as usize)) {
                        *pixel = value(*element);
                    }
                }
            });
        }
        Ok(rows)
    }
}

/// The largest mean of a pixel that is a number.
fn brightest(film: &Film) -> f32 {
    let mean = |pixel: &FilmPixel| (pixel.sum() / pixel.samples().max(1) as f32).max_element();
    film.radiance.iter().map(mean).filter(|mean| mean.is_finite()).fold(0.0, f32::max)
}

/// Where the pixel of a rank is in rows.
pub fn row_place(size: FilmSize, rank: u32) -> usize {
    let (x, y) = pixel_of_rank(rank, size.width, size.height);
    (y * size.width + x) as usize
}

/// What is in rank order, one for each pixel, in rows.
pub fn in_rows<T: Zeroable + Copy + Send + Sync>(size: FilmSize, ranked: &[T]) -> Vec<T> {
    let FilmSize { width, height } = size;
    let mut rows = bytemuck::allocation::zeroed_vec(ranked.len());
    rows.par_chunks_mut(width as usize).zip(0..height).for_each(|(row, y)| {
        for (value, x) in row.iter_mut().zip(0..) {
            *value = ranked[rank_of_pixel(x, y, width, height) as usize];
        }
    });
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
