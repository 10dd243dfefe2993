//! What adaptive sampling estimates of each pixel.

use crate::device_struct;
use crate::glam::Vec3;

device_struct! {
    /// What an estimator thinks of one pixel. 16 bytes.
    pub struct Estimate {
        /// The filtered picture (or the mean radiance, where the estimator filters nothing), linear Rec.709.
        pub filtered: Vec3,
        /// Estimated squared error of the pixel's mean radiance: the mean over the components, in squared radiance.
        pub squared_error: f32,
    }
}
