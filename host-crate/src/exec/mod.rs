//! Running kernels on a device.
//!
//! [`kernels`] is the table of what can be run. An [`Executor`] owns buffers and runs launches of
//! kernels over them: [`cpu`] calls the native functions through rayon, [`gpu`] the SPIR-V entry
//! points through wgpu. Everything above this module is generic over the trait and exists once.

pub mod arithmetic;
pub mod array;
mod counter;
pub mod counting;
pub mod cpu;
pub mod device;
pub mod devices;
#[cfg(feature = "gpu")]
pub mod gpu;
pub mod kernels;
#[cfg(target_arch = "x86_64")]
mod lanes;
mod launch;
mod native;
mod paired;
mod scene_buffers;
mod table;

use raystream_shaders::scene::bvh::wide::lanes::Simd;
use std::time::Duration;

pub use array::Array;
pub use counter::Counter;
pub use counting::Counting;
pub use device::Device;
pub use kernels::{Access, Binding, Kernel};
pub use launch::{Launch, RawView, View, run_over};
pub use native::{NativeArguments, NativeBinding};
pub use paired::{Difference, Paired, PairedBuffer, Parting, UNORDERED};
pub use scene_buffers::SceneBuffers;
pub use table::Table;

/// Runs kernels over buffers that it owns.
pub trait Executor {
    /// A piece of the device's memory.
    type Buffer: Send + Sync + 'static;

    /// What may be asked of the device.
    fn limits(&self) -> Limits;

    /// The device, for messages.
    fn name(&self) -> &str;

    /// Fails where a buffer of `bytes` would be larger than a kernel can be given.
    fn check_size(&self, label: &'static str, bytes: u64) -> Result<(), ExecError> {
        let limit = self.limits().buffer_bytes;
        if bytes > limit {
            return Err(ExecError::TooLarge {
                device: self.name().to_owned(),
                label,
                bytes,
                limit,
            });
        }
        Ok(())
    }

    /// Makes kernels ready for scenes with these
    /// [`abilities`](raystream_shaders::scene::abilities), so that no launch waits for a compiler.
    fn prepare(&self, abilities: u32) -> Result<(), ExecError>;

    /// Whether its lanes run in step, in groups, so that each waits for the slowest of its group.
    fn runs_in_step(&self) -> bool {
        true
    }

    /// The instructions by which it traverses scenes, if it does so in another way than GPUs.
    fn simd(&self) -> Option<Simd> {
        None
    }

    /// A new buffer of `bytes` (at least 1), zeroed. `label` names it in errors.
    fn allocate(&self, label: &'static str, bytes: u64) -> Result<Self::Buffer, ExecError>;

    /// Copies `bytes` into `buffer` from `first_byte` on; both multiples of 4.
    fn write(&self, buffer: &Self::Buffer, first_byte: u64, bytes: &[u8]) -> Result<(), ExecError>;

    /// Fills `bytes` from `buffer` from `first_byte` on; both multiples of 4.
    fn read(
        &self,
        buffer: &Self::Buffer,
        first_byte: u64,
        bytes: &mut [u8],
    ) -> Result<(), ExecError>;

    /// Runs the launches of all `parts` one after the other, each seeing what those before it
    /// wrote, and waits for them. Returns how long each part took: by the device's own clock where
    /// it has one. To read that clock takes a GPU some microseconds, as long as small launches
    /// take: so they are timed together where only their sum is wanted.
    fn run_parts(&self, parts: &[&[Launch<'_, Self::Buffer>]]) -> Result<Vec<Duration>, ExecError>;

    /// Runs `launches` likewise, and returns how long each took.
    fn run(&self, launches: &[Launch<'_, Self::Buffer>]) -> Result<Vec<Duration>, ExecError> {
        self.run_parts(&launches.chunks(1).collect::<Vec<_>>())
    }
}

/// A reference stands for the executor, so that a renderer can own one that others use as well.
impl<E: Executor> Executor for &E {
    type Buffer = E::Buffer;

    fn limits(&self) -> Limits {
        (**self).limits()
    }

    fn name(&self) -> &str {
        (**self).name()
    }

    fn check_size(&self, label: &'static str, bytes: u64) -> Result<(), ExecError> {
        (**self).check_size(label, bytes)
    }

    fn prepare(&self, abilities: u32) -> Result<(), ExecError> {
        (**self).prepare(abilities)
    }

    fn runs_in_step(&self) -> bool {
        (**self).runs_in_step()
    }

    fn simd(&self) -> Option<Simd> {
        (**self).simd()
    }

    fn allocate(&self, label: &'static str, bytes: u64) -> Result<Self::Buffer, ExecError> {
        (**self).allocate(label, bytes)
    }

    fn write(&self, buffer: &Self::Buffer, first_byte: u64, bytes: &[u8]) -> Result<(), ExecError> {
        (**self).write(buffer, first_byte, bytes)
    }

    fn read(
        &self,
        buffer: &Self::Buffer,
        first_byte: u64,
        bytes: &mut [u8],
    ) -> Result<(), ExecError> {
        (**self).read(buffer, first_byte, bytes)
    }

    fn run_parts(&self, parts: &[&[Launch<'_, Self::Buffer>]]) -> Result<Vec<Duration>, ExecError> {
        (**self).run_parts(parts)
    }
}

/// What may be asked of a device.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Largest buffer, and largest part of one that a kernel can be given, in bytes.
    pub buffer_bytes: u64,
    /// What the first byte of a part must be a multiple of.
    pub alignment: u64,
}

/// What `allocate` makes of `capacity` or, as long as the device lacks the memory, of half of it,
/// and so on; of no less than half of `smallest`.
pub fn halve_until_it_fits<T>(
    capacity: u32,
    smallest: u32,
    mut allocate: impl FnMut(u32) -> Result<T, ExecError>,
) -> Result<T, ExecError> {
    let mut capacity = capacity;
    loop {
        match allocate(capacity) {
            Err(ExecError::OutOfMemory { .. }) if capacity > smallest => capacity /= 2,
            done => return done,
        }
    }
}

/// What can go wrong on a device.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExecError {
    /// A name that fits no device.
    #[error("no device matches '{name}'; there are: {known}")]
    NoSuchDevice {
        /// What was asked for.
        name: String,
        /// What there is.
        known: String,
    },
    /// Asked for a GPU where there is none.
    #[error(
        "there is no GPU that Vulkan, Metal or DirectX 12 can use; install its driver or use the \
         CPU"
    )]
    NoGpu,
    /// The device lacks something that the kernels need.
    #[error("{device} cannot run the kernels: {reason}; use the CPU")]
    Unsuitable {
        /// The device.
        device: String,
        /// What it lacks.
        reason: String,
    },
    /// A buffer does not fit.
    #[error(
        "{device} has no room for {bytes} bytes of {label}; use a smaller picture or scene, close \
         other programs, or choose another device"
    )]
    OutOfMemory {
        /// The device.
        device: String,
        /// What the buffer is for.
        label: &'static str,
        /// Its size.
        bytes: u64,
    },
    /// A buffer is larger than a kernel can be given.
    #[error(
        "{device} gives a kernel at most {limit} bytes at once, but {label} takes {bytes}; use \
         the CPU"
    )]
    TooLarge {
        /// The device.
        device: String,
        /// What the buffer is for.
        label: &'static str,
        /// Its size.
        bytes: u64,
        /// The device's limit.
        limit: u64,
    },
    /// A library that was asked for is not there, or fails.
    #[error(
        "{name} cannot be used: {reason}; install it, name its library in the environment variable \
         {variable}, or choose another filter"
    )]
    Library {
        /// What it is called.
        name: &'static str,
        /// The environment variable that says where it lies.
        variable: &'static str,
        /// What is wrong.
        reason: String,
    },
    /// Somebody who traced for a render is gone.
    #[error("{name} is gone: {reason}")]
    Worker {
        /// What it is called.
        name: String,
        /// What is known of the reason.
        reason: String,
    },
    /// The driver reported an error or lost the device.
    #[error("{device} failed: {message}; update its driver or use the CPU")]
    Device {
        /// The device.
        device: String,
        /// What the driver said.
        message: String,
    },
}
