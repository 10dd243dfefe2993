//! Metals by their complex index of refraction `eta - i k`, which has a value for each of red,
//! green and blue.

use crate::glam::{UVec4, Vec3};
use crate::memory::device_struct;
use crate::memory::rows::{three_rows, vector};
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

device_struct! {
    /// A metal. 48 bytes.
    pub struct Conductor {
        /// Index of refraction, relative to the outside.
        pub eta: Vec3,
        /// Unused; zero.
        pub pad0: u32,
        /// Coefficient of extinction, relative to the outside.
        pub k: Vec3,
        /// Unused; zero.
        pub pad1: u32,
        /// Mean of [`fresnel`] over the cosine-weighted hemisphere.
        pub mean: Vec3,
        /// Unused; zero.
        pub pad2: u32,
    }
}

impl Conductor {
    /// Rows of one.
    pub const ROWS: u32 = 3;

    /// The one that lies from row `first` on.
    pub fn load(rows: &[UVec4], first: u32) -> Self {
        let [eta, k, mean] = three_rows(rows, first);
        Self {
            eta: vector(eta),
            pad0: eta.w,
            k: vector(k),
            pad1: k.w,
            mean: vector(mean),
            pad2: mean.w,
        }
    }

    /// What a smooth surface reflects of unpolarised light that arrives under this `cosine`.
    pub fn reflectance(&self, cosine: f32) -> Vec3 {
        Vec3::new(
            fresnel(cosine, self.eta.x, self.k.x),
            fresnel(cosine, self.eta.y, self.k.y),
            fresnel(cosine, self.eta.z, self.k.z),
        )
    }
}

/// Fresnel's reflectance of unpolarised light by a metal (Born, Wolf, "Principles of Optics", 7th
/// edition, section 14.2), from the cosine in [0, 1] on the side that it arrives on.
pub fn fresnel(cosine: f32, eta: f32, k: f32) -> f32 {
    let cos2 = cosine * cosine;
    let sin2 = 1.0 - cos2;
    // The refracted wave's index times its cosine is a - i b.
    let real = eta * eta - k * k - sin2;
    let norm = (real * real + 4.0 * (eta * k) * (eta * k)).sqrt();
    let a = (0.5 * (norm + real)).max(0.0).sqrt();
    let cross = 2.0 * a * cosine;
    let perpendicular = (norm + cos2 - cross) / (norm + cos2 + cross);
    let far = cos2 * norm + sin2 * sin2;
    let ratio = (far - cross * sin2) / (far + cross * sin2);
    0.5 * perpendicular * (1.0 + ratio)
}
