//! The kernels as the driver gets them.

use crate::exec::kernels::{SPIRV, table};
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

/// The module of all kernels.
pub fn shader_module(device: &wgpu::Device, path: ShaderPath) -> wgpu::ShaderModule {
    let words: Vec<u32> = bytemuck::pod_collect_to_vec(SPIRV);
    match path {
        ShaderPath::Passthrough => {
            let entry_points = table::ALL
                .iter()
                .map(|kernel| wgpu::PassthroughShaderEntryPoint {
                    name: kernel.name.into(),
                    workgroup_size: (kernel.workgroup_size, 1, 1),
                })
                .collect::<Vec<_>>();
            let descriptor = wgpu::ShaderModuleDescriptorPassthrough {
                label: Some("kernels"),
                entry_points: entry_points.into(),
                spirv: Some(words.into()),
                ..Default::default()
            };
            // SAFETY: the module was validated when it was compiled, its interface is compared with
            // the table by a test, and every launch binds what the table says.
            unsafe { device.create_shader_module_passthrough(descriptor) }
        }
        ShaderPath::Naga => device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("kernels"),
            source: wgpu::ShaderSource::SpirV(words.into()),
        }),
    }
}

/// What runs a kernel, and what it binds.
pub struct Pipeline {
    pub pipeline: wgpu::ComputePipeline,
    pub layout: wgpu::BindGroupLayout,
}

impl Pipeline {
    /// Compiles `kernel`, which `module` has.
    pub fn new(device: &wgpu::Device, module: &wgpu::ShaderModule, kernel: &Kernel) -> Self {
        let layout = bind_group_layout(device, kernel);
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(kernel.name),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(kernel.name),
            layout: Some(&pipeline_layout),
            module,
            entry_point: Some(kernel.name),
            compilation_options: wgpu::PipelineCompilationOptions {
                zero_initialize_workgroup_memory: false,
                ..Default::default()
            },
            cache: None,
        });
        Self { pipeline, layout }
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
