//! Launches of the filter `auto`: other filters, mixed as an estimate of the error says is best.

use super::bilateral::Bilateral;
use super::learned::{self, Learned};
use super::mixture::mix;
use super::{Filter, FilterInputs, FilterView};
use crate::exec::{Array, ExecError, Executor, Launch};
use crate::render::settings::estimation::FilterSettings;
use crate::scene::FilmSize;
use raystream_shaders::estimator::filtered::FilteredPixel;

/// A mixture of filters.
pub struct Auto<B> {
    /// What is taken where the estimate does not say that the second is better.
    first: Box<dyn Filter<B>>,
    second: Box<dyn Filter<B>>,
    by_first: Array<B, FilteredPixel>,
    by_second: Array<B, FilteredPixel>,
}

impl<B: Send + Sync + 'static> Auto<B> {
    /// For a picture of `size`: the filters `bilateral`, with these settings, and `learned`.
    ///
    /// # Errors
    /// If the device has no room for what it works in.
    pub fn new<E: Executor<Buffer = B>>(
        executor: &E,
        size: FilmSize,
        bilateral: FilterSettings,
    ) -> Result<Self, ExecError> {
        let learned = Learned::new(executor, size, &learned::weights())?;
        Self::of(executor, size, Box::new(Bilateral::new(bilateral)), Box::new(learned))
    }

    /// The same of any two filters.
    ///
    /// # Errors
    /// Likewise.
    pub fn of<E: Executor<Buffer = B>>(
        executor: &E,
        size: FilmSize,
        first: Box<dyn Filter<B>>,
        second: Box<dyn Filter<B>>,
    ) -> Result<Self, ExecError> {
        let pixels = (size.width * size.height) as usize;
        let filtered = || Array::zeroed(executor, "filtered pictures to be mixed", pixels);
        Ok(Self { first, second, by_first: filtered()?, by_second: filtered()? })
    }
}

impl<B: Send + Sync + 'static> Filter<B> for Auto<B> {
    fn launches<'a>(
        &'a self,
        inputs: &'a FilterInputs<B>,
        view: &FilterView,
        filtered: &'a Array<B, FilteredPixel>,
    ) -> Vec<Launch<'a, B>> {
        let mut launches = self.first.launches(inputs, view, &self.by_first);
        launches.extend(self.second.launches(inputs, view, &self.by_second));
        launches.extend(mix(inputs, &self.by_first, &self.by_second, filtered));
        launches
    }
}
