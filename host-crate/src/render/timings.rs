//! Where a render's time goes.

use crate::names::named;
use std::ops::{AddAssign, Index, IndexMut};
use std::time::Duration;

/// What the time of a launch is spent on; in the order in which they follow each other in a round.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Part {
    /// Tracing camera rays for the first-hit features.
    Features,
    /// Filtering and estimating errors.
    Estimation,
    /// Making sample streams of errors.
    Generation,
    /// Tracing paths.
    Tracing,
    /// Adding contributions to the film.
    Accumulation,
    /// Correcting the picture by the control film, at the end of a render.
    Resolve,
    /// Filtering the picture, at the end of a render, or to know its error on the way.
    Reconstruction,
}

named! {
    Part {
        Features: "features",
        Estimation: "estimation",
        Generation: "generation",
        Tracing: "tracing",
        Accumulation: "accumulation",
        Resolve: "resolve",
        Reconstruction: "reconstruction",
    }
}

/// Where a render's time went, by the device's clock.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Timings([Duration; Part::ALL.len()]);

impl Timings {
    /// The times that `time` gives the parts.
    pub fn from_fn(mut time: impl FnMut(Part) -> Duration) -> Self {
        Self(std::array::from_fn(|part| time(Part::ALL[part])))
    }

    /// Time of [`Part::Features`].
    pub fn features(&self) -> Duration {
        self[Part::Features]
    }

    /// Time of [`Part::Estimation`].
    pub fn estimation(&self) -> Duration {
        self[Part::Estimation]
    }

    /// Time of [`Part::Generation`].
    pub fn generation(&self) -> Duration {
        self[Part::Generation]
    }

    /// Time of [`Part::Tracing`].
    pub fn tracing(&self) -> Duration {
        self[Part::Tracing]
    }

    /// Time of [`Part::Accumulation`].
    pub fn accumulation(&self) -> Duration {
        self[Part::Accumulation]
    }

    /// Time of [`Part::Resolve`].
    pub fn resolve(&self) -> Duration {
        self[Part::Resolve]
    }

    /// Time of [`Part::Reconstruction`].
    pub fn reconstruction(&self) -> Duration {
        self[Part::Reconstruction]
    }
}

impl Index<Part> for Timings {
    type Output = Duration;

    fn index(&self, part: Part) -> &Duration {
        &self.0[part as usize]
    }
}

impl IndexMut<Part> for Timings {
    fn index_mut(&mut self, part: Part) -> &mut Duration {
        &mut self.0[part as usize]
    }
}

impl AddAssign for Timings {
    fn add_assign(&mut self, other: Self) {
        for (time, more) in self.0.iter_mut().zip(other.0) {
            *time += more;
        }
    }
}
