//! Figures: numbers as colours with a legend ([`color_map`]), the layers of a render as pictures
//! ([`png_layers`]), plots (`plot`), pictures for another viewer (`tev`), and how often a render
//! under way is shown ([`pace`]).

mod canvas;
pub mod color_map;
mod color_scale;
mod error;
mod legend;
pub mod pace;
#[cfg(feature = "plots")]
pub mod plot;
pub mod png_layers;
mod scale;
#[cfg(feature = "tev")]
pub mod tev;

pub use color_map::write_color_map;
pub use color_scale::ColorScale;
pub use error::FigureError;
pub use pace::Pace;
pub use png_layers::{png_layer_paths, write_png_layers};
