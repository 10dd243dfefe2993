//! GPUs, one test at a time.

use crate::not_tested;
use raystream::exec::device::Device;
use raystream::exec::gpu::GpuExecutor;
use std::sync::Mutex;

/// Set where a missing GPU must fail the tests instead of leaving some out.
const REQUIRE_GPU: &str = "RAYSTREAM_REQUIRE_GPU";

/// One test at a time on the GPU: a software one is slow, and a real one has only so much memory.
static GPU: Mutex<()> = Mutex::new(());

/// Runs `test` on any GPU, a software one too. Without one it says so loudly, or fails if
/// `RAYSTREAM_REQUIRE_GPU` is set.
pub fn with_gpu(test: impl FnOnce(&GpuExecutor)) {
    let _turn = GPU.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    match Device::open("gpu") {
        Ok(Device::Gpu(gpu)) => test(&gpu),
        Ok(_) => unreachable!("the GPU that was asked for is the CPU"),
        Err(error) => no_gpu(&error.to_string()),
    }
}

/// What a test that needs a GPU does without one.
pub fn no_gpu(reason: &str) {
    assert!(std::env::var_os(REQUIRE_GPU).is_none(), "{REQUIRE_GPU} is set, but {reason}");
    not_tested(&format!(
        "no Vulkan device: {reason}. Install a driver (a software one: mesa-vulkan-drivers)."
    ));
}

/// Whether there is a GPU; says so loudly, or fails, if there is none.
pub fn has_gpu() -> bool {
    let mut found = false;
    with_gpu(|_| found = true);
    found
}
