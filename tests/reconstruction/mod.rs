//! Reconstruction: what filters make of films whose truth is known, and the GPU against the CPU.

mod devices;
mod films;
mod filters;
mod guard;
mod learned;
