//! Materials.

mod diffuse;
mod maps;
mod principled;
mod specular;
