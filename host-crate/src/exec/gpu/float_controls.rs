//! Which float controls a device has: `VK_KHR_shader_float_controls`, part of Vulkan 1.2.

/// Whether kernels may ask of `adapter` to keep subnormal numbers, which it may flush otherwise; not
/// where it does not say.
#[cfg(any(windows, target_os = "linux", target_os = "android"))]
pub fn keeps_subnormals(adapter: &wgpu::Adapter) -> bool {
    use ash::vk;
    use wgpu::hal::api::Vulkan;

    // SAFETY: the device is asked, and nothing of it is kept.
    let Some(vulkan) = (unsafe { adapter.as_hal::<Vulkan>() }) else { return false };
    let instance = vulkan.shared_instance().raw_instance();
    let mut controls = vk::PhysicalDeviceFloatControlsProperties::default();
    let mut properties = vk::PhysicalDeviceProperties2::default().push_next(&mut controls);
    // SAFETY: the device is one of this instance's, which wgpu opens for Vulkan 1.1 or newer.
    unsafe {
        instance.get_physical_device_properties2(vulkan.raw_physical_device(), &mut properties);
    }
    controls.shader_denorm_preserve_float32 == vk::TRUE
}

/// Not where there is no Vulkan.
#[cfg(not(any(windows, target_os = "linux", target_os = "android")))]
pub fn keeps_subnormals(_: &wgpu::Adapter) -> bool {
    false
}
