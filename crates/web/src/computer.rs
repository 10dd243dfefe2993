//! What the page computes on, whichever it is.

use crate::webgpu::{Driver, WebGpu, WebGpuBuffer};
use raystream::exec::cpu::{CpuBuffer, CpuExecutor};
use raystream::exec::{ExecError, Executor, Launch, Limits, Paired, PairedBuffer, run_over};
use raystream_shaders::scene::bvh::wide::lanes::Simd;
use std::sync::Arc;
use std::time::Duration;

/// A GPU with the CPU beside it, which does all that the GPU does.
pub type Both<D> = Paired<WebGpu<D>, CpuExecutor>;

/// What the page computes on. A clone is the same.
pub enum Computer<D: Driver> {
    /// The CPU, by WebAssembly.
    Cpu(CpuExecutor),
    /// A GPU, by WebGPU.
    Gpu(WebGpu<D>),
    /// The GPU; what it writes is compared with what the CPU does.
    Both(Arc<Both<D>>),
}

/// Memory of a [`Computer`].
pub enum ComputerBuffer<D: Driver> {
    /// Of the CPU.
    Cpu(CpuBuffer),
    /// Of a GPU.
    Gpu(WebGpuBuffer<D>),
    /// Of both.
    Both(PairedBuffer<WebGpuBuffer<D>, CpuBuffer>),
}

impl<D: Driver> Computer<D> {
    /// A GPU with the CPU beside it.
    pub fn with_cpu(gpu: WebGpu<D>) -> Self {
        Self::Both(Arc::new(Paired::new(gpu, CpuExecutor)))
    }
}

/// What a launch of another computer's buffer is: a bug of the caller.
const FOREIGN: &str = "a buffer is used on another device than its own";

impl<D: Driver> ComputerBuffer<D> {
    fn of_cpu(&self) -> &CpuBuffer {
        let Self::Cpu(buffer) = self else { unreachable!("{FOREIGN}") };
        buffer
    }

    fn of_gpu(&self) -> &WebGpuBuffer<D> {
        let Self::Gpu(buffer) = self else { unreachable!("{FOREIGN}") };
        buffer
    }

    fn of_both(&self) -> &PairedBuffer<WebGpuBuffer<D>, CpuBuffer> {
        let Self::Both(buffer) = self else { unreachable!("{FOREIGN}") };
        buffer
    }
}

impl<D: Driver> Clone for Computer<D> {
    fn clone(&self) -> Self {
        match self {
            Self::Cpu(cpu) => Self::Cpu(*cpu),
            Self::Gpu(gpu) => Self::Gpu(gpu.clone()),
            Self::Both(both) => Self::Both(Arc::clone(both)),
        }
    }
}

impl<D: Driver> Executor for Computer<D> {
    type Buffer = ComputerBuffer<D>;

    fn limits(&self) -> Limits {
        match self {
            Self::Cpu(cpu) => cpu.limits(),
            Self::Gpu(gpu) => gpu.limits(),
            Self::Both(both) => both.limits(),
        }
    }

    fn name(&self) -> &str {
        match self {
            Self::Cpu(cpu) => cpu.name(),
            Self::Gpu(gpu) => gpu.name(),
            Self::Both(both) => both.name(),
        }
    }

    fn prepare(&self, abilities: u32) -> Result<(), ExecError> {
        match self {
            Self::Cpu(cpu) => cpu.prepare(abilities),
            Self::Gpu(gpu) => gpu.prepare(abilities),
            Self::Both(both) => both.prepare(abilities),
        }
    }

    fn runs_in_step(&self) -> bool {
        match self {
            Self::Cpu(cpu) => cpu.runs_in_step(),
            Self::Gpu(gpu) => gpu.runs_in_step(),
            Self::Both(both) => both.runs_in_step(),
        }
    }

    fn simd(&self) -> Option<Simd> {
        match self {
            Self::Cpu(cpu) => cpu.simd(),
            Self::Gpu(gpu) => gpu.simd(),
            Self::Both(both) => both.simd(),
        }
    }

    fn allocate(&self, label: &'static str, bytes: u64) -> Result<Self::Buffer, ExecError> {
        match self {
            Self::Cpu(cpu) => cpu.allocate(label, bytes).map(ComputerBuffer::Cpu),
            Self::Gpu(gpu) => gpu.allocate(label, bytes).map(ComputerBuffer::Gpu),
            Self::Both(both) => both.allocate(label, bytes).map(ComputerBuffer::Both),
        }
    }

    fn write(&self, buffer: &Self::Buffer, first_byte: u64, bytes: &[u8]) -> Result<(), ExecError> {
        match self {
            Self::Cpu(cpu) => cpu.write(buffer.of_cpu(), first_byte, bytes),
            Self::Gpu(gpu) => gpu.write(buffer.of_gpu(), first_byte, bytes),
            Self::Both(both) => both.write(buffer.of_both(), first_byte, bytes),
        }
    }

    fn read(
        &self,
        buffer: &Self::Buffer,
        first_byte: u64,
        bytes: &mut [u8],
    ) -> Result<(), ExecError> {
        match self {
            Self::Cpu(cpu) => cpu.read(buffer.of_cpu(), first_byte, bytes),
            Self::Gpu(gpu) => gpu.read(buffer.of_gpu(), first_byte, bytes),
            Self::Both(both) => both.read(buffer.of_both(), first_byte, bytes),
        }
    }

    fn run_parts(&self, parts: &[&[Launch<'_, Self::Buffer>]]) -> Result<Vec<Duration>, ExecError> {
        match self {
            Self::Cpu(cpu) => run_over(cpu, parts, ComputerBuffer::of_cpu),
            Self::Gpu(gpu) => run_over(gpu, parts, ComputerBuffer::of_gpu),
            Self::Both(both) => run_over(both.as_ref(), parts, ComputerBuffer::of_both),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::webgpu::tests::gpu;
    use raystream::exec::{Array, kernels};
    use raystream_shaders::film::stream::{RunWindow, Slot};

    #[test]
    fn launches_run_on_the_device_that_it_is() {
        let window = RunWindow { threads: 4, ..RunWindow::default() };
        let run = |computer: &Computer<_>| -> Vec<u32> {
            let slots: Array<_, Slot> = Array::zeroed(computer, "slots", 4).unwrap();
            computer.run(&[kernels::clear_slots(&window, slots.view())]).unwrap();
            slots.read(computer).unwrap().iter().map(|slot| slot.rank).collect()
        };
        assert_eq!(run(&Computer::Cpu(CpuExecutor)), [u32::MAX; 4]);
        assert_eq!(run(&Computer::Gpu(gpu())), [0; 4], "this one runs nothing");
        let both = Computer::with_cpu(gpu());
        assert_eq!(run(&both), [0; 4]);
        let Computer::Both(both) = both else { unreachable!() };
        assert_eq!(both.partings()[0].kernel, "clear_slots", "they are compared");
    }
}
