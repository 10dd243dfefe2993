//! Stream compaction against a sequential reference, exactly, for streams of any length.

use raystream::exec::cpu::CpuExecutor;
use raystream::exec::{Array, Executor, kernels};
use raystream_shaders::math::random::hash;
use raystream_shaders::parallel::prefix::BlockParams;
use raystream_tests::with_gpu;

/// Lengths around those of a workgroup and of a block, two large ones, and the empty stream.
const LENGTHS: [u32; 10] = [0, 1, 27, 64, 255, 256, 257, 2049, 231_917, 1_088_921];
/// The longest stream that compaction is meant for.
const LONGEST: u32 = 1 << 26;

fn compact<E: Executor>(executor: &E, keep: &[u32]) -> Vec<u32> {
    let len = keep.len() as u32;
    let per_block = BlockParams::per_block(len);
    let keep = Array::from_slice(executor, "flags", keep).unwrap();
    let sums: Array<_, u32> =
        Array::zeroed(executor, "sums", per_block.blocks as usize + 1).unwrap();
    let kept: Array<_, u32> = Array::zeroed(executor, "kept", len as usize).unwrap();
    executor
        .run(&[
            kernels::sum_blocks(&per_block, keep.view(), sums.view()),
            kernels::scan_blocks(&BlockParams::one_workgroup(len), sums.view()),
            kernels::scatter_kept(&per_block, keep.view(), sums.view(), kept.view()),
        ])
        .unwrap();
    let count = sums.read(executor).unwrap()[per_block.blocks as usize];
    kept.read_range(executor, 0..count as usize).unwrap()
}

fn sequential(keep: &[u32]) -> Vec<u32> {
    (0..keep.len() as u32).filter(|&index| keep[index as usize] == 1).collect()
}

/// Flags of which about `share` in 16 are 1.
fn flags(len: u32, share: u32) -> Vec<u32> {
    (0..len).map(|index| u32::from(hash(index ^ hash(len)) >> 28 < share)).collect()
}

fn assert_compacts<E: Executor>(executor: &E, len: u32, share: u32) {
    let keep = flags(len, share);
    let (found, expected) = (compact(executor, &keep), sequential(&keep));
    let first_wrong = found.iter().zip(&expected).position(|(a, b)| a != b);
    assert_eq!(first_wrong, None, "{len} elements, {share}/16 kept: the first wrong place");
    assert_eq!(found.len(), expected.len(), "{len} elements, {share}/16 kept");
}

#[test]
fn compaction_is_exact_on_the_cpu() {
    for len in LENGTHS {
        for share in [0, 1, 8, 16] {
            assert_compacts(&CpuExecutor, len, share);
        }
    }
    assert_compacts(&CpuExecutor, LONGEST, 8);
}

#[test]
fn compaction_is_exact_on_the_gpu() {
    with_gpu(|gpu| {
        for len in LENGTHS {
            for share in [0, 1, 8, 16] {
                assert_compacts(gpu, len, share);
            }
        }
        let largest = (gpu.limits().buffer_bytes / 4).min(u64::from(LONGEST)) as u32;
        assert_compacts(gpu, largest, 8);
    });
}
