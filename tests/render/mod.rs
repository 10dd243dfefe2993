//! Whole renders.

mod adaptive;
mod checkpoints;
mod devices;
mod references;
mod relay;
mod rounds;
mod team;
