//! OpenEXR files: our own with everything, those of other tools for their colours.

mod guard;
mod luminance;
mod primaries;
mod read;
mod select;
mod subsampling;
mod window;
mod write;

pub(super) use read::decode_color;
pub use read::{read_layers, read_settings};
pub use write::write_layers;
