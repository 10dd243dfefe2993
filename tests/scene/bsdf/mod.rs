//! Materials.

mod diffuse;
mod specular;
