//! An executor that counts the memory that it is asked for.

use super::{ExecError, Executor, Launch, Limits};
use raystream_shaders::scene::bvh::wide::lanes::Simd;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// Another executor, and the bytes of all buffers that it has allocated. What is freed is not
/// subtracted: a render frees nothing before its end.
pub struct Counting<'e, E> {
    inner: &'e E,
    bytes: AtomicU64,
}

impl<'e, E: Executor> Counting<'e, E> {
    /// Counts from 0 on.
    pub fn new(inner: &'e E) -> Self {
        Self { inner, bytes: AtomicU64::new(0) }
    }

    /// Bytes so far.
    pub fn bytes(&self) -> u64 {
        self.bytes.load(Ordering::Relaxed)
    }
}

impl<E: Executor> Executor for Counting<'_, E> {
    type Buffer = E::Buffer;

    fn limits(&self) -> Limits {
        self.inner.limits()
    }

    fn name(&self) -> &str {
        self.inner.name()
    }

    fn prepare(&self, abilities: u32) -> Result<(), ExecError> {
        self.inner.prepare(abilities)
    }

    fn runs_in_step(&self) -> bool {
        self.inner.runs_in_step()
    }

    fn simd(&self) -> Option<Simd> {
        self.inner.simd()
    }

    fn allocate(&self, label: &'static str, bytes: u64) -> Result<Self::Buffer, ExecError> {
        let buffer = self.inner.allocate(label, bytes)?;
        self.bytes.fetch_add(bytes, Ordering::Relaxed);
        Ok(buffer)
    }

    fn write(&self, buffer: &Self::Buffer, first_byte: u64, bytes: &[u8]) -> Result<(), ExecError> {
        self.inner.write(buffer, first_byte, bytes)
    }

    fn read(
        &self,
        buffer: &Self::Buffer,
        first_byte: u64,
        bytes: &mut [u8],
    ) -> Result<(), ExecError> {
        self.inner.read(buffer, first_byte, bytes)
    }

    fn run_parts(&self, parts: &[&[Launch<'_, Self::Buffer>]]) -> Result<Vec<Duration>, ExecError> {
        self.inner.run_parts(parts)
    }
}
