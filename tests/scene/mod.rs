//! Scenes: files, traversal, and everything that is drawn at random against the density that it
//! claims.

mod bsdf;
mod camera;
mod environment;
mod environment_files;
mod errors;
mod files;
mod gltf;
mod leaks;
mod light;
mod loading;
mod mixed_scales;
mod places;
mod ply;
mod traversal;
