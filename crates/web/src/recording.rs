//! An executor that keeps what kernels read and write.

use bytemuck::Pod;
use raystream::exec::{ExecError, Executor, Kernel, Launch, Limits};
use raystream_shaders::scene::bvh::wide::lanes::Simd;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// Another executor, which runs one launch after the other; what launches have written is read
/// back. It is for small pictures. A clone is the same recording.
pub struct Recording<E>(Arc<Inner<E>>);

struct Inner<E> {
    executor: E,
    keep: fn(&Kernel) -> Keep,
    steps: Mutex<Vec<Step>>,
}

/// What is kept of a launch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Keep {
    /// Nothing.
    Nothing,
    /// What it has written.
    Written,
    /// That, and all that it was given.
    All,
}

/// A launch that has run.
#[derive(Clone)]
pub struct Step {
    /// What was run.
    pub kernel: &'static Kernel,
    /// Its parameters.
    pub parameters: Vec<u8>,
    /// What its bindings held before it, in their order, where that is kept.
    pub given: Vec<Bound>,
    /// What its bindings hold that it may have written, in their order.
    pub written: Vec<Bound>,
}

/// A binding before or after a launch.
#[derive(Clone, Debug)]
pub struct Bound {
    /// What it is called in the kernel's table.
    pub name: &'static str,
    /// All of it.
    pub bytes: Vec<u8>,
}

impl Bound {
    /// Its bytes as what they are elements of.
    pub fn elements<T: Pod>(&self) -> Vec<T> {
        bytemuck::pod_collect_to_vec(&self.bytes)
    }
}

impl<E> Clone for Recording<E> {
    fn clone(&self) -> Self {
        Self(Arc::clone(&self.0))
    }
}

impl<E: Executor> Recording<E> {
    /// Nothing has been recorded yet. `keep` says what is kept of the launches of a kernel.
    pub fn new(executor: E, keep: fn(&Kernel) -> Keep) -> Self {
        Self(Arc::new(Inner { executor, keep, steps: Mutex::default() }))
    }

    /// Who runs the launches.
    pub fn executor(&self) -> &E {
        &self.0.executor
    }

    /// The launches since this was last called of which something is kept, in their order.
    pub fn take(&self) -> Vec<Step> {
        std::mem::take(&mut *self.0.steps.lock().unwrap_or_else(PoisonError::into_inner))
    }

    fn run_one(&self, launch: &Launch<'_, E::Buffer>) -> Result<Duration, ExecError> {
        let kernel = launch.kernel();
        let keep = (self.0.keep)(kernel);
        let given = if keep == Keep::All { self.bound(launch, |_| true)? } else { Vec::new() };
        let run = self.executor().run_parts(&[std::slice::from_ref(launch)])?;
        let time = run.into_iter().sum();
        if keep == Keep::Nothing {
            return Ok(time);
        }
        let written = self.bound(launch, |writes| writes)?;
        let parameters = launch.parameters().to_vec();
        let step = Step { kernel, parameters, given, written };
        self.0.steps.lock().unwrap_or_else(PoisonError::into_inner).push(step);
        Ok(time)
    }

    /// What the bindings hold that are `wanted`, by whether the launch writes to them.
    fn bound(
        &self,
        launch: &Launch<'_, E::Buffer>,
        wanted: fn(bool) -> bool,
    ) -> Result<Vec<Bound>, ExecError> {
        let storage = launch.kernel().bindings[1..].iter().zip(launch.views());
        let storage = storage.filter(|(binding, _)| wanted(binding.access.writes()));
        let read = storage.map(|(binding, view)| {
            let mut bytes = vec![0; view.bytes() as usize];
            self.executor().read(view.buffer(), view.first_byte(), &mut bytes)?;
            Ok(Bound { name: binding.name, bytes })
        });
        read.collect()
    }
}

impl<E: Executor> Executor for Recording<E> {
    type Buffer = E::Buffer;

    fn limits(&self) -> Limits {
        self.executor().limits()
    }

    fn name(&self) -> &str {
        self.executor().name()
    }

    fn prepare(&self, abilities: u32) -> Result<(), ExecError> {
        self.executor().prepare(abilities)
    }

    fn runs_in_step(&self) -> bool {
        self.executor().runs_in_step()
    }

    fn simd(&self) -> Option<Simd> {
        self.executor().simd()
    }

    fn allocate(&self, label: &'static str, bytes: u64) -> Result<Self::Buffer, ExecError> {
        self.executor().allocate(label, bytes)
    }

    fn write(&self, buffer: &Self::Buffer, first_byte: u64, bytes: &[u8]) -> Result<(), ExecError> {
        self.executor().write(buffer, first_byte, bytes)
    }

    fn read(
        &self,
        buffer: &Self::Buffer,
        first_byte: u64,
        bytes: &mut [u8],
    ) -> Result<(), ExecError> {
        self.executor().read(buffer, first_byte, bytes)
    }

    fn run_parts(&self, parts: &[&[Launch<'_, Self::Buffer>]]) -> Result<Vec<Duration>, ExecError> {
        let run = |launches: &&[Launch<'_, Self::Buffer>]| {
            launches.iter().map(|launch| self.run_one(launch)).sum()
        };
        parts.iter().map(run).collect()
    }
}
