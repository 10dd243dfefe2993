//! Tables of kernels: this project's, or one of your own.

use super::kernels::{Kernel, table};
use std::fmt;

/// Kernels, each twice: an entry point for GPUs, and a native function.
#[derive(Clone, Copy)]
pub struct Table {
    /// The SPIR-V with all entry points, little-endian.
    pub spirv: &'static [u8],
    /// Those that are compiled when a device is opened, as far as they need no scene. Others that
    /// the SPIR-V has are compiled when they are first launched.
    pub kernels: &'static [&'static Kernel],
}

impl Table {
    /// Whether it is this project's.
    pub(super) fn is_own(&self) -> bool {
        std::ptr::eq(self.spirv, table::TABLE.spirv)
    }
}

/// This project's.
impl Default for Table {
    fn default() -> Self {
        table::TABLE
    }
}

impl fmt::Debug for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names: Vec<_> = self.kernels.iter().map(|kernel| kernel.name).collect();
        f.debug_struct("Table").field("kernels", &names).finish_non_exhaustive()
    }
}
