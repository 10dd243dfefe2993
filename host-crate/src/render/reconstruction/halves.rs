//! Halves of a picture that filters weigh by each other.

use super::FilterInputs;
use crate::exec::{Array, ExecError, Executor, Launch, kernels};
use crate::scene::FilmSize;
use glam::Vec4;
use raystream_shaders::estimator::filtered::FilteredPixel;

/// Both halves as a filter looks at them, in rows, and as it leaves them, in rank order.
pub struct FilteredHalves<B> {
    first_rows: Array<B, Vec4>,
    second_rows: Array<B, Vec4>,
    first: Array<B, Vec4>,
    second: Array<B, Vec4>,
}

impl<B> FilteredHalves<B> {
    /// For a picture of `size`.
    pub fn new<E: Executor<Buffer = B>>(executor: &E, size: FilmSize) -> Result<Self, ExecError> {
        let pixels = (size.width * size.height) as usize;
        let half = || Array::zeroed(executor, "filtered halves", pixels);
        let (first_rows, second_rows) = (half()?, half()?);
        Ok(Self { first_rows, second_rows, first: half()?, second: half()? })
    }

    /// The launches after which the halves are those of `inputs`; before all of [`Self::filter`].
    pub fn rows<'a>(&'a self, inputs: &'a FilterInputs<B>) -> [Launch<'a, B>; 2] {
        let parameters = inputs.parameters();
        [
            kernels::half_in_rows(&parameters, inputs.first.view(), self.first_rows.view()),
            kernels::half_in_rows(&parameters, inputs.second.view(), self.second_rows.view()),
        ]
    }

    /// The launches after which `filtered` is of both halves: `filter` makes those which filter a
    /// half, of what weighs it and the half, both in rows, and where the result goes. Each is
    /// weighed by the other.
    pub fn filter<'a, L>(
        &'a self,
        inputs: &'a FilterInputs<B>,
        filtered: &'a Array<B, FilteredPixel>,
        filter: impl Fn(&'a Array<B, Vec4>, &'a Array<B, Vec4>, &'a Array<B, Vec4>) -> L,
    ) -> Vec<Launch<'a, B>>
    where
        L: IntoIterator<Item = Launch<'a, B>>,
    {
        let (first, second) = (&self.first_rows, &self.second_rows);
        let mut launches: Vec<_> = filter(second, first, &self.first).into_iter().collect();
        launches.extend(filter(first, second, &self.second));
        launches.push(kernels::join_halves(
            &inputs.parameters(),
            inputs.guides.view(),
            inputs.first.view(),
            self.first.view(),
            self.second.view(),
            filtered.view(),
        ));
        launches
    }
}
