//! The error estimators: what they make of films whose truth is known, and the GPU against the CPU.

mod devices;
mod edges;
mod forms;
mod noise;
pub mod walls;
