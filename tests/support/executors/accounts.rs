//! A device that is there on paper alone.

use raystream::exec::{ExecError, Executor, Launch, Limits};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::time::Duration;

/// A device of `room` bytes that keeps accounts of them and computes nothing.
pub struct Accounts {
    room: u64,
    used: Arc<AtomicU64>,
    most: AtomicU64,
}

/// A buffer of which nothing but its size is there.
pub struct Piece {
    bytes: u64,
    used: Arc<AtomicU64>,
}

impl Drop for Piece {
    fn drop(&mut self) {
        self.used.fetch_sub(self.bytes, Relaxed);
    }
}

impl Accounts {
    /// With nothing in use.
    pub fn new(room: u64) -> Self {
        Self { room, used: Arc::default(), most: AtomicU64::new(0) }
    }

    /// Bytes in use.
    pub fn used(&self) -> u64 {
        self.used.load(Relaxed)
    }

    /// Bytes that were in use at once, at most.
    pub fn most(&self) -> u64 {
        self.most.load(Relaxed)
    }
}

impl Executor for Accounts {
    type Buffer = Piece;

    fn limits(&self) -> Limits {
        // Those of many GPUs.
        Limits { buffer_bytes: (2 << 30) - 256, alignment: 256 }
    }

    fn name(&self) -> &str {
        "a device on paper"
    }

    fn prepare(&self, _: u32) -> Result<(), ExecError> {
        Ok(())
    }

    fn allocate(&self, label: &'static str, bytes: u64) -> Result<Piece, ExecError> {
        self.check_size(label, bytes)?;
        if self.used() + bytes > self.room {
            return Err(ExecError::OutOfMemory { device: self.name().to_owned(), label, bytes });
        }
        let used = self.used.fetch_add(bytes, Relaxed) + bytes;
        self.most.fetch_max(used, Relaxed);
        Ok(Piece { bytes, used: Arc::clone(&self.used) })
    }

    fn write(&self, _: &Piece, _: u64, _: &[u8]) -> Result<(), ExecError> {
        Ok(())
    }

    fn read(&self, _: &Piece, _: u64, bytes: &mut [u8]) -> Result<(), ExecError> {
        bytes.fill(0);
        Ok(())
    }

    fn run_parts(&self, parts: &[&[Launch<'_, Piece>]]) -> Result<Vec<Duration>, ExecError> {
        Ok(vec![Duration::ZERO; parts.len()])
    }
}
