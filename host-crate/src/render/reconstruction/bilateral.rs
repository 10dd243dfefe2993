//! Launches of the filter `bilateral`.

use super::{Filter, FilterInputs, FilterView};
use crate::exec::{Array, Launch, kernels};
use crate::render::settings::estimation::FilterSettings;
use bytemuck::Zeroable;
use raystream_shaders::estimator::ErrorForm;
use raystream_shaders::estimator::bilateral::FilterParams;
use raystream_shaders::estimator::filtered::FilteredPixel;

/// A joint bilateral filter.
pub struct Bilateral {
    settings: FilterSettings,
}

impl Bilateral {
    /// With these settings.
    pub fn new(settings: FilterSettings) -> Self {
        Self { settings }
    }
}

impl<B> Filter<B> for Bilateral {
    fn launches<'a>(
        &'a self,
        inputs: &'a FilterInputs<B>,
        view: &FilterView,
        filtered: &'a Array<B, FilteredPixel>,
    ) -> Vec<Launch<'a, B>> {
        let form = ErrorForm { mean_radiance: view.mean_radiance, ..ErrorForm::zeroed() };
        let parameters = FilterParams {
            threads: inputs.parameters().threads,
            ..self.settings.parameters(&view.camera, form)
        };
        vec![kernels::filter_picture(&parameters, inputs.guides.view(), filtered.view())]
    }
}
