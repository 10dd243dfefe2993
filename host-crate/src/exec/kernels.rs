//! The table of kernels as data, made from [`raystream_shaders::for_each_kernel!`].

use super::native::{NativeArguments, NativeBinding};
use rayon::prelude::*;

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
    /// A storage buffer of which each thread reads and writes the element of its own number.
    Write,
}

macro_rules! kernel_statics {
    ($(
        $(#[$doc:meta])*
        $name:ident[$workgroup:tt] = $function:path {
            uniform $uniform_binding:tt $parameters:ident: $Parameters:ty,
            $(read $read_binding:tt $read:ident: $Read:ty,)*
            $(write $write_binding:tt $written:ident: $Written:ty,)*
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
                ],
                native: {
                    fn native(arguments: NativeArguments<'_>) {
                        let $parameters: $Parameters = arguments.parameters();
                        let threads = $parameters.threads as usize;
                        let mut views = arguments.views.into_iter();
                        $(let $read: &[$Read] = views.next().map_or(&[], NativeBinding::into_slice);)*
                        $(let $written: &mut [$Written] = views.next().map_or(&mut [], NativeBinding::into_slice_mut);)*
                        ($($written[..threads].par_iter_mut(),)*)
                            .into_par_iter()
                            .enumerate()
                            .for_each(|(lane, ($($written,)*))| {
                                $function(lane as u32, &$parameters, $($read,)* $($written,)*);
                            });
                    }
                    native
                },
            };
        )*

        /// All kernels.
        pub static ALL: &[&Kernel] = &[$(&$name),*];
    };
}
raystream_shaders::for_each_kernel!(kernel_statics);
