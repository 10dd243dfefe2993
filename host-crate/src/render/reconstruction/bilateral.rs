//! Launches of the filter `bilateral`.

use super::{Filter, FilterInputs, FilterView};
use crate::exec::{Array, Launch, kernels};
use crate::render::settings::estimation::FilterSettings;
use bytemuck::Zeroable;
use raystream_shaders::estimator::ErrorForm;
use raystream_shaders::estimator::bilateral::FilterParams;
use raystream_shaders::estimator::filtered::FilteredPixel;

/// The parameters of a kernel that filters all pixels of the picture.
pub(super) fn parameters(settings: FilterSettings, view: &FilterView) -> FilterParams {
    let form = ErrorForm { mean_radiance: view.mean_radiance, ..ErrorForm::zeroed() };
    FilterParams {
        threads: view.camera.width * view.camera.height,
        ..settings.parameters(&view.camera, form)
    }
}

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
        let parameters = parameters(self.settings, view);
        vec![kernels::filter_picture(&parameters, inputs.guides.view(), filtered.view())]
    }
}
