//! The film.

mod accumulate;
mod sums;
