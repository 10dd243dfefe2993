//! Raystream's kernels.
//!
//! Every function here is compiled twice: to SPIR-V by rust-gpu and natively for the CPU. A kernel is a
//! plain function over slices and small `Copy` structs; [`kernels`] lists them all and makes of each
//! row of that list the GPU's entry point and (in the host crate) the native loop.
//!
//! Reading order, along one sample: [`tiles`] and [`stream`] (which pixel a slot traces), [`sampler`],
//! [`camera`], [`path`] (the tracer), [`bvh`] and [`triangle`], [`surface`], [`material`], [`light`],
//! and back into the [`film`]. [`wavefront`] and [`regeneration`] walk the same paths in other orders, [`lvc`] traces bidirectionally.
//! Between rounds, [`guide`], [`filter`] and [`estimate`] say where the film is wrong, and [`runs`] spends
//! the next samples there.
#![no_std]
#![deny(missing_docs)]

pub mod access;
pub mod atomic;
pub mod bvh;
pub mod camera;
pub mod compaction;
pub mod error_scale;
pub mod estimate;
pub mod features;
pub mod film;
pub mod filter;
pub mod guide;
pub mod kernels;
pub mod light;
pub mod lvc;
pub mod material;
pub mod math;
pub mod paper;
pub mod path;
pub mod pool;
pub mod prefix;
pub mod probe;
pub mod ray;
pub mod regeneration;
pub mod rows;
pub mod runs;
pub mod sampler;
pub mod scene;
pub mod soa;
pub mod stream;
pub mod surface;
pub mod texture;
pub mod tiles;
pub mod triangle;
pub mod wavefront;
pub mod wide;

pub use spirv_std::glam;

/// Marks a struct as one that crosses between host and device as bytes.
///
/// The struct must be `repr(C)`, without padding, its `Vec3`s at multiples of 16 bytes and its size one
/// as well (or 8 bytes, of scalars): then Rust, std140 and std430 agree on its layout. `bytemuck::Pod` checks the padding when
/// the host is compiled; the rest is checked here.
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
