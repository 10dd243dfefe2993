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
    /// One for each candidate.
    first: Vec<Array<B, Vec4>>,
    second: Vec<Array<B, Vec4>>,
}

impl<B> FilteredHalves<B> {
    /// For a picture of `size`, of which so many `candidates` are made at once.
    pub fn new<E: Executor<Buffer = B>>(
        executor: &E,
        size: FilmSize,
        candidates: usize,
    ) -> Result<Self, ExecError> {
        let pixels = (size.width * size.height) as usize;
        let half = || Array::zeroed(executor, "filtered halves", pixels);
        let halves = || (0..candidates).map(|_| half()).collect::<Result<_, ExecError>>();
        let (first_rows, second_rows) = (half()?, half()?);
        Ok(Self { first_rows, second_rows, first: halves()?, second: halves()? })
    }

    /// The launches after which the halves are those of `inputs`; before all of [`Self::filter`].
    pub fn rows<'a>(&'a self, inputs: &'a FilterInputs<B>) -> [Launch<'a, B>; 2] {
        let parameters = inputs.parameters();
        [
            kernels::half_in_rows(&parameters, inputs.first.view(), self.first_rows.view()),
            kernels::half_in_rows(&parameters, inputs.second.view(), self.second_rows.view()),
        ]
    }

    /// The launches after which each of `filtered` is of both halves of a candidate: `filter` makes
    /// those which filter a half, of what weighs it and the half, both in rows, and where the
    /// results go. Each is weighed by the other.
    pub fn filter<'a, L>(
        &'a self,
        inputs: &'a FilterInputs<B>,
        filtered: &[&'a Array<B, FilteredPixel>],
        filter: impl Fn(&'a Array<B, Vec4>, &'a Array<B, Vec4>, &'a [Array<B, Vec4>]) -> L,
    ) -> Vec<Launch<'a, B>>
    where
        L: IntoIterator<Item = Launch<'a, B>>,
    {
        let (first, second) = (&self.first_rows, &self.second_rows);
        let mut launches: Vec<_> = filter(second, first, &self.first).into_iter().collect();
        launches.extend(filter(first, second, &self.second));
        for (filtered, (first, second)) in filtered.iter().zip(self.first.iter().zip(&self.second))
        {
            launches.push(kernels::join_halves(
                &inputs.parameters(),
                inputs.guides.view(),
                inputs.first.view(),
                first.view(),
                second.view(),
                filtered.view(),
            ));
        }
        launches
    }
}
