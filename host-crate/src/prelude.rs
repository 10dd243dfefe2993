//! What most programs need: `use raystream::prelude::*;`.

pub use crate::exec::{Device, Executor};
pub use crate::film::Film;
pub use crate::render::{
    AllocatorKind, Budget, BvhQuality, IntegratorKind, PreparedScene, Renderer, Sampling, Settings,
};
pub use crate::scene::{FilmSize, Scene};
pub use crate::{image, render, scene};
