//! The kernels as the driver gets them.

use super::spirv;
use crate::exec::kernels::SPIRV;
use crate::exec::{Access, Kernel};

/// How the kernels reach the driver.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShaderPath {
    /// The SPIR-V as it was compiled; Vulkan only.
    Passthrough,
    /// Translated by naga to the driver's language, with its bounds checks; for other drivers, and
    /// for comparison.
    Naga,
}

/// Makes the modules of kernels.
pub enum Shaders {
    /// One for each kernel, see [`spirv`](super::spirv).
    Passthrough(Box<spirv::Kernels>),
    /// One for all.
    Naga(wgpu::ShaderModule),
}

impl Shaders {
    /// From the SPIR-V that was compiled.
    ///
    /// # Errors
    /// Why it cannot be read.
    pub fn new(device: &wgpu::Device, path: ShaderPath) -> Result<Self, String> {
        let words: Vec<u32> = bytemuck::pod_collect_to_vec(SPIRV);
        match path {
            ShaderPath::Passthrough => {
                spirv::Kernels::parse(&words).map(|kernels| Self::Passthrough(Box::new(kernels)))
            }
            ShaderPath::Naga => {
                Ok(Self::Naga(device.create_shader_module(wgpu::ShaderModuleDescriptor {
                    label: Some("kernels"),
                    source: wgpu::ShaderSource::SpirV(words.into()),
                })))
            }
        }
    }

    fn module_of(
        &self,
        device: &wgpu::Device,
        kernel: &Kernel,
    ) -> Result<wgpu::ShaderModule, String> {
        let kernels = match self {
            Self::Naga(module) => return Ok(module.clone()),
            Self::Passthrough(kernels) => kernels,
        };
        let words = kernels.alone(kernel.name)?;
        let descriptor = wgpu::ShaderModuleDescriptorPassthrough {
            label: Some(kernel.name),
            entry_points: vec![wgpu::PassthroughShaderEntryPoint {
                name: kernel.name.into(),
                workgroup_size: (kernel.workgroup_size, 1, 1),
            }]
            .into(),
            spirv: Some(words.into()),
            ..Default::default()
        };
        // SAFETY: the module is a part of one that was validated when it was compiled, with all
        // that it names; its interface is compared with the table by a test, and every launch binds
        // what the table says.
        Ok(unsafe { device.create_shader_module_passthrough(descriptor) })
    }
}

/// What runs a kernel, and what it binds.
pub struct Pipeline {
    pub pipeline: wgpu::ComputePipeline,
    pub layout: wgpu::BindGroupLayout,
}

impl Pipeline {
    /// Compiles `kernel`.
    ///
    /// # Errors
    /// Why `shaders` does not have it.
    pub fn new(device: &wgpu::Device, shaders: &Shaders, kernel: &Kernel) -> Result<Self, String> {
        let module = shaders.module_of(device, kernel)?;
        let layout = bind_group_layout(device, kernel);
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(kernel.name),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(kernel.name),
            layout: Some(&pipeline_layout),
            module: &module,
            entry_point: Some(kernel.name),
            compilation_options: wgpu::PipelineCompilationOptions {
                zero_initialize_workgroup_memory: false,
                ..Default::default()
            },
            cache: None,
        });
        Ok(Self { pipeline, layout })
    }
}

fn bind_group_layout(device: &wgpu::Device, kernel: &Kernel) -> wgpu::BindGroupLayout {
    let entries: Vec<_> = kernel
        .bindings
        .iter()
        .zip(0..)
        .map(|(binding, number)| wgpu::BindGroupLayoutEntry {
            binding: number,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty: wgpu::BindingType::Buffer {
                ty: match binding.access {
                    Access::Uniform => wgpu::BufferBindingType::Uniform,
                    Access::Read => wgpu::BufferBindingType::Storage { read_only: true },
                    Access::Write => wgpu::BufferBindingType::Storage { read_only: false },
                },
                has_dynamic_offset: false,
                min_binding_size: None,
            },
            count: None,
        })
        .collect();
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some(kernel.name),
        entries: &entries,
    })
}
