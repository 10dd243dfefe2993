//! Whole renders that spend their samples adaptively: what becomes of the mean, of budgets, of
//! thresholds, and whether it is worth it.

mod bias;
mod budgets;
mod filtering;
mod noise;
mod renders;
mod repeatability;
mod worth;
