//! Reconstruction: a picture with less noise than the film's, by a filter over pixels that look
//! alike.
//!
//! All filters go the same way. [`halves`] makes what they look at: guides, the means of both
//! halves, and variances that are measured and not assumed. A filter, a file or folder each, turns
//! these into [`FilteredPixel`](crate::estimator::filtered::FilteredPixel)s; a [`mixture`] is one
//! of two others. [`guard`] then says how far a pixel may trust its filter and what error is left,
//! and [`mean`] gives the picture back the light that the filter has lost. Whatever the filter gets
//! wrong, the picture therefore converges to the truth.

pub mod axis_aligned;
pub mod features;
pub mod gem;
pub mod guard;
pub mod halves;
pub mod learned;
pub mod manifolds;
pub mod mean;
pub mod mixture;
pub mod nfor;
pub mod nlm;
pub mod patch_map;
pub mod patches;

use crate::film::tiles::pixel_of_rank;
use crate::memory::device_struct;

device_struct! {
    /// The parameters of a pass over pixels in rank order. 16 bytes.
    pub struct PictureParams {
        /// Pixels of the pass.
        pub threads: u32,
        /// Rank of the first, where not all are bound.
        pub first_rank: u32,
        /// Picture width in pixels.
        pub width: u32,
        /// Picture height in pixels.
        pub height: u32,
    }
}

impl PictureParams {
    /// Where the pixel of a rank lies in rows.
    pub fn row_index(&self, rank: u32) -> u32 {
        let (x, y) = pixel_of_rank(rank, self.width, self.height);
        y * self.width + x
    }
}
