//! Launches of the filter `nfor`.

use super::features::{FeatureRows, VARIANCES};
use super::halves::FilteredHalves;
use super::mixture::mix;
use super::{Filter, FilterInputs, FilterView};
use crate::exec::{Array, ExecError, Executor, Launch, kernels};
use crate::render::scene::camera::pinhole;
use crate::scene::FilmSize;
use bytemuck::Zeroable;
use glam::Vec4;
use raystream_shaders::estimator::filtered::FilteredPixel;
use raystream_shaders::reconstruction::nfor::{PlaneParams, TERMS};
use raystream_shaders::reconstruction::patch_map::{WINDOW, WORDS};
use raystream_shaders::reconstruction::patches::{LARGEST_PATCH, PatchParams};

/// Deviations by which differences are measured, of the two candidates (Bitterli et al. 2016). The
/// map of distances is by the larger.
const STRENGTHS: [f32; 2] = [1.0, 0.5];

/// Nonlinearly weighted first-order regression.
pub struct Nfor<B> {
    halves: FilteredHalves<B>,
    features: FeatureRows<B>,
    map: Array<B, u32>,
    planes: Array<B, Vec4>,
    pictures: [Array<B, FilteredPixel>; 2],
}

impl<B> Nfor<B> {
    /// For a picture of `size`.
    pub fn new<E: Executor<Buffer = B>>(executor: &E, size: FilmSize) -> Result<Self, ExecError> {
        let pixels = (size.width * size.height) as usize;
        let picture = || Array::zeroed(executor, "filtered pictures to be mixed", pixels);
        let (words, terms) = (WORDS as usize * pixels, TERMS as usize * pixels);
        Ok(Self {
            halves: FilteredHalves::new(executor, size, STRENGTHS.len())?,
            features: FeatureRows::new(executor, size)?,
            map: Array::zeroed(executor, "distances of patches for the filter nfor", words)?,
            planes: Array::zeroed(executor, "planes for the filter nfor", terms)?,
            pictures: [picture()?, picture()?],
        })
    }

    /// The launches after which `to` is a half in rows, filtered with the planes of a candidate.
    fn candidate<'a>(
        &'a self,
        parameters: &PlaneParams,
        values: &'a Array<B, Vec4>,
        to: &'a Array<B, Vec4>,
    ) -> [Launch<'a, B>; 2] {
        let features = self.features.array();
        [
            kernels::fit_planes(
                parameters,
                features.view(),
                self.map.view(),
                values.view(),
                self.planes.view(),
            ),
            kernels::collect_planes(
                parameters,
                features.view(),
                self.map.view(),
                values.view(),
                self.planes.view(),
                to.view(),
            ),
        ]
    }
}

impl<B: Send + Sync + 'static> Filter<B> for Nfor<B> {
    fn launches<'a>(
        &'a self,
        inputs: &'a FilterInputs<B>,
        view: &FilterView,
        filtered: &'a Array<B, FilteredPixel>,
    ) -> Vec<Launch<'a, B>> {
        let FilmSize { width, height } = inputs.size;
        let strength = VARIANCES * STRENGTHS[0] * STRENGTHS[0];
        let patches = PatchParams::new((width, height), strength, VARIANCES, LARGEST_PATCH, WINDOW);
        let candidates = STRENGTHS.map(|strength| PlaneParams {
            threads: width * height,
            width,
            height,
            sharpness: (STRENGTHS[0] / strength).powi(2),
            pixel_pitch: pinhole(&view.camera).1,
            ..PlaneParams::zeroed()
        });
        let [wide, narrow] = &self.pictures;
        let mut launches = vec![self.features.launch(inputs, view)];
        launches.extend(self.halves.rows(inputs));
        launches.extend(self.halves.filter(inputs, &[wide, narrow], |weighers, values, to| {
            // Both candidates go by one map.
            let map = kernels::measure_patches(&patches, weighers.view(), self.map.view());
            let filtered = candidates.iter().zip(to);
            let filtered = filtered.flat_map(|(of, to)| self.candidate(of, values, to));
            std::iter::once(map).chain(filtered).collect::<Vec<_>>()
        }));
        launches.extend(mix(inputs, wide, narrow, filtered));
        launches
    }
}
