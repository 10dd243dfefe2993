//! Whole renders.

mod adaptive;
mod checkpoints;
mod devices;
mod references;
mod rounds;
mod team;
