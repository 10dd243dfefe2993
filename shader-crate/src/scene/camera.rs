//! The pinhole camera.

use crate::glam::Vec3;
use crate::memory::device_struct;
use crate::scene::ray::Ray;

device_struct! {
    /// A pinhole camera that looks at a `width x height` picture plane at distance 1. 64 bytes.
    pub struct Camera {
        /// The pinhole, in world units.
        pub origin: Vec3,
        /// Picture width in pixels.
        pub width: u32,
        /// From the pinhole to the picture plane's top left corner.
        pub top_left: Vec3,
        /// Picture height in pixels.
        pub height: u32,
        /// One pixel to the right.
        pub right: Vec3,
        /// Unused; zero.
        pub pad0: u32,
        /// One pixel down.
        pub down: Vec3,
        /// Unused; zero.
        pub pad1: u32,
    }
}

impl Camera {
    /// The ray of unit length through the point `jitter` (in [0, 1)^2) of the pixel `(x, y)`; (0,
    /// 0) is top left.
    pub fn ray(&self, x: u32, y: u32, jitter: [f32; 2]) -> Ray {
        let (x, y) = (x as f32 + jitter[0], y as f32 + jitter[1]);
        Ray::new(self.origin, (self.top_left + self.right * x + self.down * y).normalize())
    }
}
