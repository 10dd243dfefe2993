//! The kernels that work on a scene as the CPU runs them: compiled for each level of
//! [abilities](crate::scene::abilities), of which there are few, since each takes as long to
//! compile as the first.
//!
//! They are compiled here, beside all that they call. Compiled by the crate that runs them they
//! would call into this one, and no call between crates is inlined.

use crate::for_each_kernel;
use crate::memory::access::{Atomics, Scatter};
use crate::scene::SceneView;
use crate::scene::abilities::{ALL, Abilities, BASIC, Fixed};

/// A method of [`Level`] for each row of the [table of kernels](crate::kernels) that has a scene,
/// `declared` or `defined`.
macro_rules! methods {
    ($mode:ident $(
        $(#[$doc:meta])*
        $name:ident[$workgroup:tt] $(phased($phases:expr, $Memory:ty))? = $function:path {
            uniform $parameters:ident: $Parameters:ty,
            $(with $scene:ident,)?
            $(read $read:ident: $Read:ty,)*
            $(write $written:ident: $Written:ty,)*
            $(scatter $scattered:ident: $Scattered:ty,)*
            $(atomic $atomic:ident,)*
        }
    )*) => {$(
        method! {
            [$($scene)?] $mode $(#[$doc])*
            $name = $function {
                $parameters: &$Parameters,
                $($scene: &SceneView<'_, Self>,)?
                $($read: &[$Read],)*
                $($written: &mut $Written,)*
                $($scattered: &mut Scatter<'_, $Scattered>,)*
                $($atomic: &mut Atomics<'_>,)*
            }
        }
    )*};
}

macro_rules! method {
    ([] $($rest:tt)*) => {};
    (
        [$scene:ident] declared $(#[$doc:meta])*
        $name:ident = $function:path { $($argument:ident: $Argument:ty,)* }
    ) => {
        $(#[$doc])*
        #[allow(clippy::too_many_arguments, reason = "one for each binding")]
        fn $name(lane: u32, $($argument: $Argument,)*);
    };
    (
        [$scene:ident] defined $(#[$doc:meta])*
        $name:ident = $function:path { $($argument:ident: $Argument:ty,)* }
    ) => {
        fn $name(lane: u32, $($argument: $Argument,)*) {
            $function(lane, $($argument,)*);
        }
    };
}

/// Abilities that the CPU has kernels for.
pub trait Level: Abilities {
    for_each_kernel!(methods declared);
}

impl Level for Fixed<BASIC> {
    for_each_kernel!(methods defined);
}

impl Level for Fixed<ALL> {
    for_each_kernel!(methods defined);
}
