//! The pinhole camera.

use crate::glam::Vec3;
use crate::memory::device_struct;
use crate::scene::ray::Ray;

/// [`Camera::pixel_of`] what the picture does not show.
pub const NO_PIXEL: u32 = u32::MAX;

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

    /// The direction in which it looks, unit length.
    fn axis(&self) -> Vec3 {
        self.right.normalize().cross(self.down.normalize())
    }

    /// Density per solid angle of [`Self::ray`]'s `direction` (unit length, ahead of the camera)
    /// where `jitter` is uniform: that of a pixel's area `A` on the plane at distance 1, seen under
    /// the cosine `c`, is `1 / (A c^3)`. It is as well the importance that the pixel's mean
    /// radiance gives to radiance from there (Veach 1997, section 8.3.2).
    pub fn pdf(&self, direction: Vec3) -> f32 {
        let area = self.right.length() * self.down.length();
        let cosine = self.axis().dot(direction);
        1.0 / (area * cosine * cosine * cosine)
    }

    /// The pixel where the camera sees `position`, row by row from the top, or [`NO_PIXEL`].
    pub fn pixel_of(&self, position: Vec3) -> u32 {
        let offset = position - self.origin;
        let depth = self.axis().dot(offset);
        if depth <= 0.0 {
            return NO_PIXEL;
        }
        let on_plane = offset / depth - self.top_left;
        let x = on_plane.dot(self.right.normalize()) / self.right.length();
        let y = on_plane.dot(self.down.normalize()) / self.down.length();
        if x >= 0.0 && x < self.width as f32 && y >= 0.0 && y < self.height as f32 {
            y as u32 * self.width + x as u32
        } else {
            NO_PIXEL
        }
    }
}
