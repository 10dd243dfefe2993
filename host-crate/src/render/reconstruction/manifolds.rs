//! Launches of the filter `manifolds`.

use super::features::FeatureRows;
use super::{Filter, FilterInputs, FilterView};
use crate::exec::{Array, ExecError, Executor, Launch, kernels};
use crate::scene::FilmSize;
use bytemuck::Zeroable;
use glam::Vec4;
use raystream_shaders::estimator::filtered::FilteredPixel;
use raystream_shaders::reconstruction::manifolds::{ADDERS, ManifoldParams};
use std::f32::consts::SQRT_2;

/// Standard deviation of the blur, in pixels.
const SIGMA: f32 = 8.0;
/// Levels of the tree: seven manifolds.
const LEVELS: usize = 3;

/// A manifold: two sums for each pixel.
type Manifold<B> = [Array<B, Vec4>; 2];

/// Adaptive manifolds.
pub struct Manifolds<B> {
    features: FeatureRows<B>,
    colors: Array<B, Vec4>,
    sums: Array<B, Vec4>,
    near: Array<B, Vec4>,
    clusters: Array<B, u32>,
    /// One on each level: those of the branch that is worked on.
    levels: [Manifold<B>; LEVELS],
    splats: Array<B, Vec4>,
    parts: [Array<B, Vec4>; 2],
    direction: Array<B, Vec4>,
}

impl<B> Manifolds<B> {
    /// For a picture of `size`.
    pub fn new<E: Executor<Buffer = B>>(executor: &E, size: FilmSize) -> Result<Self, ExecError> {
        const LABEL: &str = "manifolds";
        let pixels = (size.width * size.height) as usize;
        let rows = || Array::zeroed(executor, LABEL, pixels);
        let level = || Ok([rows()?, rows()?]);
        let parts = || Array::zeroed(executor, LABEL, ADDERS as usize);
        Ok(Self {
            features: FeatureRows::new(executor, size)?,
            colors: rows()?,
            sums: rows()?,
            near: rows()?,
            clusters: Array::zeroed(executor, LABEL, pixels)?,
            levels: [level()?, level()?, level()?],
            splats: rows()?,
            parts: [parts()?, parts()?],
            direction: Array::zeroed(executor, LABEL, 2)?,
        })
    }

    /// The launches after which `values` are blurred along both axes; along `manifold`, where there
    /// is one to look at.
    fn blur<'a>(
        parameters: &ManifoldParams,
        manifold: &'a Manifold<B>,
        looks: bool,
        values: &'a Array<B, Vec4>,
    ) -> [Launch<'a, B>; 2] {
        let ManifoldParams { width, height, .. } = *parameters;
        let steepness = if looks { SIGMA } else { 0.0 };
        [(1, height), (0, width)].map(|(along_rows, threads)| {
            let parameters = ManifoldParams { along_rows, threads, steepness, ..*parameters };
            let [low, high] = manifold;
            kernels::blur_along(&parameters, low.view(), high.view(), values.view())
        })
    }

    /// The launches that filter by the manifold `node`, on a level, and by those below it.
    fn node<'a>(&'a self, whole: &ManifoldParams, node: u32, level: usize) -> Vec<Launch<'a, B>> {
        let parameters = ManifoldParams { node, ..*whole };
        let manifold = &self.levels[level];
        let [low, high] = manifold;
        // The first has no parent; what it is given in its place nobody looks at.
        let parent = &self.levels[if level > 0 { level - 1 } else { LEVELS - 1 }];
        let features = self.features.array();
        let mut launches = vec![kernels::begin_manifold(
            &parameters,
            features.view(),
            self.clusters.view(),
            parent[0].view(),
            parent[1].view(),
            low.view(),
            high.view(),
        )];
        for sums in manifold {
            launches.extend(Self::blur(&parameters, parent, false, sums));
        }
        launches.push(kernels::splat_pixels(
            &parameters,
            features.view(),
            self.colors.view(),
            low.view(),
            high.view(),
            self.splats.view(),
        ));
        launches.extend(Self::blur(&parameters, manifold, true, &self.splats));
        launches.push(kernels::slice_manifold(
            &parameters,
            features.view(),
            low.view(),
            high.view(),
            self.splats.view(),
            self.sums.view(),
            self.near.view(),
        ));
        if level + 1 < LEVELS {
            launches.extend(self.split(&parameters, manifold));
            for child in [2 * node + 1, 2 * node + 2] {
                launches.extend(self.node(whole, child, level + 1));
            }
        }
        launches
    }

    /// The launches that split the cluster of a manifold.
    fn split<'a>(
        &'a self,
        parameters: &ManifoldParams,
        [low, high]: &'a Manifold<B>,
    ) -> [Launch<'a, B>; 3] {
        let features = self.features.array();
        let [parts_low, parts_high] = &self.parts;
        [
            kernels::find_direction(
                &ManifoldParams { threads: ADDERS, ..*parameters },
                features.view(),
                self.clusters.view(),
                low.view(),
                high.view(),
                parts_low.view(),
                parts_high.view(),
            ),
            kernels::join_direction(
                &ManifoldParams { threads: 1, ..*parameters },
                parts_low.view(),
                parts_high.view(),
                self.direction.view(),
            ),
            kernels::split_cluster(
                parameters,
                features.view(),
                low.view(),
                high.view(),
                self.direction.view(),
                self.clusters.view(),
            ),
        ]
    }
}

impl<B: Send + Sync + 'static> Filter<B> for Manifolds<B> {
    fn launches<'a>(
        &'a self,
        inputs: &'a FilterInputs<B>,
        view: &FilterView,
        filtered: &'a Array<B, FilteredPixel>,
    ) -> Vec<Launch<'a, B>> {
        let FilmSize { width, height } = inputs.size;
        let parameters = ManifoldParams {
            threads: width * height,
            width,
            height,
            feedback: (-SQRT_2 / SIGMA).exp(),
            ..ManifoldParams::zeroed()
        };
        let mut launches = vec![
            self.features.launch(inputs, view),
            kernels::begin_manifolds(
                &inputs.parameters(),
                inputs.guides.view(),
                self.colors.view(),
                self.sums.view(),
                self.near.view(),
                self.clusters.view(),
            ),
        ];
        launches.extend(self.node(&parameters, 0, 0));
        launches.push(kernels::finish_manifolds(
            &parameters,
            inputs.guides.view(),
            self.sums.view(),
            self.near.view(),
            filtered.view(),
        ));
        launches
    }
}
