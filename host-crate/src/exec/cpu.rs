//! The executor that runs kernels on the CPU, through rayon.

use super::native::{NativeArguments, NativeBinding};
use super::{ExecError, Executor, Launch, Limits};
use crate::clock::Instant;
use raystream_shaders::scene::bvh::wide::lanes::Simd;
use std::sync::{PoisonError, RwLock, RwLockReadGuard, RwLockWriteGuard};
use std::time::Duration;

/// Runs kernels on the threads of rayon: those of its global pool, one for each core unless you
/// build it otherwise, or of the pool in which a render is called (`rayon::ThreadPool::install`).
///
/// It traces rays by the [widest](Simd::widest) registers of the processor.
#[derive(Clone, Copy, Debug, Default)]
pub struct CpuExecutor;

/// Memory aligned for every type that crosses to a kernel.
pub struct CpuBuffer {
    blocks: RwLock<Vec<u128>>,
}

/// A buffer held for the time of a launch.
enum Lock<'a> {
    Read(RwLockReadGuard<'a, Vec<u128>>),
    Write(RwLockWriteGuard<'a, Vec<u128>>),
}

impl Executor for CpuExecutor {
    type Buffer = CpuBuffer;

    fn name(&self) -> &str {
        "the CPU"
    }

    fn limits(&self) -> Limits {
        Limits { buffer_bytes: isize::MAX as u64, alignment: 16 }
    }

    fn runs_in_step(&self) -> bool {
        false
    }

    fn simd(&self) -> Option<Simd> {
        Some(Simd::widest())
    }

    fn prepare(&self, _: u32) -> Result<(), ExecError> {
        Ok(())
    }

    fn allocate(&self, label: &'static str, bytes: u64) -> Result<CpuBuffer, ExecError> {
        let len = bytes.div_ceil(size_of::<u128>() as u64) as usize;
        // Zeroed by the system, page by page when it is first used: what a small picture does not
        // need of a large buffer costs nothing.
        let blocks = bytemuck::allocation::try_zeroed_vec(len).map_err(|()| {
            ExecError::OutOfMemory { device: self.name().to_owned(), label, bytes }
        })?;
        Ok(CpuBuffer { blocks: RwLock::new(blocks) })
    }

    fn write(&self, buffer: &CpuBuffer, first_byte: u64, bytes: &[u8]) -> Result<(), ExecError> {
        let mut blocks = buffer.blocks.write().unwrap_or_else(PoisonError::into_inner);
        bytemuck::cast_slice_mut(&mut blocks)[first_byte as usize..][..bytes.len()]
            .copy_from_slice(bytes);
        Ok(())
    }

    fn read(&self, buffer: &CpuBuffer, first_byte: u64, bytes: &mut [u8]) -> Result<(), ExecError> {
        let blocks = buffer.blocks.read().unwrap_or_else(PoisonError::into_inner);
        let from = &bytemuck::cast_slice(&blocks)[first_byte as usize..][..bytes.len()];
        bytes.copy_from_slice(from);
        Ok(())
    }

    fn run_parts(&self, parts: &[&[Launch<'_, CpuBuffer>]]) -> Result<Vec<Duration>, ExecError> {
        Ok(parts.iter().map(|launches| launches.iter().map(run_one).sum()).collect())
    }
}

#[expect(clippy::expect_used, reason = "whoever binds a buffer so has a bug")]
fn run_one(launch: &Launch<'_, CpuBuffer>) -> Duration {
    let start = Instant::now();
    let storage = &launch.kernel.bindings[1..];
    // Locked before any is borrowed: a buffer bound twice, once for writing, is a bug that panics
    // here rather than hanging.
    let mut locks: Vec<Lock<'_>> = storage
        .iter()
        .zip(&launch.views)
        .map(|(binding, view)| {
            let lock = &view.buffer.blocks;
            let held = "a buffer is bound twice to one launch, once for writing";
            if binding.access.writes() {
                Lock::Write(lock.try_write().expect(held))
            } else {
                Lock::Read(lock.try_read().expect(held))
            }
        })
        .collect();
    let views = locks
        .iter_mut()
        .zip(&launch.views)
        .map(|(lock, view)| {
            let range = view.first_byte as usize..(view.first_byte + view.bytes) as usize;
            match lock {
                Lock::Read(blocks) => {
                    NativeBinding::Read(&bytemuck::cast_slice(blocks.as_slice())[range])
                }
                Lock::Write(blocks) => {
                    NativeBinding::Write(&mut bytemuck::cast_slice_mut(blocks)[range])
                }
            }
        })
        .collect();
    (launch.kernel.native)(NativeArguments {
        parameters: &launch.parameters,
        views,
        scene: launch.scene,
        abilities: launch.scene.abilities,
    });
    start.elapsed()
}
