//! Devices of small buffers, and slow ones.

use raystream::exec::{ExecError, Executor, Kernel, Launch, Limits};
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

/// Another executor with a hindrance or several.
pub struct Hindered<'e, E> {
    inner: &'e E,
    limits: Limits,
    checks_sizes: bool,
    slow_batches: Option<SlowBatches>,
    /// Runs until it fails, if it is to.
    runs_left: Option<AtomicU32>,
}

impl<'e, E: Executor> Hindered<'e, E> {
    /// Buffers have at most `bytes`, so that films fall into bands and streams are short.
    pub fn by_buffers(inner: &'e E, bytes: u64) -> Self {
        let limits = inner.limits();
        let limits = Limits { buffer_bytes: limits.buffer_bytes.min(bytes), ..limits };
        Self { inner, limits, checks_sizes: true, slow_batches: None, runs_left: None }
    }

    /// It is lost after so many runs of launches.
    pub fn lost_after(inner: &'e E, runs: u32) -> Self {
        let hindered = Self::by_buffers(inner, u64::MAX);
        Self { runs_left: Some(AtomicU32::new(runs)), ..hindered }
    }

    /// Larger buffers are granted all the same to whoever asks.
    pub fn granting_larger(self) -> Self {
        Self { checks_sizes: false, ..self }
    }

    /// The first `count` batches that launch `tracing` are so slow that the next are short.
    pub fn with_slow_batches(self, tracing: &'static Kernel, count: u32) -> Self {
        Self { slow_batches: Some(SlowBatches::new(tracing, count)), ..self }
    }
}

impl<E: Executor> Executor for Hindered<'_, E> {
    type Buffer = E::Buffer;

    fn name(&self) -> &str {
        self.inner.name()
    }

    fn limits(&self) -> Limits {
        self.limits
    }

    fn check_size(&self, label: &'static str, bytes: u64) -> Result<(), ExecError> {
        let limit = self.limits.buffer_bytes;
        if self.checks_sizes && bytes > limit {
            return Err(ExecError::TooLarge {
                device: self.name().to_owned(),
                label,
                bytes,
                limit,
            });
        }
        Ok(())
    }

    fn prepare(&self, abilities: u32) -> Result<(), ExecError> {
        self.inner.prepare(abilities)
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
        if let Some(slow_batches) = &self.slow_batches {
            slow_batches.hold_up(parts);
        }
        if let Some(left) = &self.runs_left {
            let fewer = |left: u32| left.checked_sub(1);
            left.fetch_update(Ordering::Relaxed, Ordering::Relaxed, fewer).map_err(|_| {
                let message = "it was to be lost".to_owned();
                ExecError::Device { device: self.name().to_owned(), message }
            })?;
        }
        self.inner.run_parts(parts)
    }
}

/// How long slow batches take at least: 2.5 times as long as batches should.
const SLOW: Duration = Duration::from_millis(250);

/// Batches that take too long, so that a render makes the next ones shorter.
struct SlowBatches {
    tracing: &'static Kernel,
    left: AtomicU32,
}

impl SlowBatches {
    /// The first `count` that launch `tracing`.
    fn new(tracing: &'static Kernel, count: u32) -> Self {
        Self { tracing, left: AtomicU32::new(count) }
    }

    /// Waits if `parts` are one of them.
    fn hold_up<B>(&self, parts: &[&[Launch<'_, B>]]) {
        let traces =
            parts.iter().copied().flatten().any(|launch| launch.kernel().name == self.tracing.name);
        let fewer = |left: u32| left.checked_sub(1);
        if traces && self.left.fetch_update(Ordering::Relaxed, Ordering::Relaxed, fewer).is_ok() {
            std::thread::sleep(SLOW);
        }
    }
}
