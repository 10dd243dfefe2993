//! MTL files, and the rules that make a material of what they say.
//!
//! Read here and not by tobj, which panics on a colour of one number and keeps no line numbers.

mod library;
mod map;
mod rules;
mod values;
mod without_effect;

pub(in crate::scene) use library::{Ignored, Library};
pub(in crate::scene) use rules::{DEFAULT, Describer};
