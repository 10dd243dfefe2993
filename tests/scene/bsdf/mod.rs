//! Materials.

mod conductor;
mod diffuse;
mod maps;
mod principled;
mod specular;
