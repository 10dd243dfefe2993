//! Materials.

mod conductor;
mod diffuse;
mod layer_maps;
mod maps;
mod principled;
mod specular;
