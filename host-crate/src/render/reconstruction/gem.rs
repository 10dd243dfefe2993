//! Launches of the filter `gem`.

use super::{Filter, FilterInputs, FilterView};
use crate::exec::{Array, ExecError, Executor, Launch, kernels};
use crate::render::film::control::{blur, gaussian};
use crate::scene::FilmSize;
use bytemuck::Zeroable;
use glam::Vec4;
use raystream_shaders::estimator::filtered::FilteredPixel;
use raystream_shaders::reconstruction::gem::ScaleParams;
use std::f32::consts::{FRAC_1_SQRT_2, SQRT_2};

/// Scales beside the pixels themselves. Each is wider than the one before by the root of 2.
const SCALES: usize = 8;
/// Standard deviation of the finest, in pixels.
const FINEST: f32 = FRAC_1_SQRT_2;
/// Standard deviations at which Gaussians are cut off.
const CUT: f32 = 2.5;
/// Standard deviation of the Gaussian over which pixels ask each other whether they stop, by that
/// of the scale.
const AGREEMENT: f32 = 2.0;

/// Greedy error minimisation.
pub struct Gem<B> {
    /// Of the pixels themselves, in rows.
    pixels: [Array<B, Vec4>; 2],
    /// Colours and variances of two scales, by turns.
    scales: [[Array<B, Vec4>; 2]; 2],
    stops: Array<B, Vec4>,
    is_settled: Array<B, u32>,
}

impl<B> Gem<B> {
    /// For a picture of `size`.
    pub fn new<E: Executor<Buffer = B>>(executor: &E, size: FilmSize) -> Result<Self, ExecError> {
        const LABEL: &str = "the scales of the filter gem";
        let pixels = (size.width * size.height) as usize;
        let rows = || Array::zeroed(executor, LABEL, pixels);
        Ok(Self {
            pixels: [rows()?, rows()?],
            scales: [[rows()?, rows()?], [rows()?, rows()?]],
            stops: rows()?,
            is_settled: Array::zeroed(executor, LABEL, pixels)?,
        })
    }

    /// The launches that take pixels from the scale of the standard deviation `finer` to that of
    /// `coarser`.
    fn step<'a>(
        &'a self,
        inputs: &'a FilterInputs<B>,
        filtered: &'a Array<B, FilteredPixel>,
        [from, to]: [&'a [Array<B, Vec4>; 2]; 2],
        [finer, coarser]: [f32; 2],
    ) -> Vec<Launch<'a, B>> {
        let FilmSize { width, height } = inputs.size;
        let [colors, variances] = to;
        let mut launches = Vec::new();
        // Squares of the weights are those of a Gaussian of variance one half.
        let squares = gaussian(inputs.size, coarser * FRAC_1_SQRT_2, CUT * SQRT_2);
        launches.extend(blur(
            &gaussian(inputs.size, coarser, CUT),
            &self.pixels[0],
            &inputs.scratch,
            colors,
        ));
        launches.extend(blur(&squares, &self.pixels[1], &inputs.scratch, variances));
        let (f, c) = (finer * finer, coarser * coarser);
        let parameters = ScaleParams {
            threads: width * height,
            width,
            height,
            bias: (c + f) / (c - f),
            ..ScaleParams::zeroed()
        };
        launches.push(kernels::judge_scale(
            &parameters,
            from[0].view(),
            from[1].view(),
            colors.view(),
            variances.view(),
            self.stops.view(),
        ));
        let agreement = gaussian(inputs.size, AGREEMENT * coarser, CUT);
        launches.extend(blur(&agreement, &self.stops, &inputs.scratch, &inputs.rows));
        launches.push(kernels::take_scale(
            &parameters,
            self.stops.view(),
            inputs.rows.view(),
            colors.view(),
            filtered.view(),
            self.is_settled.view(),
        ));
        launches
    }
}

impl<B: Send + Sync + 'static> Filter<B> for Gem<B> {
    fn launches<'a>(
        &'a self,
        inputs: &'a FilterInputs<B>,
        _: &FilterView,
        filtered: &'a Array<B, FilteredPixel>,
    ) -> Vec<Launch<'a, B>> {
        let mut launches = vec![kernels::begin_scales(
            &inputs.parameters(),
            inputs.guides.view(),
            filtered.view(),
            self.is_settled.view(),
            self.pixels[0].view(),
            self.pixels[1].view(),
        )];
        let (mut from, mut finer) = (&self.pixels, 0.0);
        for scale in 0..SCALES {
            let coarser = FINEST * SQRT_2.powi(scale as i32);
            let to = &self.scales[scale % 2];
            launches.extend(self.step(inputs, filtered, [from, to], [finer, coarser]));
            (from, finer) = (to, coarser);
        }
        launches
    }
}
