//! Launches of the filter `features`, and what filters that compare features share.

use super::halves::FilteredHalves;
use super::mixture::mix;
use super::nlm::STRENGTH;
use super::{Filter, FilterInputs, FilterView};
use crate::exec::{Array, ExecError, Executor, Launch, kernels};
use crate::render::scene::camera::pinhole;
use crate::scene::FilmSize;
use raystream_shaders::estimator::filtered::FilteredPixel;
use raystream_shaders::reconstruction::features::{FeatureParams, Features};
use raystream_shaders::reconstruction::nlm::LARGEST_WINDOW;
use raystream_shaders::reconstruction::patches::PatchParams;

/// Slopes by which differences of features are measured. The paper's 0.6 is of features whose noise
/// has been filtered; docs/FILTERS.md has what each makes.
const FEATURE_STRENGTH: f32 = 2.0;
/// What variances count times in patches, which makes windows wider (Bitterli et al. 2016).
pub(super) const VARIANCES: f32 = 2.0;

/// A way to weigh neighbours (Rousselle et al. 2013).
struct Candidate {
    /// Deviations by which differences of colours are measured.
    strength: f32,
    /// Pixels to each side of a patch.
    patch: u32,
    /// The least squared slope of features.
    floor: f32,
}

/// Sees small detail of light, and leaves most noise.
const FIRST: Candidate = Candidate { strength: STRENGTH, patch: 1, floor: 1e-3 };
/// Robust.
const SECOND: Candidate = Candidate { strength: STRENGTH, patch: 3, floor: 1e-3 };
/// Looks at features alone.
const THIRD: Candidate = Candidate { strength: 1e5, patch: 1, floor: 1e-4 };

/// The features of all pixels, in rows.
pub struct FeatureRows<B>(Array<B, Features>);

impl<B> FeatureRows<B> {
    /// For a picture of `size`.
    pub fn new<E: Executor<Buffer = B>>(executor: &E, size: FilmSize) -> Result<Self, ExecError> {
        let pixels = (size.width * size.height) as usize;
        Array::zeroed(executor, "features to be compared", pixels).map(Self)
    }

    /// They.
    pub fn array(&self) -> &Array<B, Features> {
        &self.0
    }

    /// The launch after which they are those of `inputs`.
    pub fn launch<'a>(&'a self, inputs: &'a FilterInputs<B>, view: &FilterView) -> Launch<'a, B> {
        let FilmSize { width, height } = inputs.size;
        let (origin, pixel_pitch) = pinhole(&view.camera);
        let threads = width * height;
        let parameters = FeatureParams { threads, width, height, pad: 0, origin, pixel_pitch };
        kernels::describe_features(&parameters, inputs.guides.view(), self.0.view())
    }
}

/// Non-local means by colours and features: three of them, mixed.
pub struct ByFeatures<B> {
    halves: FilteredHalves<B>,
    features: FeatureRows<B>,
    pictures: [Array<B, FilteredPixel>; 3],
}

impl<B> ByFeatures<B> {
    /// For a picture of `size`.
    pub fn new<E: Executor<Buffer = B>>(executor: &E, size: FilmSize) -> Result<Self, ExecError> {
        let pixels = (size.width * size.height) as usize;
        let picture = || Array::zeroed(executor, "filtered pictures to be mixed", pixels);
        Ok(Self {
            halves: FilteredHalves::new(executor, size, 1)?,
            features: FeatureRows::new(executor, size)?,
            pictures: [picture()?, picture()?, picture()?],
        })
    }

    fn candidate<'a>(
        &'a self,
        inputs: &'a FilterInputs<B>,
        candidate: &Candidate,
        filtered: &'a Array<B, FilteredPixel>,
    ) -> Vec<Launch<'a, B>> {
        let FilmSize { width, height } = inputs.size;
        let &Candidate { strength, patch, floor } = candidate;
        let parameters = PatchParams {
            feature_strength: FEATURE_STRENGTH * FEATURE_STRENGTH,
            feature_floor: floor,
            ..PatchParams::new(
                (width, height),
                VARIANCES * strength * strength,
                VARIANCES,
                patch,
                LARGEST_WINDOW,
            )
        };
        let features = self.features.array();
        self.halves.filter(inputs, &[filtered], |weighers, values, to| {
            [kernels::filter_half_by_features(
                &parameters,
                features.view(),
                weighers.view(),
                values.view(),
                to[0].view(),
            )]
        })
    }
}

impl<B: Send + Sync + 'static> Filter<B> for ByFeatures<B> {
    fn launches<'a>(
        &'a self,
        inputs: &'a FilterInputs<B>,
        view: &FilterView,
        filtered: &'a Array<B, FilteredPixel>,
    ) -> Vec<Launch<'a, B>> {
        let [one, other, mixed] = &self.pictures;
        let mut launches = vec![self.features.launch(inputs, view)];
        launches.extend(self.halves.rows(inputs));
        launches.extend(self.candidate(inputs, &SECOND, one));
        launches.extend(self.candidate(inputs, &THIRD, other));
        launches.extend(mix(inputs, one, other, mixed));
        launches.extend(self.candidate(inputs, &FIRST, one));
        launches.extend(mix(inputs, mixed, one, filtered));
        launches
    }
}
