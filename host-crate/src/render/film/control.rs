//! The corrections by the control film; see [`raystream_shaders::film::control`].

use super::FilmBuffers;
use crate::exec::{Array, ExecError, Executor, Launch, kernels};
use crate::scene::FilmSize;
use bytemuck::Zeroable;
use glam::{Vec3, Vec4};
use raystream_shaders::film::control::ControlParams;

/// The levels: each with the samples of a pixel for each of the control film's at which the next
/// one begins, and the standard deviation, in pixels, of the Gaussian by which differences are
/// spread. It is measured in pixels and not in parts of the picture, since noise is:
/// `ratio / (4 pi sigma^2)` of the variance of a pixel is added to it, 12 % at most up to a ratio
/// of 96. docs/ADAPTIVE.md has what other values do.
const LEVELS: [(f32, f32); 3] = [(6.0, 2.0), (24.0, 4.0), (f32::MAX, 8.0)];
/// Standard deviation, in pixels, of the Gaussian over which the deviation of samples is averaged
/// for a guide.
const GUIDE_SIGMA: f32 = 4.0;
/// What a pixel gives away changes its neighbours by at most so many of their standard errors.
/// docs/ADAPTIVE.md has what other values do.
const BOUND: f32 = 2.0;
/// Standard deviations at which the Gaussian is cut off.
const CUT: f32 = 3.0;

/// What the control film corrects the picture by, and what it takes to find that: four vectors and
/// a number for each pixel, in rows.
pub struct ControlFilm<B> {
    size: FilmSize,
    guided: Array<B, Vec4>,
    /// Mean standard errors around pixels.
    around: Array<B, f32>,
    /// Between the passes by turns.
    scratch: [Array<B, Vec4>; 2],
    /// The counts, before.
    corrections: Array<B, Vec4>,
}

/// The parameters of a pass along the columns of a picture, by a Gaussian of a standard deviation
/// in pixels that is cut off at so many of these.
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

/// The launches after which `sums` are the sums over `values` by the weights of the [`gaussian`]
/// with these parameters; `between` is overwritten, and `sums` may be `values`.
pub fn blur<'a, B>(
    columns: &ControlParams,
    values: &'a Array<B, Vec4>,
    between: &'a Array<B, Vec4>,
    sums: &'a Array<B, Vec4>,
) -> [Launch<'a, B>; 2] {
    let along_rows = ControlParams { along_rows: 1, ..*columns };
    [
        kernels::blur(&along_rows, values.view(), between.view()),
        kernels::blur(columns, between.view(), sums.view()),
    ]
}

impl<B> ControlFilm<B> {
    /// For a picture of `size`.
    pub fn new<E: Executor<Buffer = B>>(executor: &E, size: FilmSize) -> Result<Self, ExecError> {
        let pixels = (size.width * size.height) as usize;
        let array = || Array::zeroed(executor, "the control film", pixels);
        let around = Array::zeroed(executor, "the control film", pixels)?;
        let scratch = [array()?, array()?];
        Ok(Self { size, guided: array()?, around, scratch, corrections: array()? })
    }

    /// The launches after which the corrections are those of a film of this size.
    pub fn launches<'a>(&'a self, film: &'a FilmBuffers<B>) -> Vec<Launch<'a, B>> {
        let (differences, counts) = self.differences();
        let unit_exponent = film.unit_exponent();
        let whole = ControlParams { unit_exponent, ..gaussian(self.size, GUIDE_SIGMA, CUT) };
        let of_band = film.bands().iter().map(|band| {
            let threads = band.film.len() as u32;
            let first_rank = band.first_rank;
            let parameters = ControlParams { threads, first_rank, ..whole };
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
        (&self.scratch[0], &self.corrections)
    }

    /// The launches after which the corrections are those of the [differences](Self::differences).
    pub fn spread(&self) -> Vec<Launch<'_, B>> {
        let parameters = gaussian(self.size, GUIDE_SIGMA, CUT);
        let along_rows = ControlParams { along_rows: 1, ..parameters };
        let (guided, corrections) = (&self.guided, &self.corrections);
        let [one, other] = &self.scratch;
        let mut launches = vec![
            kernels::blur(&along_rows, one.view(), other.view()),
            kernels::control_guides(
                &parameters,
                other.view(),
                one.view(),
                corrections.view(),
                guided.view(),
            ),
            kernels::blur(&along_rows, one.view(), other.view()),
            kernels::control_errors(&parameters, one.view(), other.view(), self.around.view()),
        ];
        let mut lowest = 0.0;
        for (end, sigma) in LEVELS {
            let gaussian = gaussian(self.size, sigma, CUT);
            let level = ControlParams { lowest, end, bound: BOUND, ..gaussian };
            launches.extend(blur(&level, guided, one, other));
            launches.push(kernels::control_shares(
                &level,
                guided.view(),
                other.view(),
                self.around.view(),
                corrections.view(),
                one.view(),
            ));
            launches.extend(blur(&level, one, other, one));
            launches.push(kernels::control_corrections(
                &level,
                guided.view(),
                one.view(),
                corrections.view(),
            ));
            lowest = end;
        }
        launches
    }

    /// Copies the corrections to the host, in rows.
    pub fn read<E: Executor<Buffer = B>>(&self, executor: &E) -> Result<Vec<Vec3>, ExecError> {
        let corrections = self.corrections.read(executor)?;
        Ok(corrections.into_iter().map(Vec4::truncate).collect())
    }
}
