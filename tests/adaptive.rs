//! Whole renders that spend their samples adaptively: what becomes of the mean, of budgets, of
//! thresholds, and whether it is worth it.

mod common;

#[path = "adaptive/bias.rs"]
mod bias;
#[path = "adaptive/budgets.rs"]
mod budgets;
#[path = "adaptive/noise.rs"]
mod noise;
#[path = "adaptive/renders.rs"]
mod renders;
#[path = "adaptive/repeatability.rs"]
mod repeatability;
#[path = "adaptive/worth.rs"]
mod worth;
