//! The film.

mod accumulate;
