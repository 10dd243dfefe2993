//! Scenes: files, traversal, and everything that is drawn at random against the density that it
//! claims.

mod bsdf;
mod camera;
mod cameras;
mod environment;
mod environment_files;
mod errors;
mod files;
mod format_2;
mod gltf;
mod holes;
mod instances;
mod lanes;
mod leaks;
mod light;
mod loading;
mod media;
mod mixed_scales;
mod places;
mod ply;
mod traversal;
