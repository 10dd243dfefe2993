//! The kernels as the driver gets them.

use super::exact::Exact;
use super::spirv;
use crate::exec::{Access, Kernel, Table};
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::sync::{Arc, Mutex, PoisonError};

/// How the kernels reach the driver.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShaderPath {
    /// The SPIR-V as it was compiled; Vulkan only.
    Passthrough,
    /// Translated by naga to the driver's language, with its bounds checks; for other drivers, and
    /// for comparison.
    Naga,
}

/// The pipelines of a device. Each is compiled when it is first asked for, since there is one for
/// every kernel and every word of abilities that scenes use.
pub struct Pipelines {
    device: wgpu::Device,
    path: ShaderPath,
    kernels: spirv::Kernels,
    compiled: Mutex<HashMap<(&'static str, u32), Arc<Pipeline>>>,
}

impl Pipelines {
    /// None yet, of the SPIR-V of `table`, or of what is made exact of it.
    ///
    /// # Errors
    /// Why it cannot be read, or what of it cannot be exact.
    pub fn new(
        device: wgpu::Device,
        path: ShaderPath,
        table: &Table,
        exact: Option<Exact>,
    ) -> Result<Self, String> {
        let words = bytemuck::pod_collect_to_vec::<u8, u32>(table.spirv);
        let kernels = spirv::Kernels::parse(&words, exact)?;
        Ok(Self { device, path, kernels, compiled: Mutex::default() })
    }

    /// The pipeline of `kernel` for scenes that use `abilities`.
    ///
    /// # Errors
    /// Why the SPIR-V does not have it. What the driver says against it is reported to the device.
    pub fn get(&self, kernel: &'static Kernel, abilities: u32) -> Result<Arc<Pipeline>, String> {
        let mut compiled = self.compiled.lock().unwrap_or_else(PoisonError::into_inner);
        match compiled.entry((kernel.name, abilities)) {
            Entry::Occupied(there) => Ok(Arc::clone(there.get())),
            Entry::Vacant(place) => {
                let words = self.kernels.alone(kernel.name, abilities)?;
                let module = self.module(kernel, words);
                let pipeline = Pipeline::new(&self.device, &module, kernel);
                Ok(Arc::clone(place.insert(Arc::new(pipeline))))
            }
        }
    }

    /// The module of `kernel` as the driver takes it.
    fn module(&self, kernel: &Kernel, words: Vec<u32>) -> wgpu::ShaderModule {
        if self.path == ShaderPath::Naga {
            return self.device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(kernel.name),
                source: wgpu::ShaderSource::SpirV(words.into()),
            });
        }
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
        unsafe { self.device.create_shader_module_passthrough(descriptor) }
    }
}

/// What runs a kernel, and what it binds.
pub struct Pipeline {
    pub pipeline: wgpu::ComputePipeline,
    pub layout: wgpu::BindGroupLayout,
}

impl Pipeline {
    /// Compiles `kernel`, which is all of `module`.
    fn new(device: &wgpu::Device, module: &wgpu::ShaderModule, kernel: &Kernel) -> Self {
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
                    access => wgpu::BufferBindingType::Storage { read_only: !access.writes() },
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
