//! The table of kernels as data, made from [`raystream_shaders::for_each_kernel!`].

use super::native::{NativeArguments, NativeBinding};
use rayon::prelude::*;
use raystream_shaders::memory::access::{Atomics, Scatter};
use raystream_shaders::parallel::prefix::Lane;

/// A kernel, as both executors need to know it.
pub struct Kernel {
    /// Name of the SPIR-V entry point.
    pub name: &'static str,
    /// Threads of one workgroup, along x.
    pub workgroup_size: u32,
    /// What it binds; the index is the binding's number in descriptor set 0.
    pub bindings: &'static [Binding],
    /// Runs all its threads on the CPU.
    pub(super) native: fn(NativeArguments<'_>),
}

/// One binding of a kernel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Binding {
    /// What the table calls it.
    pub name: &'static str,
    /// What the kernel does with it.
    pub access: Access,
}

/// What a kernel does with a binding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Access {
    /// A uniform buffer that all threads read.
    Uniform,
    /// A storage buffer that any thread reads anywhere.
    Read,
    /// A storage buffer that threads write: each the element of its own number, or wherever no
    /// other thread does, or by atomics.
    Write,
}

macro_rules! kernel_statics {
    ($(
        $(#[$doc:meta])*
        $name:ident[$workgroup:tt] $(phased($phases:expr, $Memory:ty))? = $function:path {
            uniform $uniform_binding:tt $parameters:ident: $Parameters:ty,
            $(read $read_binding:tt $read:ident: $Read:ty,)*
            $(write $write_binding:tt $written:ident: $Written:ty,)*
            $(scatter $scatter_binding:tt $scattered:ident: $Scattered:ty,)*
            $(atomic $atomic_binding:tt $atomic:ident,)*
        }
    )*) => {
        $(
            $(#[$doc])*
            #[allow(non_upper_case_globals)] // called like its entry point
            pub static $name: Kernel = Kernel {
                name: stringify!($name),
                workgroup_size: $workgroup,
                bindings: &[
                    Binding { name: stringify!($parameters), access: Access::Uniform },
                    $(Binding { name: stringify!($read), access: Access::Read },)*
                    $(Binding { name: stringify!($written), access: Access::Write },)*
                    $(Binding { name: stringify!($scattered), access: Access::Write },)*
                    $(Binding { name: stringify!($atomic), access: Access::Write },)*
                ],
                native: {
                    fn native(arguments: NativeArguments<'_>) {
                        let $parameters: $Parameters = arguments.parameters();
                        let mut views = arguments.views.into_iter();
                        $(let $read: &[$Read] = views.next().map_or(&[], NativeBinding::into_slice);)*
                        $(let $written: &mut [$Written] = views.next().map_or(&mut [], NativeBinding::into_slice_mut);)*
                        $(let $scattered = Scatter::<$Scattered>::new(views.next().map_or(&[], NativeBinding::into_atomics));)*
                        $(let $atomic = Atomics::new(views.next().map_or(&[], NativeBinding::into_atomics));)*
                        native_loop! {
                            [$($phases, $Memory)?] [$workgroup] $function, $parameters,
                            ($($read)*) ($($written)*) ($($scattered)*) ($($atomic)*)
                        }
                    }
                    native
                },
            };
        )*

        /// All kernels.
        pub static ALL: &[&Kernel] = &[$(&$name),*];
    };
}

/// Calls the function of a kernel for all lanes.
macro_rules! native_loop {
    (
        [] [$workgroup:tt] $function:path, $parameters:ident,
        ($($read:ident)*) ($($written:ident)*) ($($scattered:ident)*) ($($atomic:ident)*)
    ) => {
        let threads = $parameters.threads;
        ((0..threads).into_par_iter(), $($written[..threads as usize].par_iter_mut(),)*).into_par_iter().for_each(
            |(lane, $($written,)*)| {
                $function(
                    lane,
                    &$parameters,
                    $($read,)*
                    $($written,)*
                    $(&mut { $scattered },)*
                    $(&mut { $atomic },)*
                );
            },
        );
    };
    (
        [$phases:expr, $Memory:ty] [$workgroup:tt] $function:path, $parameters:ident,
        ($($read:ident)*) () ($($scattered:ident)*) ()
    ) => {
        (0..$parameters.threads.div_ceil($workgroup)).into_par_iter().for_each(|group| {
            let mut memory: $Memory = [0; size_of::<$Memory>() / size_of::<u32>()];
            for phase in 0..$phases {
                for index in 0..$workgroup {
                    let lane = Lane { group, index };
                    $function(phase, lane, &$parameters, $($read,)* $(&mut { $scattered },)* &mut memory);
                }
            }
        });
    };
}
raystream_shaders::for_each_kernel!(kernel_statics);
