//! What filters make of a picture, which estimators take differences from.

use crate::glam::Vec3;
use crate::memory::device_struct;

device_struct! {
    /// What a filter makes of one pixel. 16 bytes.
    pub struct FilteredPixel {
        /// The filtered radiance, linear Rec.709.
        pub color: Vec3,
        /// How far `color` follows the pixel's own mean, from 0 to 1: the derivative, which is the
        /// pixel's own weight where weights do not depend on its noise.
        pub own: f32,
    }
}
