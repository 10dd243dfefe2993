//! Devices: GPUs, one test at a time, and the CPU by all its instructions.

use crate::not_tested;
use raystream::exec::cpu::CpuExecutor;
use raystream::exec::device::Device;
use raystream::exec::devices::OpenOptions;
use raystream::exec::gpu::GpuExecutor;
use raystream_shaders::scene::bvh::wide::lanes::Simd;
use std::sync::{Arc, Mutex};

/// Set where a missing GPU must fail the tests instead of leaving some out.
const REQUIRE_GPU: &str = "RAYSTREAM_REQUIRE_GPU";

/// The GPU, which the first test opens: it compiles its kernels once for all tests. One test at a
/// time has it: a software one is slow, and a real one has only so much memory.
static GPU: Mutex<Option<Arc<GpuExecutor>>> = Mutex::new(None);

/// The same GPU with kernels that compute what the CPU does.
static EXACT_GPU: Mutex<Option<Arc<GpuExecutor>>> = Mutex::new(None);

/// Runs `test` on any GPU, a software one too. Without one it says so loudly, or fails if
/// `RAYSTREAM_REQUIRE_GPU` is set.
pub fn with_gpu(test: impl FnOnce(&GpuExecutor)) {
    with(&GPU, OpenOptions::default(), test);
}

/// The same on a GPU that is exact.
pub fn with_exact_gpu(test: impl FnOnce(&GpuExecutor)) {
    with(&EXACT_GPU, OpenOptions::default().with_exact(true), test);
}

fn with(
    gpu: &Mutex<Option<Arc<GpuExecutor>>>,
    options: OpenOptions,
    test: impl FnOnce(&GpuExecutor),
) {
    let mut gpu = gpu.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    if gpu.is_none() {
        *gpu = match Device::open_with("gpu", options) {
            Ok(Device::Gpu(gpu)) => Some(gpu),
            Ok(_) => unreachable!("the GPU that was asked for is the CPU"),
            Err(error) => return no_gpu(&error.to_string()),
        };
    }
    if let Some(gpu) = gpu.as_ref() {
        test(gpu);
    }
}

/// What a test that needs a GPU does without one.
pub fn no_gpu(reason: &str) {
    assert!(std::env::var_os(REQUIRE_GPU).is_none(), "{REQUIRE_GPU} is set, but {reason}");
    not_tested(&format!(
        "no Vulkan device: {reason}. Install a driver (a software one: mesa-vulkan-drivers)."
    ));
}

/// The CPU by all instructions that it has, those of one number first.
pub fn cpus() -> Vec<Device> {
    let instructions = [None].into_iter().chain(Simd::all().map(Some));
    instructions.map(|simd| Device::Cpu(CpuExecutor, simd)).collect()
}

/// Whether there is a GPU; says so loudly, or fails, if there is none.
pub fn has_gpu() -> bool {
    let mut found = false;
    with_gpu(|_| found = true);
    found
}
