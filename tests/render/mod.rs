//! Whole renders.

mod adaptive;
mod devices;
mod references;
mod rounds;
