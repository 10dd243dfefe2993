//! The error estimators: what they make of films whose truth is known, and the GPU against the CPU.

mod common;

#[path = "estimators/devices.rs"]
mod devices;
#[path = "estimators/edges.rs"]
mod edges;
#[path = "estimators/forms.rs"]
mod forms;
#[path = "estimators/noise.rs"]
mod noise;
#[path = "estimators/walls.rs"]
mod walls;
