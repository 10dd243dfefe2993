//! The film.

mod accumulate;
mod control;
mod pixel_filter;
mod sums;
