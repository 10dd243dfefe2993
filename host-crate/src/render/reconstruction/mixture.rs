//! Launches that mix two filtered pictures as an estimate of the error says is best.

use super::FilterInputs;
use crate::exec::{Array, Launch, kernels};
use raystream_shaders::estimator::filtered::FilteredPixel;

/// Standard deviation, in pixels, of the Gaussian over which the estimate is averaged: that of 200
/// pixels is a twentieth of their errors off or so, and light changes little over as many.
const MIXTURE_SIGMA: f32 = 4.0;

/// The launches after which `mixture` is that of two pictures; the first is kept where the estimate
/// does not say that the second is better.
pub fn mix<'a, B>(
    inputs: &'a FilterInputs<B>,
    first: &'a Array<B, FilteredPixel>,
    second: &'a Array<B, FilteredPixel>,
    mixture: &'a Array<B, FilteredPixel>,
) -> Vec<Launch<'a, B>> {
    let parameters = inputs.parameters();
    let mut launches = vec![kernels::mixture_terms(
        &parameters,
        inputs.guides.view(),
        first.view(),
        second.view(),
        inputs.rows.view(),
    )];
    launches.extend(inputs.blur(MIXTURE_SIGMA));
    launches.push(kernels::mix_filtered(
        &parameters,
        first.view(),
        second.view(),
        inputs.rows.view(),
        mixture.view(),
    ));
    launches
}
