//! What OBJ, MTL and scene files have in common as texts.

mod encoding;
mod lines;
mod name;

pub(super) use encoding::plain_text;
pub(super) use lines::{Lines, split_keyword, words};
pub(super) use name::{Name, shown};
