//! Which devices there are, and the choice of one.

use super::cpu::CpuExecutor;
use super::gpu::{GpuExecutor, ShaderPath, largest_buffer};
use super::{ExecError, Executor};

/// Storage buffers that a kernel may bind, at most: a number that every desktop device with Vulkan,
/// Metal or DirectX 12 grants.
pub const STORAGE_BUFFERS: u32 = 12;

/// A device, open for rendering.
pub enum Device {
    /// All cores of the processor.
    Cpu(CpuExecutor),
    /// A GPU, or a software implementation of one.
    Gpu(Box<GpuExecutor>),
}

impl Device {
    /// Opens the device that `selection` names, whatever the case: `cpu`; `gpu`, the best GPU, a
    /// software one if there is no other; `auto`, the best real GPU, else the CPU; or a part of a
    /// device's name. Of several that fit, `gpu:2` or `NAME:2` is the second.
    ///
    /// # Errors
    /// If there is no such device, or it cannot run the kernels.
    pub fn open(selection: &str, options: OpenOptions) -> Result<Self, ExecError> {
        let selection = selection.to_lowercase();
        if selection == "cpu" {
            // Looking for GPUs takes time, and a broken driver may not survive it.
            return Ok(Self::Cpu(CpuExecutor));
        }
        Devices::enumerate(options).open(&selection)
    }

    /// What to call it.
    pub fn name(&self) -> String {
        match self {
            Self::Cpu(_) => cpu_name(),
            Self::Gpu(gpu) => gpu.name().to_owned(),
        }
    }
}

/// How devices are opened.
#[derive(Clone, Copy, Debug, Default)]
pub struct OpenOptions {
    /// Have naga translate the kernels, also where the driver takes SPIR-V.
    pub naga: bool,
    /// Run under the driver's validation layers (Vulkan) or debug layer (DirectX); their messages
    /// are logged.
    pub validation: bool,
}

/// Looks for GPUs.
pub struct Devices {
    adapters: Vec<wgpu::Adapter>,
    options: OpenOptions,
}

/// What `raystream devices` says of a device.
#[derive(Clone, Debug)]
pub struct DeviceInfo {
    /// The name that `--device` takes.
    pub name: String,
    /// What kind of device it is.
    pub kind: &'static str,
    /// Driver and its version; for the CPU, its threads.
    pub driver: String,
    /// How the kernels reach it.
    pub kernels: &'static str,
    /// Largest buffer that a kernel can be given, in bytes.
    pub buffer_bytes: u64,
    /// Why it cannot be used, if so.
    pub unsuitable: Option<String>,
}

impl Devices {
    /// All GPUs that the system's drivers offer, real ones first.
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

    /// Every device, the CPU last.
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
                unsuitable: unsuitable(adapter),
            }
        });
        let cpu = DeviceInfo {
            name: "cpu".into(),
            kind: "CPU",
            driver: threads(),
            kernels: "native",
            buffer_bytes: isize::MAX as u64,
            unsuitable: None,
        };
        gpus.chain([cpu]).collect()
    }

    /// [`Device::open`] of anything but the CPU; `selection` is in lower case.
    fn open(&self, selection: &str) -> Result<Device, ExecError> {
        let is_real =
            |adapter: &&wgpu::Adapter| adapter.get_info().device_type != wgpu::DeviceType::Cpu;
        let is_suitable = |adapter: &&wgpu::Adapter| unsuitable(adapter).is_none();
        let (name, number) = numbered(selection);
        match name {
            "auto" if number == 1 => match self.adapters.iter().filter(is_real).find(is_suitable) {
                Some(adapter) => self.open_adapter(adapter).or_else(|error| {
                    tracing::warn!("{error}");
                    Ok(Device::Cpu(CpuExecutor))
                }),
                None => Ok(Device::Cpu(CpuExecutor)),
            },
            "gpu" if !self.adapters.iter().any(|adapter| is_suitable(&adapter)) => {
                Err(ExecError::NoGpu)
            }
            _ => {
                let fits = |adapter: &&wgpu::Adapter| {
                    if name == "gpu" {
                        is_suitable(adapter)
                    } else {
                        adapter.get_info().name.to_lowercase().contains(name)
                    }
                };
                match self.adapters.iter().filter(fits).nth(number - 1) {
                    Some(adapter) => self.open_adapter(adapter),
                    None => Err(ExecError::NoSuchDevice {
                        name: selection.into(),
                        known: self
                            .list()
                            .into_iter()
                            .map(|info| info.name)
                            .collect::<Vec<_>>()
                            .join(", "),
                    }),
                }
            }
        }
    }

    fn open_adapter(&self, adapter: &wgpu::Adapter) -> Result<Device, ExecError> {
        if let Some(reason) = unsuitable(adapter) {
            return Err(ExecError::Unsuitable { device: adapter.get_info().name, reason });
        }
        Ok(Device::Gpu(Box::new(GpuExecutor::new(adapter, self.shader_path(adapter))?)))
    }

    fn shader_path(&self, adapter: &wgpu::Adapter) -> ShaderPath {
        let takes_spirv = adapter.get_info().backend == wgpu::Backend::Vulkan
            && adapter.features().contains(wgpu::Features::PASSTHROUGH_SHADERS);
        if takes_spirv && !self.options.naga { ShaderPath::Passthrough } else { ShaderPath::Naga }
    }
}

/// A selection, and which of the devices that fit it: from 1 on, the number after a colon at its
/// end.
fn numbered(selection: &str) -> (&str, usize) {
    let numbered =
        selection.rsplit_once(':').and_then(|(name, number)| Some((name, number.parse().ok()?)));
    numbered.filter(|&(_, number)| number > 0).unwrap_or((selection, 1))
}

fn unsuitable(adapter: &wgpu::Adapter) -> Option<String> {
    let limits = adapter.limits();
    if limits.max_storage_buffers_per_shader_stage < STORAGE_BUFFERS {
        return Some(format!(
            "a kernel can bind {} storage buffers there and needs {STORAGE_BUFFERS}",
            limits.max_storage_buffers_per_shader_stage
        ));
    }
    let downlevel = adapter.get_downlevel_capabilities();
    (!downlevel.flags.contains(wgpu::DownlevelFlags::COMPUTE_SHADERS))
        .then(|| "it has no compute shaders".to_owned())
}

fn cpu_name() -> String {
    format!("CPU, {}", threads())
}

fn threads() -> String {
    format!("{} threads", rayon::current_num_threads())
}

#[cfg(test)]
mod tests {
    use super::numbered;

    #[test]
    fn a_number_after_a_colon_chooses_among_devices() {
        assert_eq!(numbered("gpu"), ("gpu", 1));
        assert_eq!(numbered("gpu:3"), ("gpu", 3));
        assert_eq!(numbered("radeon:0"), ("radeon:0", 1));
        assert_eq!(numbered("some: thing"), ("some: thing", 1));
    }
}
