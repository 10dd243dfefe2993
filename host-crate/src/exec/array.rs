//! Buffers that know what they hold.

use super::{ExecError, Executor, View};
use bytemuck::Pod;
use std::marker::PhantomData;
use std::ops::Range;

/// `len` elements of `T` in the memory of a device.
pub struct Array<B, T> {
    buffer: B,
    len: usize,
    element: PhantomData<T>,
}

impl<B, T: Pod> Array<B, T> {
    /// `len` elements of zero bytes. `label` names the array in errors.
    pub fn zeroed<E: Executor<Buffer = B>>(
        executor: &E,
        label: &'static str,
        len: usize,
    ) -> Result<Self, ExecError> {
        // An empty binding is not allowed, so an empty array holds one element that nobody reads.
        let bytes = (len.max(1) * size_of::<T>()) as u64;
        Ok(Self { buffer: executor.allocate(label, bytes)?, len, element: PhantomData })
    }

    /// A copy of `elements`.
    pub fn from_slice<E: Executor<Buffer = B>>(
        executor: &E,
        label: &'static str,
        elements: &[T],
    ) -> Result<Self, ExecError> {
        let array = Self::zeroed(executor, label, elements.len())?;
        array.write(executor, elements)?;
        Ok(array)
    }

    /// Replaces the first elements.
    pub fn write<E: Executor<Buffer = B>>(
        &self,
        executor: &E,
        elements: &[T],
    ) -> Result<(), ExecError> {
        self.write_from(executor, 0, elements)
    }

    /// Replaces the elements from number `first` on.
    pub fn write_from<E: Executor<Buffer = B>>(
        &self,
        executor: &E,
        first: usize,
        elements: &[T],
    ) -> Result<(), ExecError> {
        let first_byte = (first * size_of::<T>()) as u64;
        executor.write(&self.buffer, first_byte, bytemuck::cast_slice(elements))
    }

    /// Number of elements.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// All of it, for a kernel.
    pub fn view(&self) -> View<'_, B, T> {
        self.slice(0..self.len.max(1))
    }

    /// The elements of `range`, for a kernel. The first byte must be a multiple of the device's
    /// alignment.
    pub fn slice(&self, range: Range<usize>) -> View<'_, B, T> {
        View::new(&self.buffer, range.start, range.len())
    }

    /// Copies all of it to the host.
    pub fn read<E: Executor<Buffer = B>>(&self, executor: &E) -> Result<Vec<T>, ExecError> {
        self.read_range(executor, 0..self.len)
    }

    /// Copies the elements of `range` to the host.
    pub fn read_range<E: Executor<Buffer = B>>(
        &self,
        executor: &E,
        range: Range<usize>,
    ) -> Result<Vec<T>, ExecError> {
        let size = size_of::<T>() as u64;
        // Zeros of the system's, which nobody has to write.
        let mut elements = bytemuck::allocation::zeroed_vec(range.len());
        let bytes = bytemuck::cast_slice_mut::<T, u8>(&mut elements);
        executor.read(&self.buffer, range.start as u64 * size, bytes)?;
        Ok(elements)
    }
}
