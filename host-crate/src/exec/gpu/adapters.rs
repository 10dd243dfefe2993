//! Which GPUs there are, and the choice of one.

use super::{GpuExecutor, ShaderPath, largest_buffer};
use crate::exec::devices::{DeviceInfo, OpenOptions};
use crate::exec::{Access, ExecError, Kernel, Table};

/// All GPUs that the system's drivers offer, real ones first.
pub struct Adapters {
    adapters: Vec<wgpu::Adapter>,
    options: OpenOptions,
}

impl Adapters {
    /// Looks for them.
    pub fn enumerate(options: OpenOptions) -> Self {
        let flags = if options.validation {
            wgpu::InstanceFlags::VALIDATION | wgpu::InstanceFlags::DEBUG
        } else {
            wgpu::InstanceFlags::empty()
        };
        let backends = wgpu::Backends::PRIMARY;
        let descriptor = wgpu::InstanceDescriptor {
            backends,
            flags,
            ..wgpu::InstanceDescriptor::new_without_display_handle()
        };
        let mut adapters =
            pollster::block_on(wgpu::Instance::new(descriptor).enumerate_adapters(backends));
        adapters.sort_by_key(|adapter| match adapter.get_info().device_type {
            wgpu::DeviceType::DiscreteGpu => 0,
            wgpu::DeviceType::IntegratedGpu => 1,
            wgpu::DeviceType::VirtualGpu => 2,
            wgpu::DeviceType::Other => 3,
            wgpu::DeviceType::Cpu => 4,
        });
        Self { adapters, options }
    }

    /// Each of them.
    pub fn list(&self) -> Vec<DeviceInfo> {
        let gpus = self.adapters.iter().map(|adapter| {
            let info = adapter.get_info();
            DeviceInfo {
                name: info.name,
                kind: match info.device_type {
                    wgpu::DeviceType::DiscreteGpu => "discrete GPU",
                    wgpu::DeviceType::IntegratedGpu => "integrated GPU",
                    wgpu::DeviceType::VirtualGpu => "virtual GPU",
                    wgpu::DeviceType::Cpu => "software GPU",
                    wgpu::DeviceType::Other => "other GPU",
                },
                driver: format!("{} {} {}", info.backend, info.driver, info.driver_info)
                    .trim_end()
                    .to_owned(),
                kernels: match self.shader_path(adapter) {
                    ShaderPath::Passthrough => "SPIR-V",
                    ShaderPath::Naga => "through naga",
                },
                buffer_bytes: largest_buffer(&adapter.limits()),
                unsuitable: self.unsuitable(adapter),
            }
        });
        gpus.collect()
    }

    /// Opens the best real GPU that can run the kernels; nothing if there is none, or it fails.
    pub fn open_best(&self) -> Option<GpuExecutor> {
        let is_real =
            |adapter: &&wgpu::Adapter| adapter.get_info().device_type != wgpu::DeviceType::Cpu;
        let is_suitable = |adapter: &&wgpu::Adapter| self.unsuitable(adapter).is_none();
        let adapter = self.adapters.iter().filter(is_real).find(is_suitable)?;
        self.open_adapter(adapter).inspect_err(|error| tracing::warn!("{error}")).ok()
    }

    /// Opens GPU `number` (from 1 on) of those whose name contains `name`, in lower case, or, for
    /// `gpu`, of those that can run the kernels; nothing if there are not so many.
    ///
    /// # Errors
    /// If it cannot be opened, or there is no suitable one at all for `gpu`.
    pub fn open(&self, name: &str, number: usize) -> Result<Option<GpuExecutor>, ExecError> {
        let is_suitable = |adapter: &wgpu::Adapter| self.unsuitable(adapter).is_none();
        if name == "gpu" && !self.adapters.iter().any(is_suitable) {
            return Err(ExecError::NoGpu);
        }
        let fits = |adapter: &&wgpu::Adapter| {
            if name == "gpu" {
                is_suitable(adapter)
            } else {
                adapter.get_info().name.to_lowercase().contains(name)
            }
        };
        let adapter = self.adapters.iter().filter(fits).nth(number - 1);
        adapter.map(|adapter| self.open_adapter(adapter)).transpose()
    }

    fn open_adapter(&self, adapter: &wgpu::Adapter) -> Result<GpuExecutor, ExecError> {
        if let Some(reason) = self.unsuitable(adapter) {
            return Err(ExecError::Unsuitable { device: adapter.get_info().name, reason });
        }
        GpuExecutor::new(adapter, self.shader_path(adapter), self.options)
    }

    fn shader_path(&self, adapter: &wgpu::Adapter) -> ShaderPath {
        let takes_spirv = adapter.get_info().backend == wgpu::Backend::Vulkan
            && adapter.features().contains(wgpu::Features::PASSTHROUGH_SHADERS);
        if takes_spirv && !self.options.naga { ShaderPath::Passthrough } else { ShaderPath::Naga }
    }

    /// Why an adapter cannot run the kernels, if so.
    fn unsuitable(&self, adapter: &wgpu::Adapter) -> Option<String> {
        let granted = adapter.limits().max_storage_buffers_per_shader_stage;
        let needed = storage_buffers(&self.options.table);
        if granted < needed {
            return Some(format!(
                "a kernel can bind {granted} storage buffers there and needs {needed}"
            ));
        }
        let downlevel = adapter.get_downlevel_capabilities();
        (!downlevel.flags.contains(wgpu::DownlevelFlags::COMPUTE_SHADERS))
            .then(|| "it has no compute shaders".to_owned())
    }
}

/// Storage buffers that a kernel binds, at most.
fn storage_buffers(table: &Table) -> u32 {
    let of_kernel = |kernel: &&Kernel| {
        kernel.bindings.iter().filter(|binding| binding.access != Access::Uniform).count() as u32
    };
    table.kernels.iter().map(of_kernel).max().unwrap_or(0)
}
