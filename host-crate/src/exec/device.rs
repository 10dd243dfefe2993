//! A device, whichever it is.

use super::cpu::{CpuBuffer, CpuExecutor};
use super::devices::{SCALAR, threads};
#[cfg(feature = "gpu")]
use super::gpu::GpuExecutor;
use super::{ExecError, Executor, Launch, Limits, run_over};
use raystream_shaders::scene::bvh::wide::lanes::Simd;
#[cfg(feature = "gpu")]
use std::sync::Arc;
use std::time::Duration;

/// A device, open for rendering. A clone is the same device, and cheap.
#[derive(Clone)]
#[non_exhaustive]
pub enum Device {
    /// All cores of the processor, and the instructions by which they traverse scenes: if none, in
    /// the way of GPUs. What kernels find is the same, bit for bit.
    Cpu(CpuExecutor, Option<Simd>),
    /// A GPU, or a software implementation of one.
    #[cfg(feature = "gpu")]
    Gpu(Arc<GpuExecutor>),
}

/// Memory of a [`Device`].
#[non_exhaustive]
pub enum DeviceBuffer {
    /// Of the CPU.
    Cpu(CpuBuffer),
    /// Of a GPU.
    #[cfg(feature = "gpu")]
    Gpu(wgpu::Buffer),
}

impl Device {
    /// What to call it: the GPU's name, or the CPU and its threads.
    pub fn description(&self) -> String {
        match self {
            Self::Cpu(_, simd) => {
                let instructions = simd.map_or(SCALAR, Simd::name);
                format!("CPU, {}, {instructions}", threads())
            }
            #[cfg(feature = "gpu")]
            Self::Gpu(gpu) => gpu.name().to_owned(),
        }
    }
}

/// What a launch of another device's buffer is: a bug of the caller.
#[cfg(feature = "gpu")]
const FOREIGN: &str = "a buffer is used on another device than its own";

impl DeviceBuffer {
    fn of_cpu(&self) -> &CpuBuffer {
        match self {
            Self::Cpu(buffer) => buffer,
            #[cfg(feature = "gpu")]
            Self::Gpu(_) => unreachable!("{FOREIGN}"),
        }
    }

    #[cfg(feature = "gpu")]
    fn of_gpu(&self) -> &wgpu::Buffer {
        match self {
            Self::Gpu(buffer) => buffer,
            Self::Cpu(_) => unreachable!("{FOREIGN}"),
        }
    }
}

impl Executor for Device {
    type Buffer = DeviceBuffer;

    fn limits(&self) -> Limits {
        match self {
            Self::Cpu(cpu, _) => cpu.limits(),
            #[cfg(feature = "gpu")]
            Self::Gpu(gpu) => gpu.limits(),
        }
    }

    fn name(&self) -> &str {
        match self {
            Self::Cpu(cpu, _) => cpu.name(),
            #[cfg(feature = "gpu")]
            Self::Gpu(gpu) => gpu.name(),
        }
    }

    fn prepare(&self, abilities: u32) -> Result<(), ExecError> {
        match self {
            Self::Cpu(cpu, _) => cpu.prepare(abilities),
            #[cfg(feature = "gpu")]
            Self::Gpu(gpu) => gpu.prepare(abilities),
        }
    }

    fn runs_in_step(&self) -> bool {
        match self {
            Self::Cpu(cpu, _) => cpu.runs_in_step(),
            #[cfg(feature = "gpu")]
            Self::Gpu(gpu) => gpu.runs_in_step(),
        }
    }

    fn simd(&self) -> Option<Simd> {
        match self {
            Self::Cpu(_, simd) => *simd,
            #[cfg(feature = "gpu")]
            Self::Gpu(_) => None,
        }
    }

    fn allocate(&self, label: &'static str, bytes: u64) -> Result<DeviceBuffer, ExecError> {
        match self {
            Self::Cpu(cpu, _) => cpu.allocate(label, bytes).map(DeviceBuffer::Cpu),
            #[cfg(feature = "gpu")]
            Self::Gpu(gpu) => gpu.allocate(label, bytes).map(DeviceBuffer::Gpu),
        }
    }

    fn write(&self, buffer: &DeviceBuffer, first_byte: u64, bytes: &[u8]) -> Result<(), ExecError> {
        match self {
            Self::Cpu(cpu, _) => cpu.write(buffer.of_cpu(), first_byte, bytes),
            #[cfg(feature = "gpu")]
            Self::Gpu(gpu) => gpu.write(buffer.of_gpu(), first_byte, bytes),
        }
    }

    fn read(
        &self,
        buffer: &DeviceBuffer,
        first_byte: u64,
        bytes: &mut [u8],
    ) -> Result<(), ExecError> {
        match self {
            Self::Cpu(cpu, _) => cpu.read(buffer.of_cpu(), first_byte, bytes),
            #[cfg(feature = "gpu")]
            Self::Gpu(gpu) => gpu.read(buffer.of_gpu(), first_byte, bytes),
        }
    }

    fn run_parts(&self, parts: &[&[Launch<'_, DeviceBuffer>]]) -> Result<Vec<Duration>, ExecError> {
        match self {
            Self::Cpu(cpu, _) => run_over(cpu, parts, DeviceBuffer::of_cpu),
            #[cfg(feature = "gpu")]
            Self::Gpu(gpu) => run_over(gpu.as_ref(), parts, DeviceBuffer::of_gpu),
        }
    }
}
