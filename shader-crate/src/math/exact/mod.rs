//! Functions that have the same bits on every device.
//!
//! Vulkan lets a driver be off by some units in division and square root, and has no bound at all
//! that would make an exponential the same on two devices. It asks for sums, products, comparisons
//! and conversions that are rounded correctly, unless they are fused. So a module in which nothing
//! is fused, and in which these functions stand for the others, computes what the CPU computes:
//!
//! | here | on the CPU | on a GPU, fast | on a GPU, exact |
//! |---|---|---|---|
//! | [`divide`] or [`divide_fused`] | `/` | the driver's | this |
//! | [`square_root`] or [`square_root_fused`] | `sqrt` | the driver's | this |
//! | [`exp`], [`ln`], [`pow`], [`arc_tangent`] | this | the driver's | this |
//!
//! Kernels say `/`, `sqrt` and [`elementary`](super::elementary). The host makes the exact module
//! of the fast one: there it calls these functions instead. It finds them in the kernel
//! [`calculate`], which calls each of [`CALLED`] once, in that order.

mod arithmetic;
mod functions;
mod fused;

pub use arithmetic::{divide, square_root};
pub use functions::{arc_tangent, exp, ln, pow};
pub use fused::{divide_fused, square_root_fused};

use crate::memory::access::at;
use crate::memory::device_struct;
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

/// The functions that stand for a driver's, in the order in which [`calculate`] calls them.
pub const CALLED: [Function; 8] = [
    Function::Exponential,
    Function::Logarithm,
    Function::Power,
    Function::Angle,
    Function::Quotient,
    Function::Root,
    Function::FusedQuotient,
    Function::FusedRoot,
];

/// What a driver computes in a way of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Function {
    /// [`exp`].
    Exponential,
    /// [`ln`].
    Logarithm,
    /// [`pow`].
    Power,
    /// [`arc_tangent`].
    Angle,
    /// [`divide`].
    Quotient,
    /// [`square_root`].
    Root,
    /// [`divide_fused`].
    FusedQuotient,
    /// [`square_root_fused`].
    FusedRoot,
}

device_struct! {
    /// The parameters of [`calculate`]. 16 bytes.
    pub struct CalculateParams {
        /// Pairs of operands.
        pub threads: u32,
        /// Unused; zero.
        pub pad: u32,
        /// Unused; zero.
        pub pad_2: u32,
        /// Unused; zero.
        pub pad_3: u32,
    }
}

device_struct! {
    /// What [`calculate`] is given, as bits: a device may flush subnormal numbers that it loads as
    /// such. 16 bytes.
    pub struct Operands {
        /// The first.
        pub a: u32,
        /// The second.
        pub b: u32,
        /// The third, which is added to a product.
        pub c: u32,
        /// Unused; zero.
        pub pad: u32,
    }
}

device_struct! {
    /// What [`calculate`] makes of its operands, as bits. 64 bytes.
    pub struct Results {
        /// `a + b`, by the device.
        pub sum: u32,
        /// `a * b`, by the device.
        pub product: u32,
        /// `a * b + c`, of two roundings where nothing is fused.
        pub product_sum: u32,
        /// `a / b`, as kernels divide.
        pub quotient: u32,
        /// The root of `a`, as kernels find it.
        pub root: u32,
        /// `e^a`.
        pub exponential: u32,
        /// The natural logarithm of `a`.
        pub logarithm: u32,
        /// `a^b`.
        pub power: u32,
        /// The angle of the point `(b, a)`.
        pub angle: u32,
        /// [`divide`].
        pub divided: u32,
        /// [`square_root`].
        pub rooted: u32,
        /// [`divide_fused`].
        pub fused_quotient: u32,
        /// [`square_root_fused`].
        pub fused_root: u32,
        /// Unused; zero.
        pub pad: u32,
        /// Unused; zero.
        pub pad_2: [u32; 2],
    }
}

/// Kernel: all functions of pair `lane`. It shows what a device computes, and through it the
/// compiled module has every function that stands for one of the drivers'.
pub fn calculate(lane: u32, _: &CalculateParams, operands: &[Operands], results: &mut Results) {
    let given = at(operands, lane);
    let (a, b) = (f32::from_bits(given.a), f32::from_bits(given.b));
    let c = f32::from_bits(given.c);
    *results = Results {
        sum: (a + b).to_bits(),
        product: (a * b).to_bits(),
        product_sum: (a * b + c).to_bits(),
        quotient: (a / b).to_bits(),
        root: a.sqrt().to_bits(),
        exponential: exp(a).to_bits(),
        logarithm: ln(a).to_bits(),
        power: pow(a, b).to_bits(),
        angle: arc_tangent(a, b).to_bits(),
        divided: divide(a, b).to_bits(),
        rooted: square_root(a).to_bits(),
        fused_quotient: divide_fused(a, b).to_bits(),
        fused_root: square_root_fused(a).to_bits(),
        pad: 0,
        pad_2: [0; 2],
    };
}

/// What tests of these functions share.
#[cfg(test)]
mod bits {
    /// `off` units in the last place above `x`.
    pub fn beside(x: f32, off: i32) -> f32 {
        f32::from_bits(x.to_bits().wrapping_add_signed(off))
    }

    /// Whether both are the same number, bit for bit, or neither is one.
    pub fn is_same(found: f32, expected: f32) -> bool {
        found.to_bits() == expected.to_bits() || (found.is_nan() && expected.is_nan())
    }
}
