//! Exponentials and the like as kernels call them.
//!
//! A processor's library has functions of its own, so on the CPU they are those of
//! [`exact`](super::exact). A GPU has instructions for them, and in its exact module those of
//! [`exact`](super::exact) too. This is the one place where arithmetic differs between devices.

#[cfg(not(target_arch = "spirv"))]
pub use super::exact::{arc_tangent, exp, ln, pow};

#[cfg(target_arch = "spirv")]
pub use of_device::{arc_tangent, exp, ln, pow};

/// The GPU's own.
#[cfg(target_arch = "spirv")]
mod of_device {
    use spirv_std::num_traits::Float as _;

    /// `e^x`.
    pub fn exp(x: f32) -> f32 {
        x.exp()
    }

    /// The natural logarithm.
    pub fn ln(x: f32) -> f32 {
        x.ln()
    }

    /// `x^y`.
    pub fn pow(x: f32, y: f32) -> f32 {
        x.powf(y)
    }

    /// The angle of the point `(x, y)`.
    pub fn arc_tangent(y: f32, x: f32) -> f32 {
        y.atan2(x)
    }
}
