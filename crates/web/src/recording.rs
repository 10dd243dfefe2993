//! An executor that keeps what kernels write.

use raystream::exec::{ExecError, Executor, Kernel, Launch, Limits};
use raystream_shaders::scene::bvh::wide::lanes::Simd;
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// Another executor, which runs one launch after the other; all that each has written is read back.
/// It is for small pictures.
pub struct Recording<E> {
    inner: E,
    steps: Mutex<Vec<Step>>,
}

/// A launch that has run.
#[derive(Clone)]
pub struct Step {
    /// What was run.
    pub kernel: &'static Kernel,
    /// What its bindings hold that it may have written, in their order.
    pub written: Vec<Written>,
}

/// A binding after a launch.
#[derive(Clone, Debug)]
pub struct Written {
    /// What it is called in the kernel's table.
    pub name: &'static str,
    /// All of it.
    pub bytes: Vec<u8>,
}

impl<E: Executor> Recording<E> {
    /// Nothing has been recorded yet.
    pub fn new(inner: E) -> Self {
        Self { inner, steps: Mutex::default() }
    }

    /// The launches since this was last called, in their order.
    pub fn take(&self) -> Vec<Step> {
        std::mem::take(&mut *self.steps.lock().unwrap_or_else(PoisonError::into_inner))
    }

    fn run_one(&self, launch: &Launch<'_, E::Buffer>) -> Result<Duration, ExecError> {
        let time = self.inner.run_parts(&[std::slice::from_ref(launch)])?.into_iter().sum();
        let kernel = launch.kernel();
        let storage = kernel.bindings[1..].iter().zip(launch.views());
        let mut written = Vec::new();
        for (binding, view) in storage.filter(|(binding, _)| binding.access.writes()) {
            let mut bytes = vec![0; view.bytes() as usize];
            self.inner.read(view.buffer(), view.first_byte(), &mut bytes)?;
            written.push(Written { name: binding.name, bytes });
        }
        let mut steps = self.steps.lock().unwrap_or_else(PoisonError::into_inner);
        steps.push(Step { kernel, written });
        Ok(time)
    }
}

impl<E: Executor> Executor for Recording<E> {
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
        self.inner.allocate(label, bytes)
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
        let run = |launches: &&[Launch<'_, Self::Buffer>]| {
            launches.iter().map(|launch| self.run_one(launch)).sum()
        };
        parts.iter().map(run).collect()
    }
}
