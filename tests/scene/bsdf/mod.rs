//! Materials.

mod absorption;
mod diffuse;
mod maps;
mod principled;
mod specular;
