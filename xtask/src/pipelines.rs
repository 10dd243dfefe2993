//! What a driver makes of each kernel: registers, spills and whatever else it tells.

use anyhow::{Context, Result, ensure};
use ash::vk;
use std::ffi::CString;
use std::fs;
use std::path::Path;

/// Bindings that a pipeline's layout has: more than any kernel.
const BINDINGS: u32 = 13;

/// Prints a line for each kernel of the SPIR-V `module`, as the Vulkan driver of the first GPU
/// compiles it: its name, then `statistic=value` for every statistic of the driver
/// (`VK_KHR_pipeline_executable_properties`).
///
/// # Errors
///
/// When there is no Vulkan device that tells, or it refuses the module.
pub fn print(module: &Path) -> Result<()> {
    let bytes = fs::read(module).with_context(|| format!("cannot read {}", module.display()))?;
    ensure!(bytes.len() % 4 == 0, "{} is not SPIR-V", module.display());
    let words: Vec<u32> =
        bytes.chunks_exact(4).map(|w| u32::from_le_bytes([w[0], w[1], w[2], w[3]])).collect();
    let parsed = rspirv::dr::load_words(&words)
        .map_err(|error| anyhow::anyhow!("{}: {error}", module.display()))?;
    let driver = Driver::open()?;
    for entry in &parsed.entry_points {
        let name = entry.operands[2].unwrap_literal_string();
        println!("{name} {}", driver.statistics(&words, name)?);
    }
    Ok(())
}

/// A Vulkan device that tells of its pipelines. It lives until the program ends.
struct Driver {
    device: ash::Device,
    told: ash::khr::pipeline_executable_properties::Device,
    layout: vk::PipelineLayout,
}

impl Driver {
    fn open() -> Result<Self> {
        // SAFETY: loads the system's Vulkan, whose initialisers are trusted as the GPU's driver is.
        let entry = unsafe { ash::Entry::load() }.context("cannot load Vulkan")?;
        let application = vk::ApplicationInfo::default().api_version(vk::API_VERSION_1_1);
        let info = vk::InstanceCreateInfo::default().application_info(&application);
        // SAFETY: the structures that `info` points to outlive the call.
        let instance = unsafe { entry.create_instance(&info, None) }?;
        // SAFETY: the instance is alive.
        let gpus = unsafe { instance.enumerate_physical_devices() }?;
        let gpu = *gpus.first().context("there is no Vulkan device")?;
        let queue = [vk::DeviceQueueCreateInfo::default().queue_priorities(&[1.0])];
        let extensions = [ash::khr::pipeline_executable_properties::NAME.as_ptr()];
        let mut tells = vk::PhysicalDevicePipelineExecutablePropertiesFeaturesKHR::default()
            .pipeline_executable_info(true);
        let info = vk::DeviceCreateInfo::default()
            .queue_create_infos(&queue)
            .enabled_extension_names(&extensions)
            .push_next(&mut tells);
        // SAFETY: the structures that `info` points to outlive the call.
        let device = unsafe { instance.create_device(gpu, &info, None) }
            .context("the driver does not tell of its pipelines")?;
        let told = ash::khr::pipeline_executable_properties::Device::new(&instance, &device);
        let layout = layout(&device)?;
        Ok(Self { device, told, layout })
    }

    fn statistics(&self, words: &[u32], name: &str) -> Result<String> {
        let name = CString::new(name)?;
        let module = vk::ShaderModuleCreateInfo::default().code(words);
        // SAFETY: the words are SPIR-V that the kernels' own compiler and checks have passed.
        let module = unsafe { self.device.create_shader_module(&module, None) }?;
        let stage = vk::PipelineShaderStageCreateInfo::default()
            .stage(vk::ShaderStageFlags::COMPUTE)
            .module(module)
            .name(&name);
        let info = vk::ComputePipelineCreateInfo::default()
            .flags(vk::PipelineCreateFlags::CAPTURE_STATISTICS_KHR)
            .stage(stage)
            .layout(self.layout);
        // SAFETY: module, layout and name are alive.
        let pipeline = unsafe {
            self.device.create_compute_pipelines(vk::PipelineCache::null(), &[info], None)
        }
        .map_err(|(_, error)| error)?[0];
        let executable = vk::PipelineExecutableInfoKHR::default().pipeline(pipeline);
        // SAFETY: the pipeline was created with the flag that this asks for.
        let statistics = unsafe { self.told.get_pipeline_executable_statistics(&executable) }?;
        let texts = statistics.iter().map(|statistic| {
            let name = statistic.name_as_c_str().unwrap_or_default().to_string_lossy();
            // SAFETY: all of the union's members are plain numbers of at most 8 bytes.
            let value = unsafe { statistic.value.u64 };
            format!("{}={value}", name.replace(' ', "_"))
        });
        Ok(texts.collect::<Vec<_>>().join(" "))
    }
}

/// A layout with a uniform buffer and as many storage buffers as any kernel has.
fn layout(device: &ash::Device) -> Result<vk::PipelineLayout> {
    let bindings: Vec<_> = (0..BINDINGS)
        .map(|binding| {
            let kind = match binding {
                0 => vk::DescriptorType::UNIFORM_BUFFER,
                _ => vk::DescriptorType::STORAGE_BUFFER,
            };
            vk::DescriptorSetLayoutBinding::default()
                .binding(binding)
                .descriptor_type(kind)
                .descriptor_count(1)
                .stage_flags(vk::ShaderStageFlags::COMPUTE)
        })
        .collect();
    let info = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
    // SAFETY: the structures that `info` points to outlive the call.
    let sets = [unsafe { device.create_descriptor_set_layout(&info, None) }?];
    let info = vk::PipelineLayoutCreateInfo::default().set_layouts(&sets);
    // SAFETY: likewise.
    Ok(unsafe { device.create_pipeline_layout(&info, None) }?)
}
