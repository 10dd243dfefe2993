//! A counter that lanes raise by atomics.

use super::{Array, ExecError, Executor, Launch, View, kernels};
use bytemuck::Zeroable;
use raystream_shaders::film::stream::RunWindow;

/// A word on the device.
pub struct Counter<B> {
    word: Array<B, u32>,
}

impl<B> Counter<B> {
    /// A new one, at 0. `label` names it in errors.
    pub fn new<E: Executor<Buffer = B>>(
        executor: &E,
        label: &'static str,
    ) -> Result<Self, ExecError> {
        Ok(Self { word: Array::zeroed(executor, label, 1)? })
    }

    /// The launch that puts it back to 0.
    pub fn clear(&self) -> Launch<'_, B> {
        let one = RunWindow { threads: 1, ..RunWindow::zeroed() };
        kernels::clear_counter(&one, self.view())
    }

    /// What a kernel is given that raises it.
    pub fn view(&self) -> View<'_, B, u32> {
        self.word.view()
    }
}
