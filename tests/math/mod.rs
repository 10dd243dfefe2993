//! Random numbers, and what is made of them.
//!
//! Chi-square tests reject what is farther from its density than chance takes independent numbers.
//! Sobol points of one pixel lie closer than that, so for them the same limit says that they are no
//! worse.

mod devices;
mod independence;
mod power_heuristic;
mod quantiles;
mod uniformity;
