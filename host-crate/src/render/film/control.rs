//! The corrections by the control film; see [`raystream_shaders::film::control`].

use super::FilmBuffers;
use crate::exec::{Array, ExecError, Executor, Launch, kernels};
use crate::scene::FilmSize;
use bytemuck::Zeroable;
use glam::{Vec3, Vec4};
use raystream_shaders::film::control::ControlParams;

/// Standard deviation, in pixels, of the Gaussian by which the control film's differences are
/// spread. It is measured in pixels and not in parts of the picture, since noise is: of the variance
/// of the control film `1 / (4 pi sigma^2)` gets into the picture. docs/ADAPTIVE.md has what other
/// values do.
const SIGMA: f32 = 8.0;
/// Standard deviations at which the Gaussian is cut off.
const CUT: f32 = 3.0;

/// What the control film corrects the picture by, and what it takes to find that: three vectors
/// for each pixel, in rows.
pub struct ControlFilm<B> {
    size: FilmSize,
    guided: Array<B, Vec4>,
    /// Between the passes by turns with `corrections`.
    scratch: Array<B, Vec4>,
    corrections: Array<B, Vec4>,
}

/// The parameters of a pass along the columns of a picture, by a Gaussian of a standard deviation in
/// pixels that is cut off at so many of these.
pub fn gaussian(size: FilmSize, sigma: f32, cut: f32) -> ControlParams {
    let FilmSize { width, height } = size;
    ControlParams {
        threads: width * height,
        width,
        height,
        factor: 0.5 / (sigma * sigma),
        radius: (cut * sigma) as u32,
        ..ControlParams::zeroed()
    }
}

impl<B> ControlFilm<B> {
    /// For a picture of `size`.
    pub fn new<E: Executor<Buffer = B>>(executor: &E, size: FilmSize) -> Result<Self, ExecError> {
        let pixels = (size.width * size.height) as usize;
        let array = || Array::zeroed(executor, "the control film", pixels);
        Ok(Self { size, guided: array()?, scratch: array()?, corrections: array()? })
    }

    /// The launches after which the corrections are those of a film of this size.
    pub fn launches<'a>(&'a self, film: &'a FilmBuffers<B>) -> Vec<Launch<'a, B>> {
        let (differences, counts) = self.differences();
        let of_band = film.bands().iter().map(|band| {
            let threads = band.film.len() as u32;
            let first_rank = band.first_rank;
            let parameters = ControlParams { threads, first_rank, ..self.whole() };
            let film = band.film.view();
            kernels::control_differences(&parameters, film, differences.view(), counts.view())
        });
        let mut launches: Vec<_> = of_band.collect();
        launches.extend(self.spread());
        launches
    }

    /// Where the differences that are to be spread are put, and the counts; see
    /// [`control_differences`](raystream_shaders::film::control::control_differences).
    pub fn differences(&self) -> (&Array<B, Vec4>, &Array<B, Vec4>) {
        (&self.scratch, &self.guided)
    }

    /// The launches after which the corrections are those of the [differences](Self::differences).
    pub fn spread(&self) -> [Launch<'_, B>; 7] {
        let whole = self.whole();
        let along_rows = ControlParams { along_rows: 1, ..whole };
        let (guided, one, other) = (&self.guided, &self.scratch, &self.corrections);
        [
            kernels::control_guides(&whole, one.view(), guided.view()),
            kernels::blur(&along_rows, guided.view(), one.view()),
            kernels::blur(&whole, one.view(), other.view()),
            kernels::control_shares(&whole, guided.view(), other.view(), one.view()),
            kernels::blur(&along_rows, one.view(), other.view()),
            kernels::blur(&whole, other.view(), one.view()),
            kernels::control_corrections(&whole, guided.view(), one.view(), other.view()),
        ]
    }

    /// The parameters of a pass over all pixels, along columns.
    fn whole(&self) -> ControlParams {
        gaussian(self.size, SIGMA, CUT)
    }

    /// Copies the corrections to the host, in rows.
    pub fn read<E: Executor<Buffer = B>>(&self, executor: &E) -> Result<Vec<Vec3>, ExecError> {
        let corrections = self.corrections.read(executor)?;
        Ok(corrections.into_iter().map(Vec4::truncate).collect())
    }
}
