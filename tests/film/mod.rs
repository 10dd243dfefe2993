//! The film.

mod accumulate;
mod pixel_filter;
mod sums;
