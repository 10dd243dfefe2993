//! Structs that cross between host and device.

/// Marks a struct as one that crosses between host and device as bytes.
///
/// The struct must be `repr(C)`, without padding, its `Vec3`s at multiples of 16 bytes and its size
/// one as well (or 8 bytes, of scalars): then Rust, std140 and std430 agree on its layout.
/// `bytemuck::Pod` checks the padding when the host is compiled; the rest is checked here.
macro_rules! device_struct {
    ($(#[$doc:meta])* $visibility:vis struct $name:ident { $($(#[$field_doc:meta])* $field_visibility:vis $field:ident: $ty:ty,)* }) => {
        $(#[$doc])*
        #[cfg_attr(
            not(target_arch = "spirv"),
            derive(Debug, PartialEq, Default, bytemuck::Pod, bytemuck::Zeroable)
        )]
        #[derive(Clone, Copy)]
        #[repr(C)]
        $visibility struct $name { $($(#[$field_doc])* $field_visibility $field: $ty,)* }

        #[cfg(not(target_arch = "spirv"))]
        const _: () = {
            assert!(core::mem::size_of::<$name>() % 16 == 0 || core::mem::size_of::<$name>() == 8);
            $(assert!(core::mem::size_of::<$ty>() % 12 != 0 || core::mem::offset_of!($name, $field) % 16 == 0);)*
        };
    };
}
pub(crate) use device_struct;
