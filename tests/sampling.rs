//! Everything that is drawn at random, against the density that it claims.
//!
//! Chi-square tests reject what is farther from its density than chance takes independent numbers.
//! Sobol points of one pixel lie closer than that, so for them the same limit says that they are no
//! worse.

mod common;

#[path = "sampling/camera.rs"]
mod camera;
#[path = "sampling/directions.rs"]
mod directions;
#[path = "sampling/histogram.rs"]
mod histogram;
#[path = "sampling/independence.rs"]
mod independence;
#[path = "sampling/lights.rs"]
mod lights;
#[path = "sampling/specular.rs"]
mod specular;
#[path = "sampling/uniformity.rs"]
mod uniformity;
#[path = "sampling/weights.rs"]
mod weights;
