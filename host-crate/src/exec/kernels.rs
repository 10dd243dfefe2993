//! The table of kernels as data, from [`raystream_shaders::for_each_kernel!`].

/// A kernel: what the host must know to launch it.
#[derive(Debug)]
pub struct Kernel {
    /// Name of the entry point.
    pub name: &'static str,
    /// Threads in a workgroup.
    pub workgroup_size: u32,
    /// What it binds; the index is the binding number, in descriptor set 0.
    pub bindings: &'static [Binding],
}

/// A buffer that a kernel binds.
#[derive(Debug)]
pub struct Binding {
    /// Name of the kernel's parameter.
    pub name: &'static str,
    /// What the kernel does with it.
    pub access: Access,
}

/// What a kernel does with a buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Access {
    /// Reads it as a uniform buffer.
    Uniform,
    /// Reads it as a storage buffer.
    Read,
    /// Reads and writes it as a storage buffer; every lane its own element.
    Write,
}

macro_rules! kernels {
    ($(
        $(#[$doc:meta])*
        $name:ident[$workgroup:tt] = $function:path {
            uniform $uniform_binding:tt $parameters:ident: $Parameters:ty,
            $(read $read_binding:tt $read:ident: $Read:ty,)*
            $(write $write_binding:tt $written:ident: $Written:ty,)*
        }
    )*) => {
        /// All kernels.
        pub const ALL: &[&Kernel] = &[$(
            &Kernel {
                name: stringify!($name),
                workgroup_size: $workgroup,
                bindings: &[
                    Binding { name: stringify!($parameters), access: Access::Uniform },
                    $(Binding { name: stringify!($read), access: Access::Read },)*
                    $(Binding { name: stringify!($written), access: Access::Write },)*
                ],
            },
        )*];
    };
}
raystream_shaders::for_each_kernel!(kernels);
