//! What the GPU's executor makes of unusual sizes.

use bytemuck::Zeroable;
use raystream::exec::{Array, Executor, kernels};
use raystream_shaders::film::stream::{NO_PIXEL, RunWindow, Slot};
use raystream_tests::with_gpu;

/// More threads than one dimension of the grid holds: 65535 groups of 64 are 4 194 240.
#[test]
fn launches_are_folded_into_rows() {
    with_gpu(|gpu| {
        let threads = 4_194_240 + 1000;
        let slots =
            Array::from_slice(gpu, "slots", &vec![Slot { rank: 1, sample: 2 }; threads as usize])
                .unwrap();
        let window = RunWindow { threads, ..RunWindow::zeroed() };
        gpu.run(&[kernels::clear_slots(&window, slots.view())]).unwrap();
        let cleared = slots.read(gpu).unwrap();
        assert_eq!(
            cleared.iter().position(|slot| slot.rank != NO_PIXEL),
            None,
            "the first slot that was left out"
        );
    });
}

/// A buffer beyond the device's limit is refused with a message, before the driver sees it.
#[test]
fn too_large_a_buffer_is_an_error() {
    with_gpu(|gpu| {
        let limit = gpu.limits().buffer_bytes;
        let error = gpu.allocate("a test", limit + 4).expect_err("too large").to_string();
        assert!(error.contains("a test") && error.contains("use the CPU"), "{error}");
    });
}
